"""A claim of the paper, and how the results of the studies judge it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from uqfold.comparison.findings import Finding, Verdict, verdict_of

if TYPE_CHECKING:
    import pandas as pd

StudyResults: TypeAlias = "Mapping[str, Mapping[str, pd.DataFrame]]"
"""Study -> table -> rows."""

IDENTITY = "an identity: every model keeps it, so it is no evidence"
"""Remark of a finding that follows from the algebra alone; a breach shows an error of ours."""


@dataclass(frozen=True)
class PaperClaim:
    """One claim of the paper.

    Attributes
    ----------
    key
        Short name.
    statement
        What is claimed, in our words.
    source
        Where: section and figure.
    rule
        What has to be true of the numbers.
    needs
        Study -> tables that the judgement reads.
    judge
        Turns results into findings.
    """

    key: str
    statement: str
    source: str
    rule: str
    needs: Mapping[str, tuple[str, ...]]
    judge: Callable[[StudyResults], list[Finding]]


@dataclass(frozen=True)
class JudgedClaim:
    """A claim with what was found."""

    claim: PaperClaim
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """Verdict that follows from the findings."""
        return verdict_of(self.findings)

    @property
    def identity(self) -> bool:
        """Whether the claim holds by identities alone."""
        judged = [one for one in self.findings if one.verdict is not None]
        return self.verdict == "holds" and all(one.remark.startswith(IDENTITY) for one in judged)

    @property
    def verdict_words(self) -> str:
        """The verdict, and whether it is an identity."""
        return f"{self.verdict} (an identity)" if self.identity else self.verdict


def judged(claim: PaperClaim, results: StudyResults) -> JudgedClaim:
    """Judge a claim; where results are missing it cannot be judged."""
    missing = [
        f"{study}/{table}"
        for study, tables in claim.needs.items()
        for table in tables
        if table not in results.get(study, {})
    ]
    if missing:
        return JudgedClaim(claim, (Finding(f"no results of {', '.join(missing)}"),))
    return JudgedClaim(claim, tuple(claim.judge(results)))
