"""What has changed since the record that is kept beside a case.

Verdicts are compared, and for every judged finding how much of its margin is left; never bytes.
Only what was measured for a record counts: a full record that is quoted in a shorter tier may have
become stale since, which changes no verdict.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from uqfold.validation.findings import Finding, number
from uqfold.validation.measurement import claim_verdicts
from uqfold.validation.record import CaseRecord

MARGIN = 0.5
"""Share of its former margin that a finding may lose before that is said."""


@dataclass(frozen=True)
class Changes:
    """What differs from the kept record of a case; empty where the records tell the same.

    Attributes
    ----------
    verdicts
        Verdicts, of the case, its claims or its findings, that are not the kept ones.
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


def changes(kept: CaseRecord | None, now: CaseRecord) -> Changes:
    """Compare a record with the kept one of the same case.

    Parameters
    ----------
    kept
        From `uqfold.validation.check.kept_record`. Without one, the case is expected to hold; with
        one of another tier, only verdicts of the whole case are compared, and what this tier
        cannot judge has not changed.
    now
        What was measured.
    """
    if now.error:
        return Changes(broken=(f"could not be measured: {now.error}",))
    broken = tuple(
        f"the planted fault {one.fault.name!r} went unnoticed" for one in now.missed_faults
    )
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
        verdicts += _verdict_differences(kept, now)
        for decides, text in _differences(kept, now):
            (verdicts if decides else others).append(text)
    return Changes(tuple(verdicts), tuple(others), broken)


def _verdict_differences(kept: CaseRecord, now: CaseRecord) -> Iterator[str]:
    """What differs between verdicts of the case and of its claims."""
    was, is_ = ({"the verdict": one.measurement.verdict} | {
        f"the verdict on {key!r}": verdict
        for key, verdict in claim_verdicts(one.measurement.claims, one.findings).items()
    } for one in (kept, now))  # fmt: skip
    for what in was.keys() & is_.keys():
        if was[what] != is_[what]:
            yield f"{what} was {was[what]!r} and is {is_[what]!r}"


def _differences(kept: CaseRecord, now: CaseRecord) -> Iterator[tuple[bool, str]]:
    """What differs between findings, each with whether it is a verdict."""
    old = {finding.name: finding for finding in kept.findings}
    new = {finding.name: finding for finding in now.findings}
    yield from ((False, f"{name}: no longer measured") for name in old if name not in new)
    yield from ((False, f"{name}: not measured before") for name in new if name not in old)
    for name in (name for name in old if name in new):
        yield from _finding_differences(old[name], new[name], speed=now.case.kind == "benchmark")


def _finding_differences(old: Finding, new: Finding, *, speed: bool) -> Iterator[tuple[bool, str]]:
    if (old.limit, old.at_least) != (new.limit, new.at_least):
        yield False, f"{old.name}: the limit has changed; was: {old.words}; is: {new.words}"
    if old.verdict != new.verdict:
        was = old.verdict or "only quoted"
        yield True, f"{old.name}: was {was!r}: {old.words}; is: {new.words}"
    elif not speed and old.verdict == "holds" and old.margin and new.margin is not None:
        # a limit that was just kept (a loss of exactly zero) has no margin to lose
        lost = 1.0 - new.margin / old.margin
        if lost > MARGIN:
            yield (
                False,
                f"{old.name}: lost {number(100.0 * lost)} % of its margin; was: {old.words}; "
                f"is: {new.words}",
            )
