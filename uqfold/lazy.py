"""Names that a package hands out but loads only when they are first used (PEP 562).

They are written once, in the package's ``__init__.pyi``, from which type checkers know them too.
"""

from __future__ import annotations

import ast
import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

MOVED = {
    "uqfold.comparison.Case": "uqfold.comparison.NamedProblem",
    "uqfold.comparison.ComparisonPlan": "uqfold.comparison.plan.ComparisonPlan",
    "uqfold.comparison.available_cases": "uqfold.comparison.available_problems",
    "uqfold.comparison.named_case": "uqfold.comparison.named_problem",
    "uqfold.comparison.records_from_frame": "uqfold.comparison.checked_frame",
    "uqfold.evidence.CaseRecord": "uqfold.validation.CaseRecord",
    "uqfold.evidence.Finding": "uqfold.validation.Finding",
    "uqfold.evidence.Measurement": "uqfold.validation.Measurement",
    "uqfold.evidence.PlantedFault": "uqfold.validation.record.PlantedFault",
    "uqfold.evidence.RecordError": "uqfold.validation.RecordError",
    "uqfold.evidence.Table": "uqfold.validation.Table",
    "uqfold.evidence.Verdict": "uqfold.validation.Verdict",
    "uqfold.evidence.read_case_record": "uqfold.validation.read_case_record",
    "uqfold.evidence.read_case_records": "uqfold.validation.read_case_records",
    "uqfold.evidence.verdict_of": "uqfold.validation.verdict_of",
    "uqfold.evidence.write_case_record": "uqfold.validation.record.write_case_record",
    "uqfold.report.error_against_evaluations": "uqfold.plots.error_against_evaluations",
    "uqfold.report.reliability_curves": "uqfold.plots.reliability_panels",
}
"""Public name of the former release -> what it is now; still understood, with a warning."""
_POINTS = "a figure of a case is a uqfold.validation.Points now"
_BAUMGARTE = "the paper's own form is part of the case validation/baumgarte_form now"
GONE = {
    "uqfold.comparison.MethodRun": "run_comparison yields the frame of all finished methods now",
    "uqfold.comparison.Records": "a comparison is a pandas frame now, as read_records returns it",
    "uqfold.comparison.RunHeader": "what was asked is the dict comparison_header(frame) now",
    "uqfold.evidence.Axis": _POINTS,
    "uqfold.evidence.Column": "the columns of a uqfold.validation.Table are texts now",
    "uqfold.evidence.Figure": _POINTS,
    "uqfold.evidence.Series": _POINTS,
    "uqfold.evidence.StoredResult": "a record quotes no other record now",
    "uqfold.mechanism.BaumgarteTrajectory": _BAUMGARTE,
    "uqfold.mechanism.baumgarte_trajectory": _BAUMGARTE,
}
"""Public name of the former release that nothing can stand for -> what to use in its place."""


def attach_stub(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package.

    Parameters
    ----------
    package
        Its ``__name__``.
    file
        Its ``__file__``. Beside it lies ``__init__.pyi`` with nothing but statements such as
        ``from package.module import name as name``.
    """
    stub = Path(file).with_suffix(".pyi").read_text(encoding="utf-8")
    homes = {
        alias.name: node.module
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }

    def load(name: str) -> Any:
        if name in homes:
            home = homes[name]
            submodule = home == package
            module = import_module(f"{package}.{name}" if submodule else home)
            value = module if submodule else getattr(module, name)
        else:
            return former(package, name)
        setattr(sys.modules[package], name, value)
        return value

    names = sorted(homes)
    return load, lambda: names, names


def former(package: str, name: str) -> Any:
    """Return what a public name of the former release is now, with a warning.

    Raises
    ------
    AttributeError
        If the package had no such name, or nothing can stand for it; the message says what to use.
    """
    known = f"{package}.{name}"
    if known not in MOVED:
        hint = f": {GONE[known]}" if known in GONE else ""
        raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}")
    # told to whoever asked the package
    warnings.warn(f"{known} is {MOVED[known]} now", DeprecationWarning, 3)
    home, _, name_there = MOVED[known].rpartition(".")
    return getattr(import_module(home), name_there)
