"""How methods are judged, and what the first screen says of them."""

import math
from typing import Any

import pandas as pd
import pytest

from tests.comparison.fakes import METHODS, Told, toy_frame
from tests.report.page.reading import cards as cards_in
from uqfold.methods import ReliabilityMethod
from uqfold.problems.criterion import criteria
from uqfold.report import Page
from uqfold.report.scores import method_scores, spreads
from uqfold.report.summary import add_summary


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    return toy_frame()


def cards_of(frame: pd.DataFrame) -> dict[str, Any]:
    page = Page("some")
    add_summary(page, frame)
    return cards_in(page)


def cards(methods: dict[str, ReliabilityMethod], *, referenced: bool = True) -> dict[str, Any]:
    return cards_of(toy_frame(criteria([12.0, 13.0]), methods, referenced=referenced))


def test_counts_errors_and_costs(frame: pd.DataFrame) -> None:
    found = method_scores(frame)
    assert list(found.index) == list(dict.fromkeys(frame["label"]))
    exact, biased, broken = (found.loc[one] for one in ("exact", "biased", "broken"))
    assert (exact["right"], exact["referenced"]) == (12, 12)
    assert (biased["right"], biased["answered"], biased["asked"]) == (0, 6, 12)
    assert biased["median_error"] == pytest.approx(0.2)
    assert (broken["answered"], broken["failed"], broken["n_evals"]) == (0, 12, 0)
    assert math.isnan(broken["median_error"])
    assert list(found["stated"][["exact", "sampled"]]) == [0, 12]


@pytest.mark.parametrize(("bias", "right"), [(0.0999, 1), (0.1001, 0), (-0.0999, 1), (-0.11, 0)])
def test_right_is_within_ten_percent(bias: float, right: int) -> None:
    found = method_scores(toy_frame(criteria(12.0), {"one": Told(bias=bias)}))
    assert found["right"]["one"] == right


def test_a_reference_that_cannot_tell_condemns_nobody() -> None:
    frame = toy_frame(criteria(12.0), {"one": Told(bias=0.3)})
    vague = frame.assign(reference_std_error=0.2 * frame["reference_pf"])
    assert method_scores(vague)["right"]["one"] == 1


def test_a_reference_of_unknown_error_still_judges() -> None:
    frame = toy_frame(criteria(12.0), {"one": Told(bias=0.05), "other": Told(bias=0.2)})
    found = method_scores(frame.assign(reference_std_error=math.nan))
    assert list(found["right"]) == [1, 0]


def test_an_interval_covers_within_what_the_reference_knows() -> None:
    frame = toy_frame(criteria(12.0), {"sampled": METHODS["sampled"]})
    pf, error = frame["reference_pf"], frame["reference_std_error"]
    for errors, cover in ((1.9, 1), (2.1, 0)):
        near = frame.assign(ci_low=pf + errors * error, ci_high=1.0)
        assert method_scores(near)["cover"]["sampled"] == cover


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
    apart = toy_frame(criteria(12.0), {"one": Told(), "other": Told(bias=0.25)})
    assert list(spreads(apart)) == [pytest.approx(0.25)]


def test_without_any_answer_nothing_is_praised() -> None:
    found = cards({"broken": METHODS["broken"]})
    assert found["At what cost?"]["answer"] == "No answer at any cost"
    assert {card["tone"] for card in found.values()} == {"bad"}


def test_answers_without_an_error_are_counted_and_not_called_converged() -> None:
    likely = criteria([10.0, 11.0])
    both = toy_frame(likely, {"one": Told(), "sampled": METHODS["sampled"]})
    card = cards_of(both)["What failed?"]
    assert card["answer"] == "Nothing"
    assert card["more"][-1] == "2 of 4 answers are unchecked."
    assert card["tone"] == ""
    sampled = toy_frame(likely, {"sampled": METHODS["sampled"]})
    assert cards_of(sampled)["What failed?"]["tone"] == "good"


def test_what_is_not_supported_is_no_failure() -> None:
    card = cards_of(toy_frame(methods={"biased": METHODS["biased"]}))["What failed?"]
    assert card["answer"] == "Nothing"
    assert card["more"][0].startswith("6 of 12 answers are outside what a method can do;")
