"""Measuring cases: one record per case, whatever happens inside it."""

from __future__ import annotations

import shlex
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from uqfold.provenance import changed_parts, made_by, source_digest
from uqfold.validation.case import Case, CaseError, Tier
from uqfold.validation.measurement import Measurement, claim_verdicts
from uqfold.validation.record import (
    CaseRecord,
    PlantedFault,
    RecordError,
    StoredResult,
    read_case_record,
    write_case_record,
)
from uqfold.validation.work import Work

PARTS = ".parts"
FRAME = ("uqfold.validation",)
"""What measures and keeps records makes no numbers."""

CaseProgress = Callable[[str, int, int | None], None]
"""Called with a case's name, its finished parts (0: it starts), and how many there are."""


def unseen(_name: str, _done: int, _total: int | None) -> None:
    """Tell nobody of the progress."""


@dataclass(frozen=True)
class Validation:
    """How cases are to be measured.

    Attributes
    ----------
    tier
        How thoroughly.
    folder
        Where records go, and where parts are kept that an interrupted run has finished.
    faults
        Whether the cases' faults are planted too, one by one, in the size of the quick tier.
    progress
        Told what is going on; whatever it raises ends the run.
    """

    tier: Tier
    folder: Path
    faults: bool = False
    progress: CaseProgress = unseen

    def run(self, case: Case) -> CaseRecord:
        """Measure one case and write its record.

        A full record that lies in the folder already, of the same code and without an error, is
        not measured again: this is how an interrupted full run goes on.
        """
        path = self.folder / f"{case.name}.json"
        record = self._finished(case, path) or self._measured(case)
        write_case_record(record, path)
        shutil.rmtree(self._kept(case), ignore_errors=True)
        return record

    def _kept(self, case: Case) -> Path:
        return self.folder / PARTS / f"{case.name}-{self.tier}"

    def _finished(self, case: Case, path: Path) -> CaseRecord | None:
        record = existing_record(path) if self.tier == "full" else None
        if record is None or record.tier != "full" or record.error or record.case != case.declared:
            return None
        untried = self.faults and any(one.verdict is None for one in record.faults)
        return None if untried or changed_since(record, case) else record

    def _measured(self, case: Case) -> CaseRecord:
        def tell(done: int, total: int | None) -> None:
            self.progress(case.name, done, total)

        tell(0, None)
        made = made_by(
            *sources(case),
            settings=case.settings,
            command=command(case, self.tier),
            packages=case.needs if self.tier == "full" else (),
            without=FRAME,
        )
        # what was kept belongs to this code only
        kept = self._kept(case) / "-".join(made["source"].values())[:64]
        work = Work(self.tier, None, case.declared.seeds, case.settings, kept, tell)
        start = time.perf_counter()
        measurement, error = _attempt(case, work)
        seconds = time.perf_counter() - start + sum(work.saved)
        return CaseRecord(
            case.declared,
            self.tier,
            measurement,
            made,
            round(seconds, 2),
            tuple(self._planted(case)),
            None if self.tier == "full" else _stored_result(case),
            error,
        )

    def _planted(self, case: Case) -> Iterator[PlantedFault]:
        for fault in case.faults:
            verdict = None
            if self.faults:
                work = Work("quick", fault.name, case.declared.seeds, case.settings)
                found, error = _attempt(case, work)
                verdict = found.verdict
                if not error:
                    verdict = fault.given(verdict, claim_verdicts(found.claims, found.findings))
                self.progress(case.name, 0, None)
            yield PlantedFault(fault, verdict)


def plant(case: Case, name: str) -> Measurement:
    """Measure a case with one of its faults, in the size of the quick tier; errors come through.

    Raises
    ------
    CaseError
        If the case declares no such fault.
    """
    if name not in {one.name for one in case.faults}:
        raise CaseError(f"{case.name} declares no fault {name!r}")
    return case.measuring()(Work("quick", name, case.declared.seeds, case.settings))


def command(case: Case, tier: Tier) -> str:
    """Return the command that measures a case again."""
    option = [] if tier == "default" else [f"--{tier}"]
    return shlex.join(["uqfold", "validate", case.name, *option])


def sources(case: Case) -> list[Path]:
    """Return the files that a case's numbers come from: its own, and data that it declares."""
    data = [case.folder.parent.parent / one for one in case.data]
    return [
        *sorted(case.folder.rglob("*.py")),
        *(path for folder in (case.folder, *data) for path in sorted(folder.rglob("*.csv"))),
    ]


def code_of(case: Case) -> dict[str, str]:
    """Return part -> digest of the code and data that a case depends on."""
    return source_digest(*sources(case), without=FRAME)


def changed_since(record: CaseRecord, case: Case) -> tuple[str, ...]:
    """Return what a record's numbers depend on that has changed since they were measured."""
    changed = changed_parts(record.made["source"], code_of(case))
    if record.case.seeds != case.declared.seeds:
        changed = (*changed, "seeds")
    if record.made["settings"] != dict(case.settings):
        changed = (*changed, "settings")
    return changed


def existing_record(path: Path) -> CaseRecord | None:
    """Read a record where there is a readable one."""
    try:
        return read_case_record(path)
    except (OSError, RecordError):
        return None


def _stored_result(case: Case) -> StoredResult | None:
    """Return what the full tier found earlier, as it is stored beside the case."""
    record = existing_record(case.kept("full"))
    if record is None or record.error:
        return None
    return StoredResult(
        record.date,
        changed_since(record, case),
        record.findings,
        record.seconds,
        record.made["machine"],
    )


def _attempt(case: Case, work: Work) -> tuple[Measurement, str]:
    """Measure; an error is part of the record, an interruption is not."""
    missing = [name for name in case.needs if work.tier == "full" and find_spec(name) is None]
    if missing:
        return Measurement(()), (
            f"the full tier needs {', '.join(missing)}: pip install 'uqfold[validation]'"
        )
    try:
        measurement = case.measuring()(work)
    except Exception as error:
        return Measurement(()), f"{type(error).__name__}: {error}"
    return measurement, ""
