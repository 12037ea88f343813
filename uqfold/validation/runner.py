"""Measuring cases: one record per case, whatever happens inside it."""

from __future__ import annotations

import importlib
import shlex
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import cast

from uqfold.provenance import changed_parts, made_by, source_digest
from uqfold.validation.case import DECLARATION, MEASURE, Case, CaseError, Fault, Tier
from uqfold.validation.findings import Verdict
from uqfold.validation.measurement import Measurement
from uqfold.validation.record import CaseRecord, PlantedFault, existing_record, write_case_record
from uqfold.validation.work import Work

FRAME = ("uqfold.validation",)
"""What measures and keeps records makes no numbers."""

CaseProgress = Callable[[str, int, int | None], None]
"""Called with a case's name, its finished parts (0: it starts), and how many there are."""


@dataclass(frozen=True)
class Validation:
    """How cases are to be measured.

    Attributes
    ----------
    tier
        How thoroughly.
    folder
        Where records go.
    faults
        Whether the cases' faults are planted too, one by one, in the size of the quick tier.
    progress
        Told what is going on; whatever it raises ends the run.
    """

    tier: Tier
    folder: Path
    faults: bool = False
    progress: CaseProgress = lambda _name, _done, _total: None

    def run(self, case: Case) -> CaseRecord:
        """Measure one case and write its record.

        A full record that lies in the folder already, of the same code and without an error, is
        not measured again: this is how an interrupted full run goes on.
        """
        path = self.folder / f"{case.name}.json"
        record = self._finished(case, path) or self._measured(case)
        write_case_record(record, path)
        return record

    def _finished(self, case: Case, path: Path) -> CaseRecord | None:
        record = existing_record(path) if self.tier == "full" else None
        if record is None or record.tier != "full" or record.error or record.case != case.declared:
            return None
        untried = self.faults and any(one.verdict is None for one in record.faults)
        return None if untried or changed_since(record, case) else record

    def _measured(self, case: Case) -> CaseRecord:
        tell = partial(self.progress, case.name)
        tell(0, None)
        made = made_by(
            *sources(case),
            settings=case.settings,
            command=command(case, self.tier),
            packages=case.needs if self.tier == "full" else (),
            without=FRAME,
        )
        start = time.perf_counter()
        work = Work(self.tier, None, case.declared.seeds, case.settings, tell)
        measurement, error = _attempt(case, work)
        seconds = round(time.perf_counter() - start, 2)
        faults = tuple(self._planted(case))
        return CaseRecord(case.declared, self.tier, measurement, made, seconds, faults, error)

    def _planted(self, case: Case) -> Iterator[PlantedFault]:
        for fault in case.faults:
            yield PlantedFault(fault, verdict_with(fault, case) if self.faults else None)
            if self.faults:
                self.progress(case.name, 0, None)


def verdict_with(fault: Fault, case: Case) -> Verdict:
    """Plant a fault, in the size of the quick tier; return the verdict to judge it by.

    Where it is aimed at several claims this is the first one that has not turned.
    """
    found, error = _attempt(case, Work("quick", fault.name, case.declared.seeds, case.settings))
    if error or not fault.claims:
        return found.verdict
    verdicts = [found.claim_verdicts[key] for key in fault.claims]
    return next((one for one in verdicts if one != fault.turns_to), fault.turns_to)


def measuring(case: Case) -> Callable[[Work], Measurement]:
    """Import the ``measure.py`` of a case and return its function ``measure``.

    Raises
    ------
    CaseError
        If there is no such function, or another package has the name of the cases' folder.
    """
    cases = case.folder.parent
    if str(cases.parent) not in sys.path:
        # at the end, where it hides nothing
        sys.path.append(str(cases.parent))
    package = find_spec(cases.name)
    places = package.submodule_search_locations if package else None
    if not any(Path(place).resolve() == cases for place in places or ()):
        raise CaseError(
            f"Python finds another module {cases.name!r}: rename the folder, or start from the "
            "folder that holds it"
        )
    module = importlib.import_module(f"{cases.name}.{case.folder.name}.measure")
    function = getattr(module, "measure", None)
    if not callable(function):
        raise CaseError(f"{case.folder.name}/{MEASURE} defines no function measure(work)")
    return cast("Callable[[Work], Measurement]", function)


def command(case: Case, tier: Tier) -> str:
    """Return the command that measures a case again."""
    return shlex.join(["uqfold", "validate", case.name, f"--{tier}"])


def sources(case: Case) -> list[Path]:
    """Return the files that a case's numbers come from: its own, and data that it declares."""
    data = [case.folder.parent.parent / one for one in case.data]
    return [
        *sorted(case.folder.rglob("*.py")),
        # the declaration apart, which the record repeats
        *(path for path in sorted(case.folder.rglob("*.toml")) if path.name != DECLARATION),
        *(path for folder in (case.folder, *data) for path in sorted(folder.rglob("*.csv"))),
    ]


def changed_since(record: CaseRecord, case: Case) -> tuple[str, ...]:
    """Return what a record's numbers depend on that has changed since they were measured."""
    code = source_digest(*sources(case), without=FRAME)
    changed = changed_parts(record.made["source"], code)
    if record.case.seeds != case.declared.seeds:
        changed = (*changed, "seeds")
    if record.made["settings"] != dict(case.settings):
        changed = (*changed, "settings")
    return changed


def _attempt(case: Case, work: Work) -> tuple[Measurement, str]:
    """Measure; an error is part of the record, an interruption is not."""
    missing = [name for name in case.needs if work.tier == "full" and find_spec(name) is None]
    if missing:
        return Measurement(()), (
            f"the full tier needs {', '.join(missing)}: pip install 'uqfold[validation]'"
        )
    try:
        measurement = measuring(case)(work)
    except Exception as error:
        return Measurement(()), f"{type(error).__name__}: {error}"
    return measurement, ""
