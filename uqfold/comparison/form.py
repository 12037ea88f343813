"""The form of a record: what is in it, from which pydantic checks it and makes its JSON Schema.

Strict JSON knows neither NaN nor infinity: NaN is written as null, infinities as texts. What each
field means is said in ``docs/records.md``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, NotRequired, TypeAlias

from pydantic import AfterValidator, BeforeValidator, ConfigDict, TypeAdapter, WithJsonSchema

# the one of `typing` can be checked from Python 3.12 on
from typing_extensions import TypedDict

from uqfold.comparison.columns import COLUMNS
from uqfold.comparison.possible_rows import possible_answer

SCHEMA: Literal["uqfold-comparison/3"] = "uqfold-comparison/3"
_INFINITE = {"inf": math.inf, "-inf": -math.inf}
_JSON_NUMBER = [{"type": "number"}, {"enum": list(_INFINITE)}]


def _level(value: Any) -> Any:
    return _INFINITE.get(value, value) if isinstance(value, str) else value


def _number(value: Any) -> Any:
    return math.nan if value is None else _level(value)


def _text(value: Any) -> Any:
    # pandas reads an empty cell of a CSV file as NaN
    return "" if isinstance(value, float) and math.isnan(value) else value


_Level = Annotated[float, BeforeValidator(_level), WithJsonSchema({"anyOf": _JSON_NUMBER})]
_Number = Annotated[
    float, BeforeValidator(_number), WithJsonSchema({"anyOf": [*_JSON_NUMBER, {"type": "null"}]})
]
_Text = Annotated[str, BeforeValidator(_text)]


class _Binomial(TypedDict):
    planned: int
    p: float


class _Criterion(TypedDict):
    threshold: _Level
    tau: _Level | None
    missions: int | _Binomial


class _Input(TypedDict):
    name: str
    unit: str
    role: str
    distribution: str


class _System(TypedDict):
    units: int
    structure: str
    inputs: list[_Input]
    dependence: str
    models: NotRequired[dict[str, str]]
    offsets: NotRequired[dict[str, _Level]]


class _Equation(TypedDict):
    lead: str
    latex: str
    source: str


class _Theory(TypedDict):
    summary: str
    equations: list[_Equation]
    references: list[str]


class _Method(TypedDict):
    label: str
    method: str
    title: str
    settings: str
    theory: _Theory


class _Reference(TypedDict):
    kind: str
    how: str
    command: str


class _Header(TypedDict):
    problem: str
    response: str
    response_unit: str
    system: _System | None
    criteria: list[_Criterion]
    methods: list[_Method]
    finished: list[str]
    seed: int
    max_evals: int | None
    failed_runs: str
    error_parts: NotRequired[dict[str, dict[str, float]]]
    reference: _Reference | None
    command: str
    date: str
    machine: str
    versions: dict[str, str]
    source: dict[str, str]


_OF_BENCHMARK: dict[str, Any] = {
    "schema": Literal["uqfold-benchmark/1"], "max_evals": _Level, "inputs": int,
    "covered": bool | None, "settings": str, "code": str, "date": str, "command": str,
}  # fmt: skip

if TYPE_CHECKING:
    RowForm: TypeAlias = dict[str, Any]
    AnswerForm: TypeAlias = dict[str, Any]
else:
    _FORMS = {float: _Number, int: int, str: _Text}
    _OF_ROWS = {name: _FORMS[kind] for name, kind in COLUMNS.items()}
    RowForm = TypedDict("RowForm", _OF_ROWS)
    _Answer = TypedDict("_Answer", _OF_ROWS | _OF_BENCHMARK)
    # numbers of missions are text, and numbers in a CSV file
    RowForm.__pydantic_config__ = ConfigDict(extra="forbid", coerce_numbers_to_str=True)
    _Answer.__pydantic_config__ = ConfigDict(extra="forbid")
    AnswerForm = Annotated[_Answer, AfterValidator(possible_answer)]


class _Record(_Header):
    schema: Literal["uqfold-comparison/3"]
    columns: list[str]
    sha256: NotRequired[str]
    rows: list[RowForm]


HEADER = TypeAdapter(_Header)
ROWS = TypeAdapter(list[RowForm])
RECORD = TypeAdapter(_Record)
ANSWER = TypeAdapter(AnswerForm)
OF_BENCHMARK = tuple(_OF_BENCHMARK)
"""Fields of a row of a benchmark besides those of a comparison."""


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
