"""The form of a TOML file that states a problem, from which pydantic checks it."""

from __future__ import annotations

from typing import Any, NotRequired

from pydantic import ConfigDict, TypeAdapter

# the one of `typing` can be checked from Python 3.12 on
from typing_extensions import TypedDict

from uqfold.documents import said


class FunctionForm(TypedDict):
    """A model that is a function of a Python file; as text, the function alone."""

    function: str
    per_sample: NotRequired[bool]
    limit_state: NotRequired[bool]


class OutputForm(TypedDict):
    """Where a program leaves the response: `Regex`, or `Column`."""

    pattern: NotRequired[str]
    file: NotRequired[str]
    column: NotRequired[int]
    row: NotRequired[int]
    delimiter: NotRequired[str]


class CommandForm(TypedDict):
    """A model that is a program: `ExternalCode`."""

    command: list[str]
    output: OutputForm
    templates: NotRequired[dict[str, str]]
    timeout: NotRequired[float]
    parallel: NotRequired[int]
    folder: NotRequired[str]
    keep: NotRequired[str]
    limit_state: NotRequired[bool]


class ServedForm(TypedDict):
    """A model that a server offers: `UMBridgeModel`."""

    url: str
    name: str
    output: NotRequired[int]
    config: NotRequired[dict[str, Any]]
    timeout: NotRequired[float]
    parallel: NotRequired[int]
    limit_state: NotRequired[bool]


class CorrelationForm(TypedDict):
    """How two inputs depend on each other, by a normal copula."""

    between: list[str]
    normal: NotRequired[float]
    spearman: NotRequired[float]


class UnitForm(TypedDict):
    """One of several units that differ."""

    name: NotRequired[str]
    offset: NotRequired[float]


class StructureForm(TypedDict):
    """How units make up the system, where a word does not say it."""

    k_out_of_n: NotRequired[int]
    cut_sets: NotRequired[list[list[int]]]
    path_sets: NotRequired[list[list[int]]]
    fault_tree: NotRequired[str]
    top: NotRequired[str]


class BinomialForm(TypedDict):
    """A binomial number of missions."""

    planned: int
    p: float


class CriteriaForm(TypedDict):
    """The grid of criteria."""

    threshold: float | list[float]
    tau: NotRequired[float | list[float]]
    missions: NotRequired[int | BinomialForm | list[int | BinomialForm]]


class KnownForm(TypedDict):
    """A known answer."""

    pf: float
    threshold: NotRequired[float]
    tau: NotRequired[float]
    missions: NotRequired[int | BinomialForm]
    std_error: NotRequired[float]


class FileForm(TypedDict):
    """The whole file."""

    model: str | dict[str, Any]
    inputs: dict[str, dict[str, Any]]
    name: NotRequired[str]
    response: NotRequired[str]
    response_unit: NotRequired[str]
    version: NotRequired[str]
    correlation: NotRequired[list[CorrelationForm]]
    units: NotRequired[int | list[UnitForm]]
    structure: NotRequired[str | StructureForm]
    criteria: NotRequired[CriteriaForm]
    references: NotRequired[str | list[float] | list[KnownForm]]


_FORMS: tuple[Any, ...] = (
    FunctionForm, OutputForm, CommandForm, ServedForm, CorrelationForm, UnitForm, StructureForm,
    BinomialForm, CriteriaForm, KnownForm, FileForm,
)  # fmt: skip
for _form in _FORMS:
    _form.__pydantic_config__ = ConfigDict(extra="forbid", strict=True)

_FILE = TypeAdapter(FileForm)
MODELS: dict[str, TypeAdapter[Any]] = {
    "function": TypeAdapter(FunctionForm),
    "command": TypeAdapter(CommandForm),
    "url": TypeAdapter(ServedForm),
}
"""The field that tells kinds of models apart -> the form of that kind."""


def checked_file(document: Any) -> FileForm:
    """Return what a file states, if it has the form of a problem.

    Raises
    ------
    ValueError
        Naming the place that is wrong.
    """
    stated: FileForm = checked(_FILE, document)
    return stated


def checked(form: TypeAdapter[Any], value: Any) -> Any:
    """Return what a form lets pass; raise ValueError, naming the place that is wrong."""
    try:
        return form.validate_python(value)
    except ValueError as error:
        fields = [name for one in _FORMS for name in one.__annotations__]
        raise ValueError(said(error, fields)) from None
