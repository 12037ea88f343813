"""What the cases on methods compare: answers with their references."""

import math

import pandas as pd
import pytest

from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import Reference
from validation.known_answers.measure import against, firm, rms


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
    assert firm(rows[:2]).index.tolist() == [0]
    assert rms(rows["error"][:2]) == pytest.approx(math.hypot(0.25, 0.05) / math.sqrt(2.0))
