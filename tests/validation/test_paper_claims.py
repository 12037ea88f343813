"""The cases on the paper's claims: none is forgotten, contradictions are seen by the right one."""

from collections import Counter
from importlib import import_module
from pathlib import Path

import pandas as pd
import pytest

from uqfold.cli.study_claims import read_studies
from uqfold.comparison.claims import CLAIMS, judged
from validation.paper.claims import FAULTS, STUDIES, read_results

FOLDER = Path(__file__).resolve().parents[2] / "validation"


def test_every_claim_belongs_to_one_case() -> None:
    names = [path.parent.name for path in FOLDER.glob("paper_*/measure.py")]
    listed = Counter(
        key for name in names for key in import_module(f"validation.{name}.measure").CLAIMS
    )
    # numbers of runs are counted anew by a case of their own
    assert listed == Counter(set(CLAIMS) - {"sample sizes"})


def test_results_are_those_that_the_studies_read() -> None:
    own, studies = read_results(), read_studies(STUDIES)
    for claim in CLAIMS.values():
        ours, theirs = judged(claim, own).findings, judged(claim, studies).findings
        assert [one.words for one in ours] == [one.words for one in theirs]


def test_contradictions_and_remedies_change_what_they_say() -> None:
    table = pd.DataFrame(
        {
            "problem": ["condition-15", "condition-16"] * 2,
            "missions": ["1"] * 4,
            "threshold": [0.5, 0.5, 0.6, 0.6],
            "tau": [0.03, 0.03, 0.04, 0.04],
            "pf": [0.9, 0.9, 0.1, 0.2],
            "reference_pf": [0.8, float("nan"), 0.1, 0.2],
            "error": [0.125, float("nan"), 0.0, 0.0],
        }
    )
    before = table.copy()
    after = {name: change(table) for name, change in FAULTS.items()}
    pd.testing.assert_frame_equal(table, before)
    assert after["upside down"]["pf"].tolist() == [1 - pf for pf in (0.9, 0.9, 0.1, 0.2)]
    assert after["conditions swapped"]["problem"].tolist() == ["condition-16", "condition-15"] * 2
    assert after["tau swapped"]["tau"].tolist() == [0.04, 0.04, 0.03, 0.03]
    assert after["off"]["pf"].tolist() == pytest.approx([0.9, 0.9, 0.13, 0.23])
    assert after["troughs"]["pf"].tolist() == pytest.approx([0.9, 0.898, 0.1, 0.098])
    assert after["much later"]["threshold"].tolist() == pytest.approx([0.7, 0.7, 0.8, 0.8])
    assert after["later"]["threshold"].tolist() == pytest.approx([0.585, 0.585, 0.685, 0.685])
