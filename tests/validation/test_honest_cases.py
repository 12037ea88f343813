"""Cases that said more than they could: what they may not claim, and what must be able to fail."""

from pathlib import Path

import pandas as pd
import pytest

from uqfold.validation.case import find_cases, load_cases
from uqfold.validation.findings import VERDICT_RULE
from uqfold.validation.record import read_case_record
from validation.coverage import measure as coverage
from validation.methods.answers import against
from validation.paper import lengths

FOLDER = Path(__file__).resolve().parents[2] / "validation"


def test_a_slider_crank_of_unchecked_dimensions_cannot_be_judged() -> None:
    [case] = load_cases(FOLDER / "slider_crank")
    assert "published" not in case.declared.title.lower()
    assert "could not be checked" in case.declared.uncertainty
    for tier in ("quick", "full"):
        record = read_case_record(FOLDER / "slider_crank" / f"{tier}.json")
        assert record.verdict == "cannot be judged"
        unjudged = [one.what for one in record.findings if one.verdict == "cannot be judged"]
        assert "dimensions of the published mechanism" in unjudged


def test_surfaces_are_asked_of_a_curved_response_and_can_miss_it() -> None:
    surfaces = [name for name, method in coverage.methods().items() if coverage.fits(method)]
    assert set(surfaces) >= {"kriging", "pce", "active-kriging"}
    assert set(coverage.repeats("pce", range(1))["question"]) <= set(coverage.CURVED_KNOWN)
    for name in surfaces:
        for question, known in coverage.CURVED_KNOWN.items():
            honest = pd.DataFrame(
                {"pf": known.pf * (1.0 + 0.01 * z), "std_error": 0.01 * known.pf,
                 "ci_low": 0.0, "ci_high": 1.0, "error_kind": "surrogate"}
                for z in (-1, 1) * 20
            )  # fmt: skip
            rows = against(honest, [known] * len(honest))
            found = coverage.judge(coverage.summary(name, question, rows))
            assert [one.verdict for one in found] == ["holds", "holds"]
            sure = coverage.planted(rows, coverage.TOO_SURE)
            found = coverage.judge(coverage.summary(name, question, sure))
            assert found[1].verdict == "does not hold"


def test_what_was_scanned_for_the_range_of_T_is_said() -> None:
    [finding] = [
        one
        for one in read_case_record(FOLDER / "paper" / "quick.json").findings
        if "with clearances" in one.what
    ]
    wings = len(lengths.LAWS) * len(lengths.VELOCITIES)
    assert finding.limit is None
    assert "2,376 wings" in finding.remark
    assert wings * len(lengths.ANGLES) * len(lengths.LOCKS) >= 2_376
    assert finding.value == pytest.approx(0.69, abs=0.005)


def test_the_rule_of_verdicts_is_written_where_it_is_read() -> None:
    root = FOLDER.parent
    words = " ".join((root / "docs" / "validation.md").read_text("utf-8").replace("> ", "").split())
    assert VERDICT_RULE in words
    report = (FOLDER / "report.md").read_text("utf-8")
    assert report.count(VERDICT_RULE) == len(find_cases(FOLDER))
