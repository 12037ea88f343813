"""The form of a record: what is in it, from which pydantic checks it and makes its JSON Schema.

Strict JSON knows neither NaN nor infinity: NaN is written as null, infinities as texts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, NotRequired, TypeAlias

from pydantic import BeforeValidator, ConfigDict, TypeAdapter, WithJsonSchema

# the one of `typing` can be checked from Python 3.12 on
from typing_extensions import TypedDict

from uqfold.comparison.columns import COLUMNS

SCHEMA: Literal["uqfold-comparison/3"] = "uqfold-comparison/3"
_INFINITE = {"inf": math.inf, "-inf": -math.inf}


def _level(value: Any) -> Any:
    return _INFINITE.get(value, value) if isinstance(value, str) else value


def _number(value: Any) -> Any:
    return math.nan if value is None else _level(value)


def _text(value: Any) -> Any:
    # pandas reads an empty cell of a CSV file as NaN
    return "" if isinstance(value, float) and math.isnan(value) else value


_AS_TEXT = {"enum": list(_INFINITE)}
Level = Annotated[
    float, BeforeValidator(_level), WithJsonSchema({"anyOf": [{"type": "number"}, _AS_TEXT]})
]
Number = Annotated[
    float,
    BeforeValidator(_number),
    WithJsonSchema({"anyOf": [{"type": "number"}, _AS_TEXT, {"type": "null"}]}),
]
Text = Annotated[str, BeforeValidator(_text)]


class BinomialForm(TypedDict):
    """A binomial number of missions."""

    planned: int
    p: float


class CriterionForm(TypedDict):
    """One criterion."""

    threshold: Level
    tau: Level | None
    missions: int | BinomialForm


class InputForm(TypedDict):
    """One random input."""

    name: str
    unit: str
    role: str
    distribution: str


class SystemForm(TypedDict):
    """What may fail."""

    units: int
    structure: str
    inputs: list[InputForm]
    dependence: str


class EquationForm(TypedDict):
    """One equation, as in `uqfold.methods.theory.Equation`."""

    lead: str
    latex: str
    source: str


class TheoryForm(TypedDict):
    """What a method states of itself, as in `uqfold.methods.theory.Theory`."""

    summary: str
    equations: list[EquationForm]
    references: list[str]


class MethodForm(TypedDict):
    """One method that was asked for."""

    label: str
    method: str
    title: str
    settings: str
    theory: TheoryForm


class ReferenceForm(TypedDict):
    """Where the references come from."""

    kind: str
    how: str
    command: str


class Header(TypedDict):
    """How a comparison was made; ``docs/records.md`` says what each field means."""

    problem: str
    response: str
    response_unit: str
    system: SystemForm | None
    criteria: list[CriterionForm]
    methods: list[MethodForm]
    finished: list[str]
    seed: int
    max_evals: int | None
    failed_runs: str
    reference: ReferenceForm | None
    command: str
    date: str
    machine: str
    versions: dict[str, str]
    source: dict[str, str]


if TYPE_CHECKING:
    RowForm: TypeAlias = dict[str, Any]
else:
    _FORMS = {float: Number, int: int, str: Text}
    RowForm = TypedDict("RowForm", {name: _FORMS[kind] for name, kind in COLUMNS.items()})
    # numbers of missions are text, and numbers in a CSV file
    RowForm.__pydantic_config__ = ConfigDict(extra="forbid", coerce_numbers_to_str=True)


class Record(Header):
    """A whole record."""

    schema: Literal["uqfold-comparison/3"]
    columns: list[str]
    sha256: NotRequired[str]
    rows: list[RowForm]


HEADER = TypeAdapter(Header)
ROWS = TypeAdapter(list[RowForm])
RECORD = TypeAdapter(Record)


def record_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``comparison.json``, made from what checks it."""
    return RECORD.json_schema()


def encoded(value: Any) -> Any:
    """Return a value as strict JSON has it, with all that is in it."""
    if isinstance(value, Mapping):
        return {name: encoded(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [encoded(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value
