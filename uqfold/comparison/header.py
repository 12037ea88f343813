"""How a comparison was made: one plain dict, in ``frame.attrs`` and above the rows of a record.

Its fields are those of `FORM`; ``docs/records.md`` says what they mean.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from functools import cache
from typing import Any

from uqfold.checks import instance, refused
from uqfold.comparison.encoding import checked, encoded
from uqfold.comparison.plan import ComparisonPlan
from uqfold.methods.theory import Theory
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criteria, Criterion
from uqfold.provenance import made_by, source_digest

ATTRIBUTE = "uqfold-comparison"
"""Where a frame of a comparison carries its header, in ``frame.attrs``."""
_TEXTS = {str: str}
_EQUATION = {"lead": str, "latex": str, "source": str}
FORM: dict[str, Any] = {
    "problem": str,
    "response": str,
    "response_unit": str,
    "system": (
        None,
        {
            "units": int,
            "structure": str,
            "inputs": [{"name": str, "unit": str, "role": str, "distribution": str}],
            "dependence": str,
        },
    ),
    "criteria": [
        {
            "threshold": float,
            "tau": (None, float),
            "missions": (int, {"planned": int, "p": float}),
        }
    ],
    "methods": [
        {
            "label": str,
            "method": str,
            "title": str,
            "settings": str,
            "theory": {"summary": str, "equations": [_EQUATION], "references": [str]},
        }
    ],
    "finished": [str],
    "seed": int,
    "max_evals": (None, int),
    "failed_runs": str,
    "reference": (None, {"kind": str, "how": str, "command": str}),
    "command": str,
    "date": str,
    "machine": str,
    "versions": _TEXTS,
    "source": _TEXTS,
}
"""Form of a header, see `encoding.checked`."""


def header_of(plan: ComparisonPlan, command: str = "") -> dict[str, Any]:
    """Return the header of a plan that is about to be run, now and with the code installed here.

    Parameters
    ----------
    plan
        What will be run.
    command
        The command as typed, without absolute paths; empty for a run from Python.
    """
    problem, known = plan.problem, plan.problem.references
    made = made_by(command=command)
    return {
        "problem": problem.name,
        "response": problem.response,
        "response_unit": problem.response_unit,
        "system": _system(problem),
        "criteria": [encoded_criterion(criterion) for criterion in plan.criteria],
        "methods": [
            {
                "label": label,
                "method": method.name,
                "title": method.title,
                "settings": repr(method),
                # as JSON has it: lists, no tuples
                "theory": json.loads(json.dumps(asdict(Theory.of(type(method))))),
            }
            for label, method in plan.methods.items()
        ],
        "finished": [],
        "seed": plan.seed,
        "max_evals": plan.max_evals,
        "failed_runs": plan.evaluator.failed_runs,
        "reference": None
        if known is None
        else {"kind": known.kind, "how": known.how, "command": known.command},
        **{name: made[name] for name in ("command", "date", "machine", "versions")},
        "source": dict(_source(tuple(sorted(_modules(plan))))),
    }


def checked_header(document: Any) -> dict[str, Any]:
    """Return the header that a document holds; what else it holds is left out.

    Raises
    ------
    KeyError, TypeError, ValueError
        If a field is missing or of the wrong kind.
    """
    header: dict[str, Any] = checked(document, FORM, "")
    criteria_of(header)
    return header


def bare_header(problem: str, methods: Mapping[str, str], seed: int) -> dict[str, Any]:
    """Return the header of rows of which nothing else is known.

    Parameters
    ----------
    problem
        Name of the problem.
    methods
        Label -> registered name.
    seed
        Seed of the methods.
    """
    entry = _empty(FORM["methods"][0])
    return {
        **_empty(FORM),
        "problem": problem,
        "response": "response",
        "methods": [{**entry, "label": label, "method": name} for label, name in methods.items()],
        "finished": list(methods),
        "seed": seed,
    }


def _empty(form: Any) -> Any:
    """Return what says nothing in a form."""
    if isinstance(form, dict):
        return {name: _empty(one) for name, one in form.items() if name is not str}
    if isinstance(form, list):
        return []
    return "" if form is str else None


def criteria_of(header: Mapping[str, Any]) -> Criteria:
    """Return the criteria that every method was to answer, from the header of a comparison."""
    remedy = "give what comparison_header returned"
    instance("header", header, (Mapping,), remedy)
    if "criteria" not in header:
        raise refused("header", header, remedy)
    return Criteria(decoded_criterion(one) for one in header["criteria"])


def encoded_criterion(criterion: Criterion) -> dict[str, Any]:
    """Return a criterion as a JSON object."""
    missions: Any = criterion.missions
    if isinstance(missions, Binomial):
        missions = {"planned": missions.planned, "p": missions.p}
    return {
        "threshold": encoded(criterion.threshold),
        "tau": None if criterion.tau is None else encoded(criterion.tau),
        "missions": missions,
    }


def decoded_criterion(document: Mapping[str, Any]) -> Criterion:
    """Return the criterion that `encoded_criterion` was given.

    Raises
    ------
    KeyError, TypeError, ValueError
        If it is none.
    """
    one = checked(document, FORM["criteria"][0], "criteria")
    missions = one["missions"]
    return Criterion(
        float(one["threshold"]),
        None if one["tau"] is None else float(one["tau"]),
        Binomial(missions["planned"], missions["p"]) if isinstance(missions, dict) else missions,
    )


def _system(problem: Problem) -> dict[str, Any]:
    joint = problem.inputs
    roles = ["shared"] * joint.n_shared + ["individual"] * joint.n_individual
    described = zip(joint.names, problem.input_units, roles, joint.columns, strict=True)
    return {
        "units": problem.n_units,
        "structure": repr(problem.structure),
        "inputs": [
            {"name": name, "unit": unit, "role": role, "distribution": str(column)}
            for name, unit, role, column in described
        ],
        "dependence": joint.dependence,
    }


def _modules(plan: ComparisonPlan) -> Iterator[str]:
    """Names of the modules of the methods and of the models."""
    units = plan.problem.units
    own = [] if isinstance(units, int) else [unit.model for unit in units]
    for one in (*plan.methods.values(), plan.problem.model, *own):
        inside = [each for each in getattr(one, "__dict__", {}).values() if callable(each)]
        for each in (one, *inside):
            module = getattr(each, "__module__", None)
            if isinstance(module, str):
                yield module


@cache
def _source(modules: tuple[str, ...]) -> dict[str, str]:
    """Digests of the source as this process has loaded it."""
    return source_digest(*modules)
