"""How methods are judged, and what the first screen says of them."""

import math
from collections.abc import Sequence
from typing import Any

import pytest

from tests.comparison.fakes import METHODS, Told, toy_frame
from tests.report.page.reading import cards as cards_in
from uqfold.methods import ReliabilityMethod
from uqfold.plots.wording import Row
from uqfold.problems.criterion import criteria
from uqfold.report import Page
from uqfold.report.scores import MethodScore, method_scores, spreads
from uqfold.report.summary import add_summary


def rows_of(*given: object, **named: object) -> Sequence[Row]:
    return toy_frame(*given, **named).to_dict("records")  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def rows() -> Sequence[Row]:
    return rows_of()


def judged(rows: Sequence[Row]) -> dict[str, MethodScore]:
    return {one.label: one for one in method_scores(rows)}


def cards_of(rows: Sequence[Row]) -> dict[str, Any]:
    page = Page("some")
    add_summary(page, rows)
    return cards_in(page)


def cards(methods: dict[str, ReliabilityMethod], *, referenced: bool = True) -> dict[str, Any]:
    return cards_of(rows_of(criteria([12.0, 13.0]), methods, referenced=referenced))


def test_counts_errors_and_costs(rows: Sequence[Row]) -> None:
    found = judged(rows)
    exact, biased, broken = found["exact"], found["biased"], found["broken"]
    assert (exact.right, exact.referenced, exact.always_right) == (12, 12, True)
    assert (biased.right, biased.answered, biased.asked) == (0, 6, 12)
    assert biased.median_error == pytest.approx(0.2)
    assert not biased.always_right
    assert (broken.answered, broken.statuses["failed"], broken.n_evals) == (0, 12, 0)
    assert math.isnan(broken.median_error)
    assert (exact.intervals, found["sampled"].intervals) == (0, 12)


@pytest.mark.parametrize(("bias", "right"), [(0.0999, 1), (0.1001, 0), (-0.0999, 1), (-0.11, 0)])
def test_right_is_within_ten_percent(bias: float, right: int) -> None:
    found = rows_of(criteria(12.0), {"one": Told(bias=bias)})
    assert judged(found)["one"].right == right


def test_a_reference_that_cannot_tell_condemns_nobody() -> None:
    (row,) = rows_of(criteria(12.0), {"one": Told(bias=0.3)})
    vague = {**row, "reference_std_error": 0.2 * row["reference_pf"]}
    assert judged([vague])["one"].right == 1


def test_an_interval_covers_within_what_the_reference_knows() -> None:
    (row,) = rows_of(criteria(12.0), {"sampled": METHODS["sampled"]})
    pf, error = row["reference_pf"], row["reference_std_error"]
    near = {**row, "ci_low": pf + 1.9 * error, "ci_high": 1.0}
    beyond = {**row, "ci_low": pf + 2.1 * error, "ci_high": 1.0}
    assert judged([near])["sampled"].covering == 1
    assert judged([beyond])["sampled"].covering == 0


def test_the_cheapest_of_the_right_ones_is_named() -> None:
    found = cards({"dear": Told(n=4000), "cheap": Told(n=50), "wrong": Told(n=10, bias=0.5)})
    assert found["Who was right?"]["answer"] == "cheap and dear"
    assert found["Who was right?"]["tone"] == "good"
    assert found["At what cost?"]["answer"] == "50 evaluations"
    assert found["What failed?"]["answer"] == "Nothing"


def test_nobody_right_is_said() -> None:
    found = cards({"wrong": Told(bias=0.5), "broken": METHODS["broken"]})
    assert found["Who was right?"]["answer"] == "Nobody"
    assert found["What failed?"]["answer"] == "2 of 4 failed"
    assert found["What failed?"]["tone"] == "bad"
    assert "Concerns broken." in (found["What failed?"]["more"])


def test_without_a_reference_agreement_is_told_and_not_called_right() -> None:
    found = cards({"one": Told(), "other": Told(bias=0.25)}, referenced=False)
    card = found["Do the methods agree?"]
    assert card["answer"] == "To within 25.0 %"
    assert card["tone"] == "warn"
    assert "nobody knows here who is right" in card["more"][-1]
    assert "right" not in found["At what cost?"]["more"][0]
    apart = rows_of(criteria(12.0), {"one": Told(), "other": Told(bias=0.25)})
    assert spreads(apart) == [pytest.approx(0.25)]


def test_without_any_answer_nothing_is_praised() -> None:
    found = cards({"broken": METHODS["broken"]})
    assert found["At what cost?"]["answer"] == "No answer at any cost"
    assert {card["tone"] for card in found.values()} == {"bad"}


def test_answers_without_an_error_are_counted_and_not_called_converged() -> None:
    card = cards({"one": Told(), "sampled": METHODS["sampled"]})["What failed?"]
    assert card["answer"] == "Nothing"
    assert card["more"][-1] == "2 of 4 answers are unchecked."
    assert card["tone"] == ""
    assert cards({"sampled": METHODS["sampled"]})["What failed?"]["tone"] == "good"


def test_what_is_not_supported_is_no_failure() -> None:
    card = cards_of(rows_of(methods={"biased": METHODS["biased"]}))["What failed?"]
    assert card["answer"] == "Nothing"
    assert card["more"][0] == "6 of 12 answers are outside what a method can do."
