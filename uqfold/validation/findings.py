"""What was measured for a claim, the limit it has to keep, and the verdict that follows.

>>> verdict_of([Finding("largest difference", 3e-7, 2e-6, "s"), Finding("wings", 60)])
'holds'
>>> verdict_of([Finding("largest difference", 3e-7, 2e-6, "s"), Finding("peaks, in figures only")])
'cannot be judged'
>>> Finding("largest difference", 3e-7, 2e-6, "s").words
'largest difference: 3e-07 s (at most 2e-06 s)'
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from pydantic import ConfigDict, computed_field

from uqfold.checks import flag, instance, keep, or_none, real, several, text

Verdict: TypeAlias = Literal["holds", "does not hold", "cannot be judged"]

VERDICT_RULE = (
    "A claim holds if at least one limit was judged and every one is kept; it does not hold if one "
    "is broken; otherwise, as soon as one of them cannot be judged, neither can the claim."
)
"""The rule that `verdict_of` applies."""

AS_WRITTEN = ConfigDict(ser_json_inf_nan="strings")
"""How records write numbers that strict JSON does not know."""


@dataclass(frozen=True)
class Finding:
    """One measured number with the limit that it has to keep; without a limit it is for reading.

    Attributes
    ----------
    what
        What was measured.
    value
        The number; None for what somebody states but nobody here can measure. NaN breaks any
        limit.
    limit
        Upper bound of the value, or a lower one where `at_least` is set.
    unit
        Unit of value, limit and uncertainty.
    at_least
        Whether the limit is a lower bound.
    uncertainty
        How far the value may lie from the truth, either way. A limit within that reach cannot be
        judged; None means that the value is taken as it is.
    remark
        What a reader has to know beside the number.
    claim
        Key of the claim that it belongs to, in a case that judges several.
    """

    __pydantic_config__ = AS_WRITTEN

    what: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    at_least: bool = False
    uncertainty: float | None = None
    remark: str = ""
    claim: str = ""

    def __post_init__(self) -> None:
        keep(self, "what", text)
        keep(self, "value", or_none, real, finite=False, nan=True)
        keep(self, "limit", or_none, real, finite=False, nan=True)
        keep(self, "unit", text, empty=True)
        keep(self, "at_least", flag)
        keep(self, "uncertainty", or_none, real, at_least=0.0, finite=False, nan=True)
        keep(self, "remark", text, empty=True)
        keep(self, "claim", text, empty=True)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def verdict(self) -> Verdict | None:
        """Verdict of this number alone; None where it is only quoted."""
        if self.value is None:
            return "cannot be judged"
        if self.limit is None:
            return None
        # the difference of two infinities is NaN
        beyond = 0.0 if self.value == self.limit else self.value - self.limit
        if math.isnan(beyond):
            return "does not hold"
        if self.uncertainty is not None and not abs(beyond) > self.uncertainty:
            return "cannot be judged"
        kept = beyond >= 0.0 if self.at_least else beyond <= 0.0
        return "holds" if kept else "does not hold"

    @property
    def name(self) -> str:
        """What was measured, after the claim that it belongs to."""
        return f"{self.claim}: {self.what}" if self.claim else self.what

    @property
    def measured(self) -> str:
        """The value with its uncertainty and unit; empty without a value."""
        if self.value is None:
            return ""
        spread = "" if self.uncertainty is None else f" ± {number(self.uncertainty)}"
        return f"{number(self.value)}{spread} {self.unit}".rstrip()

    @property
    def bound(self) -> str:
        """The limit in words; empty without one."""
        if self.limit is None:
            return ""
        side = "at least" if self.at_least else "at most"
        return f"{side} {number(self.limit)} {self.unit}".rstrip()

    @property
    def words(self) -> str:
        """The finding in one line."""
        words = [f"{self.name}: {self.measured}" if self.measured else self.name]
        words += [f"({self.bound})"] if self.bound else []
        words += [f"- {self.verdict}"] if self.verdict not in (None, "holds") else []
        words += [f"- {self.remark}"] if self.remark else []
        return " ".join(words)


def verdict_of(findings: Iterable[Finding]) -> Verdict:
    """Return the verdict on a claim by the one rule for all of them, `VERDICT_RULE`.

    Findings that are only quoted do not count. A claim about most of several things is one finding:
    their share, with a lower limit.
    """
    listed = several("findings", findings, instance, Finding, "give a Finding")
    verdicts = {finding.verdict for finding in listed} - {None}
    if "does not hold" in verdicts:
        return "does not hold"
    return "holds" if verdicts == {"holds"} else "cannot be judged"


def number(value: float) -> str:
    """Return three significant digits, without a decimal tail for whole numbers."""
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e5 else f"{value:.3g}"
