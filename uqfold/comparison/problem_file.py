"""Problems stated in a TOML file: model, inputs, units, criteria; see ``docs/own-model.md``.

The file is data, read strictly. Nothing in it is executed but the model that it names: a function
of a Python file, the command of a program, or a model that a server offers.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from uqfold.checks import choice, refused, several
from uqfold.comparison.own_files import value_of_a_file
from uqfold.comparison.problem_form import (
    MODELS,
    BinomialForm,
    CorrelationForm,
    CriteriaForm,
    FileForm,
    StructureForm,
    checked,
    checked_file,
)
from uqfold.comparison.records import read_records
from uqfold.evaluation import Column, ExternalCode, Regex, UMBridgeModel, per_sample
from uqfold.inputs.assembly import correlated
from uqfold.inputs.named_families import by_name
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criteria, Criterion, Missions, criteria
from uqfold.problems.structure import (
    CutSets,
    KOutOfN,
    Parallel,
    PathSets,
    Series,
    Structure,
    SystemStructure,
)
from uqfold.problems.units import Unit

_MOST_BYTES = 1 << 24
_OUTPUT_NEEDS = "give pattern (a regular expression with one group), or file and column"


def problem_of_a_file(file: Path) -> Callable[[], Problem]:
    """Return what builds the problem that a TOML file states; the file is read and checked at once.

    The model is loaded, or asked for, when the problem is built.

    Raises
    ------
    ValueError
        If it is no such file; the message has the file and the place in it.
    OSError
        If it cannot be opened.
    """
    if not file.is_file():
        raise ValueError(f"name = '{file}': there is no file {file}")
    with _at(str(file)):
        document = _read(file)

    def build() -> Problem:
        with _at(str(file)):
            return _problem(document, file)

    return build


def _read(file: Path) -> FileForm:
    content = file.read_bytes()
    if len(content) > _MOST_BYTES:
        raise ValueError(f"it has more than {_MOST_BYTES:,} bytes")
    try:
        document = tomllib.loads(content.decode("utf-8-sig"))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"it is not UTF-8: {error}") from None
    stated = checked_file(document)
    if not stated["inputs"]:
        raise refused("inputs", stated["inputs"], "give a table [inputs.NAME] for each")
    return stated


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Put a place in front of what is wrong with it."""
    try:
        yield
    except (ValueError, TypeError) as error:
        raise ValueError(f"{place}: {error}") from error
    except OSError as error:
        raise ValueError(f"{place}: {error.filename}: {error.strerror}") from error


def _problem(document: FileForm, file: Path) -> Problem:
    folder, stated = file.parent, dict(document)
    inputs = document["inputs"]
    shared = [name for name, one in inputs.items() if _flag(name, one, "shared")]
    names = [*shared, *(name for name in inputs if name not in shared)]
    marginals = {}
    for name in names:
        with _at(f"inputs.{name}"):
            marginals[name] = _input(inputs[name], folder)
    options: dict[str, Any] = {
        "name": document.get("name", file.stem),
        "input_units": [inputs[name].get("unit", "") for name in names],
        **{key: stated[key] for key in _AS_THEY_ARE if key in stated},
    }
    if "units" in document:
        given = document["units"]
        options["units"] = given if isinstance(given, int) else [Unit(**one) for one in given]
    for key, (option, read) in _READ.items():
        if key in stated:
            with _at(key):
                options[option] = read(stated[key], folder)
    with _at("correlation"):
        joint = correlated(marginals, _pairs(document.get("correlation", [])))
    with _at("model"):
        model, limit_state = _model(document["model"], names, folder)
    if limit_state:
        return Problem.from_limit_state(model, joint, shared=shared, **options)
    return Problem(model, inputs=joint, shared=shared, **options)


def _flag(name: str, given: Mapping[str, Any], key: str) -> bool:
    value = given.get(key, False)
    if not isinstance(value, bool):
        raise refused(f"inputs.{name}.{key}", value, "give true or false", TypeError)
    return value


def _input(given: Mapping[str, Any], folder: Path) -> Any:
    """Return the distribution of one input."""
    parameters = {key: value for key, value in given.items() if key not in ("shared", "unit")}
    if not isinstance(given.get("unit", ""), str):
        raise refused("unit", given["unit"], "give text", TypeError)
    family = parameters.pop("distribution", None)
    if str(family).lower() == "from_data" and "file" in parameters:
        parameters["data"] = _numbers(folder / str(parameters.pop("file")))
    return by_name(family, parameters)


def _numbers(file: Path) -> list[float]:
    """Return the numbers in a text file, one a line or separated by blanks."""
    words = file.read_text(encoding="utf-8").split() if file.is_file() else None
    if not words:
        raise refused("file", str(file), "give a text file of numbers")
    try:
        return [float(word) for word in words]
    except ValueError as error:
        raise refused("file", str(file), f"give a text file of numbers ({error})") from None


def _model(given: Any, names: list[str], folder: Path) -> tuple[Any, bool]:
    """Return the model, and whether it is a limit state."""
    given = {"function": given} if isinstance(given, str) else given
    kind = next((one for one in MODELS if one in given), None)
    if kind is None:
        raise refused("model", given, f"give one of {', '.join(MODELS)}")
    stated: dict[str, Any] = dict(checked(MODELS[kind], given))
    limit_state = stated.pop("limit_state", False)
    if kind == "url":
        return UMBridgeModel(**stated), limit_state
    if kind == "command":
        return _external(stated, names, folder), limit_state
    function = value_of_a_file(stated["function"], folder)
    if not callable(function) or isinstance(function, type):
        raise refused("function", stated["function"], "it is no function of X (n, d)", TypeError)
    return per_sample(function) if stated.get("per_sample") else function, limit_state


def _external(stated: dict[str, Any], names: list[str], folder: Path) -> ExternalCode:
    """Return a program as a model; files beside the problem's file are found there."""
    output = stated.pop("output")
    templates = {to: folder / template for to, template in stated.pop("templates", {}).items()}
    words = [
        str(path.resolve()) if word and (path := folder / word).is_file() else word
        for word in stated.pop("command")
    ]
    if "folder" in stated:
        stated["folder"] = folder / stated["folder"]
    if ("pattern" in output) == ("column" in output):
        raise refused("output", output, _OUTPUT_NEEDS)
    try:
        reads = Regex(**output) if "pattern" in output else Column(**output)
    except TypeError as error:
        raise refused("output", output, f"{_OUTPUT_NEEDS} ({error})") from None
    return ExternalCode(words, names, reads, templates=templates, **stated)


def _pairs(given: Iterable[CorrelationForm]) -> dict[tuple[str, str], tuple[str, float]]:
    """Return pair of inputs -> kind and value of their correlation."""
    pairs: dict[tuple[str, str], tuple[str, float]] = {}
    for one in given:
        kinds = [kind for kind in ("normal", "spearman") if kind in one]
        if len(kinds) != 1 or len(one["between"]) != 2:
            raise refused("correlation", one, "give between (two inputs), and normal or spearman")
        first, second = sorted(one["between"])
        if (first, second) in pairs:
            raise refused("between", one["between"], "give each pair once")
        pairs[first, second] = kinds[0], one[kinds[0]]
    return pairs


def _structure(given: str | StructureForm, folder: Path) -> SystemStructure:
    if isinstance(given, str):
        if set("&|(") & set(given):
            return Structure(given)
        alike = choice("structure", given, ("series", "parallel"))
        return Series() if alike == "series" else Parallel()
    made: dict[str, Callable[[Any], SystemStructure]] = {
        "k_out_of_n": KOutOfN,
        "cut_sets": CutSets,
        "path_sets": PathSets,
        "fault_tree": lambda path: Structure.from_open_psa(folder / path, given.get("top")),
    }
    found = [one for one in made if one in given]
    if len(found) != 1 or ("top" in given and "fault_tree" not in given):
        raise refused("structure", given, f"give one of {', '.join(made)}")
    return made[found[0]](dict(given)[found[0]])


def _missions(given: int | BinomialForm) -> Missions:
    return given if isinstance(given, int) else Binomial(given["planned"], given["p"])


def _criteria(given: CriteriaForm, _: Path) -> Criteria:
    missions = given.get("missions", 1)
    each = missions if isinstance(missions, list) else [missions]
    return criteria(given["threshold"], given.get("tau"), [_missions(one) for one in each])


def _references(given: Any, folder: Path) -> Any:
    if isinstance(given, str):
        return read_records(folder / given)
    if not all(isinstance(one, dict) for one in given):
        return several("references", given, lambda _, one: one)
    if not any({"threshold", "tau", "missions"} & set(one) for one in given):
        return [(one["pf"], one.get("std_error", 0.0)) for one in given]
    without = next((one for one in given if "threshold" not in one), None)
    if without is not None:
        raise refused("references", without, "give the threshold that it answers")
    return {
        Criterion(one["threshold"], one.get("tau"), _missions(one.get("missions", 1))): (
            one["pf"], one.get("std_error", 0.0)
        )
        for one in given
    }  # fmt: skip


_AS_THEY_ARE = ("response", "response_unit", "version")
_READ: dict[str, tuple[str, Callable[[Any, Path], Any]]] = {
    "criteria": ("default_criteria", _criteria),
    "references": ("references", _references),
    "structure": ("structure", _structure),
}
"""Field -> the option of `Problem` that it becomes, and what reads it."""
