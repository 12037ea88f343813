"""Names that a package hands out but loads only when they are first used (PEP 562).

They are written once, in the package's ``__init__.pyi``, from which type checkers know them too.
"""

from __future__ import annotations

import ast
import os
import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import Any

_WITHIN = f"{Path(__file__).parent}{os.sep}"

MOVED = {
    "uqfold.comparison.Case": "uqfold.comparison.NamedProblem",
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
_BAUMGARTE = "the paper's own form is in validation/mechanism/baumgarte.py now"
_PLAN = "run_comparison checks what is asked, and takes it itself, now"
GONE = {
    "uqfold.comparison.ComparisonPlan": _PLAN,
    "uqfold.comparison.MethodRun": "run_comparison yields the frame of all finished methods now",
    "uqfold.comparison.Records": "a comparison is a pandas frame now, as read_records returns it",
    "uqfold.comparison.RunHeader": "what was asked is the dict comparison_header(frame) now",
    "uqfold.comparison.plan_comparison": _PLAN,
    "uqfold.evidence.Axis": _POINTS,
    "uqfold.evidence.Column": "the columns of a uqfold.validation.Table are texts now",
    "uqfold.evidence.Figure": _POINTS,
    "uqfold.evidence.Series": _POINTS,
    "uqfold.evidence.StoredResult": "a record quotes no other record now",
    "uqfold.mechanism.BaumgarteTrajectory": _BAUMGARTE,
    "uqfold.mechanism.baumgarte_trajectory": _BAUMGARTE,
    "uqfold.plots.benchmark": "uqfold.plots.points draws rows with columns series, x and y now",
    "uqfold.plots.reliability": 'it is uqfold.plots.reliability_panels(frame, ["pf"]) now',
    "uqfold.problems.wing.CONDITIONS": "the paper's conditions are in studies/paper.py now",
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
    ImportError
        With the same message, where a ``from`` import asks for what nothing can stand for.
    """
    known = f"{package}.{name}"
    # `from package import name` asks twice, first whether it is there
    by_import = sys._getframe(2).f_code.co_name == "_handle_fromlist"
    if known in GONE:
        kind = ImportError if by_import else AttributeError
        raise kind(f"module {package!r} has no attribute {name!r}: {GONE[known]}")
    if known not in MOVED:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    if not by_import:
        warn_caller(f"{known} is {MOVED[known]} now", DeprecationWarning)
    home, _, name_there = MOVED[known].rpartition(".")
    return getattr(import_module(home), name_there)


def warn_caller(message: str, category: type[Warning]) -> None:
    """Warn at the line outside this package that led here."""
    frame: FrameType | None = sys._getframe(1)
    level = 2
    while frame is not None and frame.f_code.co_filename.startswith(_WITHIN):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, category, stacklevel=level)
