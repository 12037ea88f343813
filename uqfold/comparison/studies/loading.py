"""Reading a study file: everything that can be wrong with it is found here, before any work."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from uqfold.comparison.studies.builtin import BUILT_IN
from uqfold.comparison.studies.document import Place, nearest, read_document
from uqfold.comparison.studies.keys import (
    COLUMN,
    TABLE_NAME,
    TABLE_NAMES,
    WHERE,
    Key,
    Kind,
    listed,
    read_table,
)
from uqfold.comparison.studies.problems import ProblemSpec, read_problem
from uqfold.comparison.studies.registry import step_kinds
from uqfold.comparison.studies.study import (
    ANALYSIS_KEYS,
    CHECK_KEYS,
    EXHIBIT_KEYS,
    FILE_NAME,
    METHOD_KEYS,
    METHOD_KEYS_OF_ANALYSES,
    QUICK,
    RUN_KEYS,
    STUDY_KEYS,
    RunSpec,
    Spec,
    Study,
)
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.registry import available
from uqfold.problems.criterion import criteria

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


def load_study(
    folder: Path, figures: Mapping[str, Kind], tables: Mapping[str, Kind], *, quick: bool = False
) -> Study:
    """Read and check a study; nothing is run, and nothing of the user's is imported.

    Parameters
    ----------
    folder
        The folder that holds ``study.toml``, or that file.
    figures, tables
        The kinds that the report offers.
    quick
        Whether to read the reduced form; the full form is checked all the same.

    Raises
    ------
    StudyError
        For whatever is wrong; the message names file, line, key and remedy.
    """
    file = folder if folder.name == FILE_NAME else folder / FILE_NAME
    content, place = read_document(file)
    loader = _Loader(file, place, read_table(content, place, STUDY_KEYS), figures, tables)
    full = loader.study(quick=False)
    return loader.study(quick=True) if quick else full


@dataclass
class _Loader:
    file: Path
    place: Place
    top: dict[str, Any]
    figure_kinds: Mapping[str, Kind]
    table_kinds: Mapping[str, Kind]
    problems: dict[str, ProblemSpec] = field(default_factory=dict)
    methods: dict[str, ReliabilityMethod] = field(default_factory=dict)

    def study(self, *, quick: bool) -> Study:
        folder = self.file.parent
        for name, content in self.top["problems"].items():
            place = self.place.at("problems").at(name)
            self.problems[name] = read_problem(name, content, place, folder)
        for label, content in self.top["methods"].items():
            self.methods[label] = _method(content, self.place.at("methods").at(label))
        runs = tuple(self._run(*one, quick) for one in self._array("run"))
        analyses = tuple(self._analysis(*one, quick) for one in self._array("analysis"))
        _all_different("name", runs + analyses, self.place)
        named: dict[str, Sequence[RunSpec | Spec]] = {"run": runs, "analysis": analyses}
        for array, specs in named.items():
            for i, spec in enumerate(specs):
                if spec.name in BUILT_IN:
                    place = self.place.at(array).at(i).at("name")
                    raise place.error(f"{spec.name!r} is the name of a table that every study has")
        study = Study(
            folder=folder,
            title=self.top["title"],
            question=self.top["question"],
            notes=self.top["notes"],
            problems=self.problems,
            methods=self.methods,
            runs=runs,
            analyses=analyses,
            tables=(),
            figures=(),
            check=read_table(self.top["check"], self.place.at("check"), CHECK_KEYS),
            digest=_digest(self.top),
            quick=quick,
        )
        if not runs + analyses:
            raise self.place.error("there is nothing to do: state a [[run]] or an [[analysis]]")
        shown = {
            name: tuple(
                self._exhibit(content, place, kinds, study.columns)
                for content, place in self._array(name)
            )
            for name, kinds in (("table", self.table_kinds), ("figure", self.figure_kinds))
        }
        _all_different("name", shown["table"] + shown["figure"], self.place)
        return dataclasses.replace(study, tables=shown["table"], figures=shown["figure"])

    def _array(self, name: str) -> list[tuple[dict[str, Any], Place]]:
        place = self.place.at(name)
        return [(content, place.at(i)) for i, content in enumerate(self.top[name])]

    def _run(self, content: dict[str, Any], place: Place, quick: bool) -> RunSpec:
        read = _with_quick(content, place, RUN_KEYS, quick)
        for name in read["problem"]:
            self._known(name, self.problems, place.at("problem"))
        for label in read["methods"]:
            if label not in self.methods:
                self._known(label, available(), place.at("methods"), self.methods)
                self.methods[label] = available()[label]()
        try:
            grid = criteria(read["thresholds"], read["tau"], read["missions"])
        except ValueError as error:
            raise place.error(str(error)) from error
        return RunSpec(
            name=_checked_name(read["name"], place),
            problems=_unique(read["problem"], place.at("problem")),
            methods=_unique(read["methods"], place.at("methods")),
            criteria=grid,
            budgets=_unique(read["max_evals"], place.at("max_evals")),
            seeds=read["seeds"],
        )

    def _analysis(self, content: dict[str, Any], place: Place, quick: bool) -> Spec:
        kind = _kind(content, place, step_kinds())
        read = _with_quick(content, place, (*ANALYSIS_KEYS, *kind.keys), quick)
        for key in ("problem", "problems"):
            for name in listed(read.get(key)):
                self._known(name, self.problems, place.at(key))
        for key in METHOD_KEYS_OF_ANALYSES:
            for label in listed(read.get(key)):
                if label not in self.methods:
                    self._known(label, available(), place.at(key), self.methods)
                    self.methods[label] = available()[label]()
        return Spec(_checked_name(read["name"], place), kind, _own(kind, read))

    def _exhibit(
        self,
        content: dict[str, Any],
        place: Place,
        kinds: Mapping[str, Kind],
        columns: Mapping[str, Mapping[str, type]],
    ) -> Spec:
        kind = _kind(content, place, kinds)
        read = read_table(content, place, (*EXHIBIT_KEYS, *kind.keys))
        asked = []
        for key in kind.keys:
            if key.value in (TABLE_NAME, TABLE_NAMES):
                for table in listed(read[key.name]):
                    self._known(table, columns, place.at(key.name))
                    lacking = [name for name in kind.needs if name not in columns[table]]
                    if lacking:
                        raise place.at(key.name).error(
                            f"{table!r} has no column {lacking[0]!r}, which kind {kind.name} needs"
                        )
                    asked.append(table)
        here = list(dict.fromkeys(column for table in asked for column in columns[table]))
        for key in kind.keys:
            if key.value is COLUMN and read[key.name] is not None:
                self._known(read[key.name], here, place.at(key.name))
            if key.value is WHERE:
                for column in read[key.name]:
                    self._known(column, here, place.at(key.name).at(column))
        name = _checked_name(read["name"], place)
        return Spec(name, kind, _own(kind, read), read["title"], read["caption"])

    def _known(self, name: str, known: Any, place: Place, further: Any = ()) -> None:
        if name not in known:
            raise place.error(f"{name!r} is unknown; {nearest(name, [*known, *further])}")


def _digest(top: Mapping[str, Any]) -> str:
    """Give the digest of all that a study asks for; how it is shown does not belong to it."""
    asked = {name: top[name] for name in ("problems", "methods", "run", "analysis")}
    return hashlib.sha256(json.dumps(asked, sort_keys=True, default=str).encode()).hexdigest()


def _with_quick(
    content: dict[str, Any], place: Place, keys: Sequence[Key], quick: bool
) -> dict[str, Any]:
    """Read a table whose key `quick` replaces some of the others in the reduced form."""
    read = read_table(content, place, keys)
    by_name = {key.name: key for key in keys}
    for name, value in read[QUICK.name].items():
        where = place.at(QUICK.name).at(name)
        if name not in by_name or name in {QUICK.name, "name", "kind"}:
            raise where.error(f"no key that quick may replace; {nearest(name, by_name)}")
        replaced = by_name[name].value.read(value, where)
        if quick:
            read[name] = replaced
    return read


def _method(content: Any, place: Place) -> ReliabilityMethod:
    read = read_table(content, place, METHOD_KEYS)
    name, settings = read["method"], dict(read["settings"])
    if name not in available():
        raise place.at("method").error(f"{name!r} is unknown; {nearest(name, available())}")
    method = available()[name]
    known = [one.name for one in dataclasses.fields(method) if one.init]
    for key, value in settings.items():
        where = place.at("settings").at(key)
        if key not in known:
            raise where.error(f"{name} has no such setting; {nearest(key, known)}")
        if isinstance(value, list):
            settings[key] = tuple(value)
    try:
        return method(**settings)
    except (TypeError, ValueError) as error:
        raise place.at("settings").error(str(error)) from error


def _kind(content: dict[str, Any], place: Place, kinds: Mapping[str, Kind]) -> Kind:
    name = content.get("kind")
    if not isinstance(name, str) or name not in kinds:
        shown = "the key kind is missing" if name is None else f"{name!r} is unknown"
        raise place.at("kind").error(f"{shown}; {nearest(str(name), kinds)}")
    return kinds[name]


def _own(kind: Kind, read: Mapping[str, Any]) -> dict[str, Any]:
    return {key.name: read[key.name] for key in kind.keys}


def _checked_name(name: str, place: Place) -> str:
    if not _NAME.fullmatch(name):
        raise place.at("name").error(
            f"{name!r}: names become files; use letters, digits, point, dash, underscore"
        )
    return name


def _unique(values: tuple[Any, ...], place: Place) -> tuple[Any, ...]:
    for i, value in enumerate(values):
        if value in values[:i]:
            raise place.at(i).error(f"{value!r} occurs twice")
    return values


def _all_different(what: str, specs: Sequence[RunSpec | Spec], place: Place) -> None:
    names = [spec.name.lower() for spec in specs]
    for name in names:
        if names.count(name) > 1:
            raise place.error(f"the {what} {name!r} occurs twice")
