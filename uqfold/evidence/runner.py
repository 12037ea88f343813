"""Measuring cases: one record per case, whatever happens inside it."""

from __future__ import annotations

import datetime
import os
import platform
import shlex
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from uqfold.comparison.header import installed_versions
from uqfold.evidence.case import Case, CaseError
from uqfold.evidence.code_digest import changed_parts, code_digests
from uqfold.evidence.measurement import Measurement
from uqfold.evidence.record import CaseRecord, PlantedFault, StoredResult, Tier
from uqfold.evidence.record_file import RecordError, read_case_record, write_case_record
from uqfold.evidence.work import Work

PARTS = ".parts"

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
        code = code_digests(case.folder, case.data)
        record = self._finished(case, code)
        if record is None:
            record = self._measured(case, code)
        self.folder.mkdir(parents=True, exist_ok=True)
        write_case_record(record, self.folder)
        shutil.rmtree(self._kept(case), ignore_errors=True)
        return record

    def _kept(self, case: Case) -> Path:
        return self.folder / PARTS / f"{case.name}-{self.tier}"

    def _finished(self, case: Case, code: dict[str, str]) -> CaseRecord | None:
        if self.tier != "full":
            return None
        record = existing_record(self.folder / f"{case.name}.json")
        if record is None or record.tier != "full" or record.error or record.code != code:
            return None
        untried = self.faults and any(fault.verdict is None for fault in record.faults)
        return None if untried or not _declares(record, case) else record

    def _measured(self, case: Case, code: dict[str, str]) -> CaseRecord:
        def tell(done: int, total: int | None) -> None:
            self.progress(case.name, done, total)

        tell(0, None)
        date = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        start = time.perf_counter()
        # what was kept belongs to this code only
        digest = "-".join(code.values())[:64]
        work = Work(self.tier, None, case.seeds, self._kept(case) / digest, tell)
        measurement, error = _attempt(case, work)
        seconds = time.perf_counter() - start + sum(work.saved)
        return CaseRecord(
            **declared(case),
            command=command(case, self.tier),
            tier=self.tier,
            measurement=measurement,
            date=date,
            seconds=round(seconds, 2),
            machine=machine(),
            versions=installed_versions(case.needs if self.tier == "full" else ()),
            code=code,
            faults=tuple(self._planted(case)),
            stored=None if self.tier == "full" else stored_result(case, code),
            error=error,
        )

    def _planted(self, case: Case) -> Iterator[PlantedFault]:
        for fault in case.faults:
            verdict = None
            if self.faults:
                measurement, _ = _attempt(case, Work("quick", fault.name, case.seeds))
                verdict = measurement.verdict
                self.progress(case.name, 0, None)
            yield PlantedFault(fault.name, fault.what, verdict, fault.turns_to)


def plant(case: Case, fault: str) -> Measurement:
    """Measure a case with one of its faults, in the size of the quick tier; errors come through.

    Raises
    ------
    CaseError
        If the case declares no such fault.
    """
    if fault not in {one.name for one in case.faults}:
        raise CaseError(f"{case.name} declares no fault {fault!r}")
    return case.measuring()(Work("quick", fault, case.seeds))


def declared(case: Case) -> dict[str, Any]:
    """Give the fields of a record that the case itself declares."""
    return {
        name: getattr(case, name)
        for name in (
            "name", "topic", "title", "claim", "kind", "compared_with", "uncertainty", "source",
            "seeds", "tolerance", "verdict_rule",
        )
    }  # fmt: skip


def command(case: Case, tier: Tier) -> str:
    """Give the command that measures a case again."""
    option = [] if tier == "default" else [f"--{tier}"]
    return shlex.join(["uqfold", "validate", case.name, *option])


def existing_record(path: Path) -> CaseRecord | None:
    """Read a record where there is a readable one."""
    try:
        return read_case_record(path)
    except (OSError, RecordError):
        return None


def stored_result(case: Case, code: dict[str, str]) -> StoredResult | None:
    """Give what the full tier found earlier, as it is stored beside the case."""
    record = existing_record(case.folder / "full.json")
    if record is None or record.error:
        return None
    changed = changed_parts(record.code, code)
    return StoredResult(
        record.date, not changed, changed, record.findings, record.seconds, record.machine
    )


def machine() -> str:
    """Say on what kind of machine this runs, without naming it."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2] for line in file if line.startswith("model name")]
        model = " ".join(names[0].split()) if names else model
    except OSError:
        pass
    return f"{model}, {os.cpu_count()} cores, {platform.system()}"


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


def _declares(record: CaseRecord, case: Case) -> bool:
    return all(getattr(record, name) == value for name, value in declared(case).items())
