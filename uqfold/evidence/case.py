"""A validation case on disk: a folder with ``case.toml`` (what is claimed) and ``measure.py``.

Reading a case reads its TOML file only. `Case.measuring` imports ``measure.py``; nothing but a run
of the case calls it.
"""

from __future__ import annotations

import difflib
import importlib
import os
import sys
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from uqfold.comparison.findings import Verdict
from uqfold.evidence.record import Kind
from uqfold.evidence.schema import check_document

if TYPE_CHECKING:
    from uqfold.evidence.measurement import Measurement
    from uqfold.evidence.work import Work

DECLARATION, MEASURE = "case.toml", "measure.py"


class CaseError(ValueError):
    """A folder is no validation case, or no case has that name."""


@dataclass(frozen=True)
class Fault:
    """A fault to plant: its name, what it makes wrong, and the verdict that it has to give."""

    name: str
    what: str
    turns_to: Verdict = "does not hold"


@dataclass(frozen=True)
class Case:
    """What a case declares; fields as in `record.CaseRecord`.

    Attributes
    ----------
    folder
        Where it lies; its name is that of the case.
    faults
        Faults to plant, at least one.
    needs
        Packages that the full tier needs beyond those of uqfold.
    data
        Folders with data that it reads, relative to the folder that holds the cases' folder.
    """

    folder: Path
    topic: str
    title: str
    claim: str
    kind: Kind
    compared_with: str
    uncertainty: str
    source: str
    seeds: tuple[int, ...]
    tolerance: str
    verdict_rule: str
    faults: tuple[Fault, ...]
    needs: tuple[str, ...] = ()
    data: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.folder.name

    def measuring(self) -> Callable[[Work], Measurement]:
        """Import the case's ``measure.py`` and give its function ``measure``.

        Raises
        ------
        CaseError
            If there is no such function, or another package takes the name of the cases' folder.
        """
        cases = self.folder.parent
        if cases.name in sys.stdlib_module_names:
            # on the path it would hide Python's own module from everything that follows
            raise CaseError(f"{cases.name!r} is the name of a module of Python: rename the folder")
        if str(cases.parent) not in sys.path:
            sys.path.insert(0, str(cases.parent))
        module = importlib.import_module(f"{cases.name}.{self.name}.measure")
        if Path(str(module.__file__)).resolve() != (self.folder / MEASURE).resolve():
            raise CaseError(
                f"{self.name}: Python finds {module.__name__} elsewhere: rename the folder "
                f"{cases.name!r}, or start from the folder that holds it"
            )
        function = getattr(module, "measure", None)
        if not callable(function):
            raise CaseError(f"{self.name}/{MEASURE} defines no function measure(work)")
        return cast("Callable[[Work], Measurement]", function)


def load_case(folder: str | os.PathLike[str]) -> Case:
    """Read the declaration of one case.

    Raises
    ------
    CaseError
        If a file is missing, or ``case.toml`` does not follow the schema ``uqfold-case/1``; the
        message names the field and what is wrong with it.
    """
    path = Path(folder).resolve()
    for name in (DECLARATION, MEASURE):
        if not (path / name).is_file():
            raise CaseError(f"the folder {path.name} is no validation case: it has no {name}")
    try:
        document = tomllib.loads((path / DECLARATION).read_text(encoding="utf-8"))
        check_document(document, "uqfold-case-1")
    except ValueError as error:
        raise CaseError(f"{path.name}/{DECLARATION}: {error}") from error
    faults = tuple(Fault(**one) for one in document["fault"])
    if len({fault.name for fault in faults}) != len(faults):
        raise CaseError(f"{path.name}/{DECLARATION}: two faults have the same name")
    texts: dict[str, Any] = {
        # paragraphs of TOML are one line each
        name: " ".join(value.split())
        for name, value in document.items()
        if isinstance(value, str) and name != "schema"
    }
    return Case(
        folder=path,
        faults=faults,
        seeds=tuple(document["seeds"]),
        needs=tuple(document.get("needs", ())),
        data=tuple(document.get("data", ())),
        **texts,
    )


def find_cases(cases: str | os.PathLike[str], names: Iterable[str] = ()) -> list[Case]:
    """Read the cases of a folder, all or those named, in order of topic and name.

    Raises
    ------
    CaseError
        If there is none, one of them can not be read, or a name is unknown.
    """
    root = Path(cases)
    found = {path.parent.name: path.parent for path in sorted(root.glob(f"*/{DECLARATION}"))}
    if not found:
        raise CaseError(
            f"{root} holds no validation cases: give the folder `validation` of a clone of uqfold "
            "with --cases"
        )
    chosen = list(dict.fromkeys(names)) or list(found)
    for name in chosen:
        if name not in found:
            near = difflib.get_close_matches(name, found, n=1)
            hint = f"do you mean {near[0]}?" if near else "`uqfold validate --list` shows them"
            raise CaseError(f"no validation case is named {name!r}: {hint}")
    return sorted(
        (load_case(found[name]) for name in chosen), key=lambda one: (one.topic, one.name)
    )
