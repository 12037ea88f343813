import math
from pathlib import Path

import pytest

from uqfold.validation.findings import VERDICT_RULE, Finding, number, verdict_of

ROOT = Path(__file__).resolve().parents[2]

KEPT, BROKEN = Finding("a", 1.0, 2.0), Finding("a", 3.0, 2.0)
QUOTED, UNKNOWN = Finding("a", 3.0), Finding("a", remark="figures only")


@pytest.mark.parametrize(
    ("finding", "verdict"),
    [
        (KEPT, "holds"),
        (BROKEN, "does not hold"),
        (QUOTED, None),
        (UNKNOWN, "cannot be judged"),
        (Finding("a", 2.0, 2.0), "holds"),
        (Finding("a", 1.0, 2.0, at_least=True), "does not hold"),
        (Finding("a", 2.0, 2.0, at_least=True), "holds"),
        (Finding("a", math.nan, 2.0), "does not hold"),
        (Finding("a", math.nan, 2.0, at_least=True), "does not hold"),
        (Finding("a", math.nan, 2.0, uncertainty=9.0), "does not hold"),
        (Finding("a", math.inf, 2.0), "does not hold"),
        (Finding("a", math.inf, math.inf), "holds"),
        (Finding("a", 1.0, 2.0, uncertainty=0.5), "holds"),
        (Finding("a", 3.0, 2.0, uncertainty=0.5), "does not hold"),
        (Finding("a", 2.2, 2.0, uncertainty=0.5), "cannot be judged"),
        (Finding("a", 1.8, 2.0, uncertainty=0.5), "cannot be judged"),
        (Finding("a", 1.0, 2.0, uncertainty=math.nan), "cannot be judged"),
        (Finding("a", 1.0, 2.0, uncertainty=math.inf), "cannot be judged"),
    ],
)
def test_verdict_of_one_finding(finding: Finding, verdict: str | None) -> None:
    assert finding.verdict == verdict


def test_verdict_of_a_claim() -> None:
    assert verdict_of([KEPT, QUOTED]) == "holds"
    assert verdict_of([KEPT, BROKEN]) == "does not hold"
    assert verdict_of([QUOTED, UNKNOWN]) == "cannot be judged"
    assert verdict_of([]) == "cannot be judged"


def test_one_finding_that_holds_does_not_outweigh_one_that_cannot_be_judged() -> None:
    near = Finding("a", 1.8, 2.0, uncertainty=0.5)
    for unjudged in (near, UNKNOWN):
        assert verdict_of([KEPT, KEPT, unjudged]) == "cannot be judged"
        assert verdict_of([KEPT, unjudged, BROKEN]) == "does not hold"


def test_words() -> None:
    assert Finding("time", 3.0, 2.0, "s").words == "time: 3 s (at most 2 s) - does not hold"
    assert QUOTED.words == "a: 3"
    assert UNKNOWN.words == "a - cannot be judged - figures only"
    near = Finding("bias", 0.02, 0.025, at_least=True, uncertainty=0.01)
    assert near.words == "bias: 0.02 ± 0.01 (at least 0.025) - cannot be judged"


def test_numbers_for_people() -> None:
    assert [number(x) for x in (3.0, 0.012345, 123456.0, -2.0)] == ["3", "0.0123", "1.23e+05", "-2"]


def test_the_rule_of_verdicts_is_written_where_it_is_read() -> None:
    page = (ROOT / "docs" / "validation.md").read_text("utf-8")
    assert VERDICT_RULE in " ".join(page.replace("> ", "").split())
    assert VERDICT_RULE in (ROOT / "validation" / "report.md").read_text("utf-8")
