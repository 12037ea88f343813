"""The record of one case: what was claimed, how it was measured, and what came out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from uqfold.checks import choice, flag, instance, keep, mapping, or_none, real, several, text, whole
from uqfold.comparison.findings import Finding, Verdict, verdict_of
from uqfold.evidence.measurement import Measurement
from uqfold.methods.seeding import LARGEST_SEED

Kind: TypeAlias = Literal[
    "paper claim", "outside reference", "exact solution", "cross-code", "benchmark", "coverage"
]
Tier: TypeAlias = Literal["quick", "default", "full"]
TIERS: tuple[Tier, ...] = ("quick", "default", "full")


@dataclass(frozen=True)
class PlantedFault:
    """A fault planted on purpose, and whether the case noticed it.

    Attributes
    ----------
    name, what
        Its name, and what is made wrong.
    verdict
        Verdict of the case with the fault; None: not planted in this run.
    turns_to
        Verdict that it has to give. A claim that does not hold is shown to be able to by
        planting a remedy, which turns to ``holds``.
    """

    name: str
    what: str
    verdict: Verdict | None = None
    turns_to: Verdict = "does not hold"

    def __post_init__(self) -> None:
        keep(self, "name", text)
        keep(self, "what", text, empty=True)
        keep(self, "verdict", or_none, choice, get_args(Verdict))
        keep(self, "turns_to", choice, get_args(Verdict))

    @property
    def caught(self) -> bool | None:
        """Whether it turned the verdict as it has to; None where it was not planted."""
        return None if self.verdict is None else self.verdict == self.turns_to


@dataclass(frozen=True)
class StoredResult:
    """What the full tier found earlier, as a shorter one quotes it.

    Attributes
    ----------
    date
        When it was measured, UTC, ISO 8601.
    current
        Whether the code that the case depends on is still the same.
    changed
        Parts of that code that are not.
    findings
        What it found.
    seconds
        How long it took (s).
    machine
        Where.
    """

    date: str
    current: bool
    changed: tuple[str, ...]
    findings: tuple[Finding, ...]
    seconds: float
    machine: str

    def __post_init__(self) -> None:
        keep(self, "date", text, empty=True)
        keep(self, "current", flag)
        keep(self, "changed", several, text)
        keep(self, "findings", several, instance, Finding, "give a Finding")
        keep(self, "seconds", real, at_least=0.0)
        keep(self, "machine", text, empty=True)

    @property
    def verdict(self) -> Verdict:
        """The verdict that these findings give."""
        return verdict_of(self.findings)


@dataclass(frozen=True)
class CaseRecord:
    """One case as it is kept.

    Attributes
    ----------
    name, topic, title
        Name of the case (its folder), the group it belongs to, and a short title.
    claim
        What is claimed, in one sentence.
    kind
        What sort of evidence it is.
    compared_with, uncertainty, source
        What the numbers are compared with, how uncertain that is itself, and where it comes from.
    command
        The command that measures it again.
    seeds
        Seeds of whatever is random.
    tolerance
        The tolerance and why it is that one.
    verdict_rule
        How the findings give the verdict.
    tier
        The tier in which it was measured.
    measurement
        Findings, tables and figures.
    date, seconds, machine
        When (UTC, ISO 8601), for how long (s) and on what it was measured.
    versions
        Name -> version of uqfold, Python and packages.
    code
        Part of the source code that the case depends on -> its digest.
    faults
        Planted faults.
    stored
        What the full tier found earlier; None if nothing is stored, or this is the full tier.
    error
        Why there is no evidence: the error that ended the measurement; empty otherwise.
    """

    name: str
    topic: str
    title: str
    claim: str
    kind: Kind
    compared_with: str
    uncertainty: str
    source: str
    command: str
    seeds: tuple[int, ...]
    tolerance: str
    verdict_rule: str
    tier: Tier
    measurement: Measurement
    date: str
    seconds: float
    machine: str
    versions: Mapping[str, str]
    code: Mapping[str, str]
    faults: tuple[PlantedFault, ...] = ()
    stored: StoredResult | None = None
    error: str = ""

    def __post_init__(self) -> None:
        keep(self, "name", text)
        for name in (
            "topic", "title", "claim", "compared_with", "uncertainty", "source", "command",
            "tolerance", "verdict_rule", "date", "machine", "error",
        ):  # fmt: skip
            keep(self, name, text, empty=True)
        keep(self, "kind", choice, get_args(Kind))
        keep(self, "seeds", several, whole, at_least=0, at_most=LARGEST_SEED)
        keep(self, "tier", choice, TIERS)
        keep(self, "measurement", instance, Measurement, "give a Measurement")
        keep(self, "seconds", real, at_least=0.0)
        keep(self, "versions", mapping, text, empty=True)
        keep(self, "code", mapping, text, empty=True)
        keep(self, "faults", several, instance, PlantedFault, "give a PlantedFault")
        keep(self, "stored", or_none, instance, StoredResult, "give a StoredResult")

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The findings measured in this tier."""
        return self.measurement.findings

    @property
    def judged(self) -> tuple[Finding, ...]:
        """The findings that the verdict rests on.

        Those of the full tier count beside those measured now while the code is the same, and
        replace those that a shorter tier measures too coarsely to judge.
        """
        stored = self.stored.findings if self.stored is not None and self.stored.current else ()
        settled = {one.what for one in stored if one.verdict in ("holds", "does not hold")}
        own = (
            one
            for one in self.findings
            if one.verdict != "cannot be judged" or one.what not in settled
        )
        return (*own, *stored)

    @property
    def verdict(self) -> Verdict:
        """The verdict on the claim; a measurement that ended in an error judges nothing."""
        return "cannot be judged" if self.error else verdict_of(self.judged)

    @property
    def missed_faults(self) -> tuple[PlantedFault, ...]:
        """Planted faults that did not turn the verdict."""
        return tuple(fault for fault in self.faults if fault.caught is False)
