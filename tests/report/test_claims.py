"""The page of the claims: verdicts first, then the numbers; signs of Markdown stay text."""

from uqfold.comparison.claims.claim import JudgedClaim, PaperClaim
from uqfold.comparison.findings import Finding
from uqfold.report.claims import claims_page

CLAIM = PaperClaim("gain, C_r", "More is better.", "Section 1", "never less", {}, lambda _: [])


def test_page_gives_verdicts_and_numbers() -> None:
    page = claims_page(
        [
            JudgedClaim(CLAIM, (Finding("largest fall of k_d", 0.5, 0.25, "s"),)),
            JudgedClaim(CLAIM, (Finding("rise", 0.1, 0.25),)),
            JudgedClaim(CLAIM, (Finding("said only in a figure"),)),
        ]
    )
    assert "Of 3 claims: 1 hold, 1 do not hold, 1 cannot be judged." in page
    assert "| [More is better.](#gain-c_r) | Section 1 | **does not hold** |" in page
    assert "- largest fall of k\\_d: 0.5 s (at most 0.25 s) - does not hold" in page
    assert page.count("Rule: never less.") == 3
