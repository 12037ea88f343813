"""What has changed since the record that is kept beside a case.

Verdicts are compared, and for every judged finding how much of its margin is left; never bytes.
Only what was measured for a record counts: a full record that is quoted in a shorter tier may have
become stale since, which changes no verdict.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from uqfold.comparison.findings import Finding, number
from uqfold.evidence.case import Case
from uqfold.evidence.record import CaseRecord
from uqfold.evidence.runner import existing_record

MARGIN = 0.5
"""Share of its former margin that a finding may lose before that is said."""


@dataclass(frozen=True)
class Changes:
    """What differs from the kept record of a case; empty where the records tell the same.

    Attributes
    ----------
    verdicts
        Verdicts, of the case or of its findings, that are not the kept ones.
    others
        What has changed otherwise: margins that are half gone, limits, findings that come and go.
    broken
        Why nothing can be said: no measurement, or planted faults that went unnoticed.
    """

    verdicts: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()

    @property
    def words(self) -> tuple[str, ...]:
        """All of them, what weighs most first."""
        return (
            *(f"broken: {text}" for text in self.broken),
            *(f"changed: {text}" for text in self.verdicts),
            *(f"moved: {text}" for text in self.others),
        )


def kept_record(case: Case, tier: str) -> CaseRecord | None:
    """Read the record kept beside a case: of this tier, or else the most thorough one."""
    names = [tier] if tier in ("quick", "full") else ["full", "quick"]
    records = (existing_record(case.folder / f"{name}.json") for name in names)
    return next((record for record in records if record is not None), None)


def changes(kept: CaseRecord | None, now: CaseRecord) -> Changes:
    """Compare a record with the kept one of the same case.

    Parameters
    ----------
    kept
        From `kept_record`. Without one, the case is expected to hold; with one of another tier,
        only verdicts of the whole case are compared, and what this tier cannot judge has not
        changed.
    now
        What was measured.
    """
    broken = [f"could not be measured: {now.error}"] if now.error else []
    broken += [f"the planted fault {one.name!r} went unnoticed" for one in now.missed_faults]
    if now.error:
        return Changes(broken=tuple(broken))
    verdicts, others = list[str](), list[str]()
    if kept is None:
        if now.verdict == "does not hold":
            verdicts.append("does not hold, and no record of another verdict is kept")
    elif kept.tier != now.tier:
        if now.verdict not in (kept.verdict, "cannot be judged"):
            verdicts.append(
                f"the verdict was {kept.verdict!r} ({kept.tier} tier) and is {now.verdict!r}"
            )
    else:
        before, after = kept.measurement.verdict, now.measurement.verdict
        if before != after:
            verdicts.append(f"the verdict was {before!r} and is {after!r}")
        for decides, text in _differences(kept, now):
            (verdicts if decides else others).append(text)
    return Changes(tuple(verdicts), tuple(others), tuple(broken))


def _differences(kept: CaseRecord, now: CaseRecord) -> Iterator[tuple[bool, str]]:
    """What differs between findings, each with whether it is a verdict."""
    old = {finding.what: finding for finding in kept.findings}
    new = {finding.what: finding for finding in now.findings}
    yield from ((False, f"{what}: no longer measured") for what in old if what not in new)
    yield from ((False, f"{what}: not measured before") for what in new if what not in old)
    for what in (what for what in old if what in new):
        yield from _finding_differences(old[what], new[what], values=now.kind != "benchmark")


def _finding_differences(old: Finding, new: Finding, *, values: bool) -> Iterator[tuple[bool, str]]:
    if (old.limit, old.at_least) != (new.limit, new.at_least):
        yield False, f"{old.what}: the limit has changed; was: {old.words}; is: {new.words}"
    if old.verdict != new.verdict:
        was = old.verdict or "only quoted"
        yield True, f"{old.what}: was {was!r}: {old.words}; is: {new.words}"
    elif values and old.verdict == "holds" and old.margin and new.margin is not None:
        # a limit that was just kept (a loss of exactly zero) has no margin to lose
        lost = 1.0 - new.margin / old.margin
        if lost > MARGIN:
            yield (
                False,
                (
                    f"{old.what}: lost {number(100.0 * lost)} % of its margin; was: {old.words}; "
                    f"is: {new.words}"
                ),
            )
