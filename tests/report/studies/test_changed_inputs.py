"""The table kind `changed-inputs`: what differs from the other problems, and nothing else."""

import pandas as pd
import pytest

from uqfold.comparison.studies.builtin import input_rows
from uqfold.problems import folding_wing
from uqfold.report.studies.changed_inputs import changed_inputs
from uqfold.report.studies.selection import SelectionError

PROBLEMS = {
    "plain": folding_wing(),
    "slow": folding_wing(means={"V_q": 100.0}),
    "loose": folding_wing(means={"C_r": 2.0}, standard_deviations={"C_r": 0.2}),
    "plain again": folding_wing(),
}


def test_only_changes_are_listed_in_the_order_of_the_problems() -> None:
    table = changed_inputs({}, {"inputs": pd.DataFrame(input_rows(PROBLEMS))})
    assert table.to_numpy().tolist() == [
        ["slow", "V_q", "mean", "100 m/s", "140 m/s"],
        ["loose", "C_r", "mean", "2 mm", "1.5 mm"],
        ["loose", "C_r", "standard deviation", "0.2 mm", "0.05 mm"],
    ]


def test_no_change_is_said() -> None:
    frame = pd.DataFrame(input_rows({"plain": folding_wing()}))
    with pytest.raises(SelectionError, match="all problems have the same inputs"):
        changed_inputs({}, {"inputs": frame})
