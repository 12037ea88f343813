"""What the cases on methods compare: answers with their references."""

import math

import pandas as pd
import pytest

from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import Reference
from uqfold.validation import verdict_of
from validation.known_answers.measure import against, bands, beyond, firm, intervals, planted, rms


def test_answers_are_compared_in_joint_standard_errors() -> None:
    known = [Reference(Criterion(T), 0.2, 0.03) for T in (1.0, 2.0, 3.0)]
    found = pd.DataFrame(
        {
            "pf": [0.25, 0.19, math.nan],
            "std_error": [0.04, 0.0, math.nan],
            "status": ["converged", "doubtful", "failed"],
        }
    )
    rows = against(found, known)
    assert rows["z"].tolist() == pytest.approx([1.0, math.nan, math.nan], nan_ok=True)
    assert rows["error"].tolist() == pytest.approx([0.25, -0.05, math.nan], nan_ok=True)
    assert rows["criterion"].tolist() == ["T = 1, m = 1", "T = 2, m = 1", "T = 3, m = 1"]
    assert firm(rows).index.tolist() == [0]
    assert rms(rows["error"][:2]) == pytest.approx(math.hypot(0.25, 0.05) / math.sqrt(2.0))


def repeated(error: float, status: str = "converged") -> pd.DataFrame:
    """Return 40 answers to one criterion, one stated error of 1 % too high and too low by turns."""
    pf = 0.2 * (1.0 + error * pd.Series([1.0, -1.0] * 20))
    found = pd.DataFrame(
        {"pf": pf, "std_error": 0.002, "ci_low": pf - 0.004, "ci_high": pf + 0.004,
         "status": status, "error_kind": "surrogate"}
    )  # fmt: skip
    return against(found, [Reference(Criterion(1.0), 0.2, 0.0)] * 40)


@pytest.mark.parametrize("fault", ["overconfident", "biased"])
def test_intervals_hold_of_honest_answers_and_not_of_spoilt_ones(fault: str) -> None:
    rule = {"coverage": 0.9, "stated_errors": 1.25}
    honest = repeated(0.01)
    assert [one.verdict for one in intervals("a", honest, rule)] == ["holds", "holds"]
    spoilt = planted(honest, fault)
    assert "does not hold" in [one.verdict for one in intervals("a", spoilt, rule)]


def test_an_error_is_judged_beyond_the_stated_ones_of_answers_without_doubt() -> None:
    rule = {"standard_errors": 4.0, "surrogate": 0.01}
    for error, verdict in ((0.049, "holds"), (0.051, "does not hold")):
        assert verdict_of(beyond("a", repeated(error), rule)) == verdict
    # a kind of error that has no limit of its own
    assert verdict_of(beyond("a", repeated(0.041), {"standard_errors": 4.0})) == "does not hold"
    answered, *others = beyond("a", repeated(0.9, "doubtful"), rule)
    assert (answered.value, answered.verdict, others) == (0.0, "does not hold", [])


def test_a_band_of_pf_is_judged_at_its_worst_criterion() -> None:
    rule = {"limits": [[0.1, 0.02], [0.001, 0.05]], "stated_errors": 1.5}
    verdicts = [one.verdict for one in bands("a", repeated(0.01), rule)]
    assert verdicts == ["holds", "holds"]
    largest, stated = bands("a", repeated(0.03), rule)
    assert largest.value == pytest.approx(3.0)
    assert {largest.verdict, stated.verdict} == {"does not hold"}
