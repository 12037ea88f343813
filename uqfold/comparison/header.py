"""How a comparison was made: one plain dict, in ``frame.attrs`` and above the rows of a record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from functools import cache
from typing import Any

from uqfold.checks import instance, refused
from uqfold.comparison.form import HEADER, encoded
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.theory import Theory
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criteria, Criterion
from uqfold.problems.reference import ReferenceTable
from uqfold.provenance import made_by, source_digest


def header_of(
    problem: Problem,
    methods: Mapping[str, ReliabilityMethod],
    command: str,
    known: ReferenceTable | None,
) -> dict[str, Any]:
    """Return who is to answer what about which problem, now and with the code installed here."""
    made = made_by(command=command)
    units = () if isinstance(problem.units, int) else problem.units
    models = [problem.model, problem.gradient, *(unit.model for unit in units)]
    return {
        "problem": problem.name,
        "response": problem.response,
        "response_unit": problem.response_unit,
        "system": system_of(problem),
        "methods": [
            {
                "label": label,
                "method": method.name,
                "title": method.title,
                "settings": repr(method),
                "theory": encoded(asdict(Theory.of(type(method)))),
            }
            for label, method in methods.items()
        ],
        "reference": known and {name: getattr(known, name) for name in ("kind", "how", "command")},
        **{name: made[name] for name in ("command", "date", "machine", "versions")},
        "source": source_of(*methods.values(), *models),
    }


def source_of(*things: object) -> dict[str, str]:
    """Return digests of the source that methods and models depend on, by part."""
    return dict(_source(tuple(sorted(set(_modules(things))))))


def checked_header(document: Any) -> dict[str, Any]:
    """Return the header that a document holds; what else it holds is left out.

    Raises
    ------
    ValueError, TypeError
        If a field is missing or of the wrong kind.
    """
    header: dict[str, Any] = dict(HEADER.validate_python(document, strict=True))
    criteria_of(header)
    return header


def criteria_of(header: Mapping[str, Any]) -> Criteria:
    """Return the criteria that every method was to answer, from the header of a comparison."""
    remedy = "give what comparison_header returned"
    instance("header", header, (Mapping,), remedy)
    if "criteria" not in header:
        raise refused("header", header, remedy)
    return Criteria(
        Criterion(
            one["threshold"],
            one["tau"],
            Binomial(**one["missions"]) if isinstance(one["missions"], dict) else one["missions"],
        )
        for one in header["criteria"]
    )


def system_of(problem: Problem) -> dict[str, Any]:
    """Return units, structure and inputs of a problem in words and numbers."""
    joint = problem.inputs
    roles = ["shared"] * joint.n_shared + ["individual"] * joint.n_individual
    described = list(zip(joint.names, problem.input_units, roles, joint.columns, strict=True))
    kinds = problem.kinds
    for i, kind in enumerate([] if kinds.of_units is None else kinds.of_units.tolist()):
        own, unit = kinds.inputs[kind], problem.unit_names[i]
        if own is not joint:
            described += [
                (f"{name} of {unit}", "", "individual", column)
                for name, column in zip(own.names, own.columns, strict=True)
            ][own.n_shared :]
    system = {
        "units": problem.n_units,
        "structure": repr(problem.structure),
        "inputs": [
            {"name": name, "unit": unit, "role": role, "distribution": str(column)}
            for name, unit, role, column in described
        ],
        "dependence": joint.dependence,
    }
    if kinds.of_units is not None and len(kinds.models) > 1:
        models = [_named(kinds.models[kind]) for kind in kinds.of_units.tolist()]
        system["models"] = dict(zip(problem.unit_names, models, strict=True))
    if kinds.offsets is not None and kinds.offsets.any():
        system["offsets"] = dict(zip(problem.unit_names, kinds.offsets.tolist(), strict=True))
    return system


def _named(model: Any) -> str:
    """Name of a model's function, or of its class."""
    function = getattr(model, "__qualname__", type(model).__qualname__)
    return f"{getattr(model, '__module__', '')}.{function}"


def _modules(things: Iterable[object]) -> Iterator[str]:
    """Names of the modules of methods and models, and of the functions that they hold."""
    for one in things:
        inside = [each for each in getattr(one, "__dict__", {}).values() if callable(each)]
        for each in (one, *inside):
            module = getattr(each, "__module__", None)
            if isinstance(module, str):
                yield module


@cache
def _source(modules: tuple[str, ...]) -> dict[str, str]:
    """Digests of the source as this process has loaded it."""
    return source_digest(*modules)
