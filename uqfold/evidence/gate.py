"""The regression gate: have verdicts changed since the records that are kept beside the cases?

Verdicts are compared, and for every judged finding how much of its margin is left; never bytes.
"""

from __future__ import annotations

from collections.abc import Iterator

from uqfold.comparison.findings import Finding, number
from uqfold.evidence.record import CaseRecord

MARGIN = 0.5
"""Share of its former margin that a finding may lose before it counts as changed."""


def differences(kept: CaseRecord, now: CaseRecord) -> list[str]:
    """Say what has changed for the worse or otherwise than a rounding explains.

    Parameters
    ----------
    kept, now
        Records of the same case in the same tier.

    Returns
    -------
    list[str]
        One line per change; empty where the records tell the same.
    """
    return list(_differences(kept, now))


def _differences(kept: CaseRecord, now: CaseRecord) -> Iterator[str]:
    if now.error:
        yield f"could not be measured: {now.error}"
        return
    before, after = kept.measurement.verdict, now.measurement.verdict
    if before != after:
        yield f"the verdict was {before!r} and is {after!r}"
    old = {finding.what: finding for finding in kept.findings}
    new = {finding.what: finding for finding in now.findings}
    yield from (f"{what}: no longer measured" for what in old if what not in new)
    yield from (f"{what}: not measured before" for what in new if what not in old)
    for what in (what for what in old if what in new):
        yield from _finding_differences(old[what], new[what], values=now.kind != "benchmark")


def _finding_differences(old: Finding, new: Finding, *, values: bool) -> Iterator[str]:
    if old.verdict != new.verdict:
        yield f"{old.what}: was {old.verdict or 'only quoted'!r}: {old.words}; is: {new.words}"
    elif (old.limit, old.at_least) != (new.limit, new.at_least):
        yield f"{old.what}: the limit has changed; was: {old.words}; is: {new.words}"
    elif values and old.verdict == "holds" and old.margin and new.margin is not None:
        # a limit that was just kept (a loss of exactly zero) has no margin to lose
        lost = 1.0 - new.margin / old.margin
        if lost > MARGIN:
            yield (
                f"{old.what}: lost {number(100.0 * lost)} % of its margin; was: {old.words}; "
                f"is: {new.words}"
            )
