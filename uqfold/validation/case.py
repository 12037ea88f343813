"""Validation cases on disk: a folder with ``case.toml`` (what is claimed) and ``measure.py``.

A folder may declare several cases that one ``measure.py`` measures: what they share stands above,
what is their own in tables ``[[case]]``. Reading a case reads its TOML file only.
"""

from __future__ import annotations

import difflib
import os
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter

from uqfold.documents import said
from uqfold.methods.seeding import LARGEST_SEED

SCHEMA = "uqfold-case/1"
DECLARATION, MEASURE = "case.toml", "measure.py"

Kind: TypeAlias = Literal[
    "paper claim", "outside reference", "exact solution", "cross-code", "benchmark", "coverage"
]
Topic: TypeAlias = Literal["mechanism", "examples", "methods", "paper", "speed"]
Tier: TypeAlias = Literal["quick", "full"]
TIERS: tuple[Tier, ...] = ("quick", "full")
# paragraphs of TOML are one line each
Text = Annotated[str, Field(min_length=1), AfterValidator(lambda text: " ".join(text.split()))]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+$")]
Seed = Annotated[int, Field(strict=True, ge=0, le=LARGEST_SEED)]
STRICT = ConfigDict(extra="forbid", ser_json_inf_nan="strings")


class CaseError(ValueError):
    """A folder is not a validation case, or no case has that name."""


@dataclass(frozen=True)
class Fault:
    """A fault to plant: its name, what it makes wrong, and the verdict that it has to give.

    A claim that does not hold is shown to be able to by planting a remedy, which turns to
    ``holds``. Of a case with several claims, those that are listed have to turn, each of them.
    """

    __pydantic_config__ = STRICT

    name: Text
    what: Text
    turns_to: Literal["does not hold", "holds"] = "does not hold"
    claims: tuple[str, ...] = ()


@dataclass(frozen=True)
class Declaration:
    """What a case states before anything is measured; its record repeats it.

    Attributes
    ----------
    name, topic, title
        Name of the case, the group it belongs to, and a short title.
    claim
        What is claimed, in one sentence.
    kind
        What the numbers are compared with, in a word.
    compared_with, uncertainty, source
        The same in full, how uncertain that is itself, and where it comes from.
    seeds
        Seeds of whatever is random.
    tolerance
        The tolerance and why it is that one.
    verdict_rule
        How the findings give the verdict.
    """

    __pydantic_config__ = STRICT

    name: Name
    topic: Topic
    title: Text
    claim: Text
    kind: Kind
    compared_with: Text
    uncertainty: Text
    source: Text
    seeds: tuple[Seed, ...]
    tolerance: Text
    verdict_rule: Text


@dataclass(frozen=True)
class Case:
    """A case to measure.

    Attributes
    ----------
    folder
        Where it lies.
    declared
        What it states.
    faults
        Faults to plant, at least one.
    needs
        Packages that the full tier needs beyond those of uqfold.
    data
        Folders with data that it reads, relative to the folder that holds the cases' folder.
    settings
        What tells it from other cases of its folder, for its ``measure.py``.
    """

    folder: Path
    declared: Declaration
    faults: Annotated[tuple[Fault, ...], Field(min_length=1)]
    needs: tuple[Name, ...] = ()
    data: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.declared.name

    def kept(self, tier: Tier) -> Path:
        """Return where the record of a tier is kept, beside the case."""
        stem = tier if self.name == self.folder.name else f"{self.name}.{tier}"
        return self.folder / f"{stem}.json"


_CASE = TypeAdapter(Case)


def load_cases(folder: str | os.PathLike[str]) -> list[Case]:
    """Read the declarations of a folder, mostly one.

    Raises
    ------
    CaseError
        If a file is missing, or ``case.toml`` does not follow the schema; the message names the
        field and what is wrong with it.
    """
    path = Path(folder).resolve()
    for name in (DECLARATION, MEASURE):
        if not (path / name).is_file():
            raise CaseError(f"the folder {path.name} is not a validation case: it has no {name}")
    try:
        document = tomllib.loads((path / DECLARATION).read_text(encoding="utf-8"))
        if document.pop("schema", None) != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA!r}")
        return [_case(path, document | own) for own in document.pop("case", [{}])]
    except ValueError as error:
        what = said(error, Declaration.__dataclass_fields__).replace("declared.", "", 1)
        raise CaseError(f"{path.name}/{DECLARATION}: {what}") from error


def find_cases(cases: str | os.PathLike[str], names: Iterable[str] = ()) -> list[Case]:
    """Read the cases of a folder, all or those named, in order of topic and name.

    Raises
    ------
    CaseError
        If there is none, one of them cannot be read, or a name is unknown.
    """
    root = Path(cases)
    folders = sorted(path.parent for path in root.glob(f"*/{DECLARATION}"))
    found = {case.name: case for folder in folders for case in load_cases(folder)}
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
    return sorted((found[name] for name in chosen), key=lambda one: (one.declared.topic, one.name))


def _case(folder: Path, document: dict[str, Any]) -> Case:
    own = {"faults": document.pop("fault", ())}
    own |= {key: document.pop(key) for key in ("needs", "data", "settings") if key in document}
    declared = {"name": folder.name} | document
    case = _CASE.validate_python({"folder": folder, "declared": declared} | own)
    if len({fault.name for fault in case.faults}) != len(case.faults):
        raise ValueError("two faults have the same name")
    return case
