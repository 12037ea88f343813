"""The analysis `lock-scan`: times are those of the ideal wing, impossible wings are left out."""

import math

import pytest

from uqfold.comparison.studies.registry import StepContext
from uqfold.comparison.studies.steps.lock_scan import lock_scan
from uqfold.evaluation.evaluator import Evaluator
from uqfold.mechanism import WingParameters, ideal_deployment_times
from uqfold.problems import folding_wing, folding_wing_random_lengths, series

PROBLEMS = {
    "three": folding_wing(),
    "six": folding_wing_random_lengths(),
    "other": series(),
}
CONTEXT = StepContext(PROBLEMS, {}, lambda _: Evaluator())


def test_times_are_those_of_the_ideal_wing_at_the_means() -> None:
    settings = {
        "problem": ("three", "six"),
        "theta_1_initial": (0.0, 5.0),
        # the slider starts at 0.2 m, and the arms reach 2.8 m
        "x_lock": (0.1, 1.0, 2.9),
    }
    table = lock_scan(settings, CONTEXT)
    assert table[["problem", "theta_1_initial", "x_lock"]].to_numpy().tolist() == [
        [name, angle, 1.0] for name in ("three", "six") for angle in (0.0, 5.0)
    ]
    wing = WingParameters(theta_1_initial=math.radians(5.0))
    six = ideal_deployment_times(wing, V_q=200.0, delta=0.0, k_d=1100.0, b=0.006, l_1=1.5, l_2=1.3)
    assert table["time"].iloc[-1] == pytest.approx(six[0], rel=1e-12)
    assert table["time"].is_monotonic_decreasing


def test_other_problems_are_refused() -> None:
    settings = {"problem": ("other",), "theta_1_initial": (0.0,), "x_lock": (1.0,)}
    with pytest.raises(TypeError, match="'other' is no problem of the folding wing"):
        lock_scan(settings, CONTEXT)
