"""Cases that said more than they could: what they may not claim, and what must be able to fail."""

from pathlib import Path

import pandas as pd

from uqfold.validation.findings import VERDICT_RULE
from validation.coverage import measure as coverage
from validation.methods.answers import against

FOLDER = Path(__file__).resolve().parents[2] / "validation"


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


def test_the_rule_of_verdicts_is_written_where_it_is_read() -> None:
    root = FOLDER.parent
    words = " ".join((root / "docs" / "validation.md").read_text("utf-8").replace("> ", "").split())
    assert VERDICT_RULE in words
    report = (FOLDER / "report.md").read_text("utf-8")
    assert VERDICT_RULE in report
