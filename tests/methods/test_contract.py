"""Every registered method keeps the contract."""

from functools import partial

import pytest

from uqfold.methods import (
    ActiveKriging,
    Automatic,
    Kriging,
    MultifidelityMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
    available,
)
from uqfold.testing import CHECKS, check_method
from uqfold.testing.conduct import same_in_a_fresh_process
from uqfold.testing.verdict import Level, Settings

METHODS = available()
THOROUGH = pytest.mark.thorough
# thirty surfaces each
SLOW = {(name, "stated_errors_are_honest") for name in ("auto", "kriging", "pce", "active-kriging")}
LIGHT: dict[str, ReliabilityMethod] = {
    "auto": Automatic(check_runs=0),
    "kriging": Kriging(runs=40, kernel="gaussian", trend="linear"),
    "pce": PolynomialChaos(runs=40, max_degree=3),
    "active-kriging": ActiveKriging(runs=40, kernel="gaussian"),
    "multifidelity-mc": MultifidelityMonteCarlo(partner_systems=4_000, cost_ratio=20.0, pilot=40),
}
"""Settings that take a third of the time: one surface where the defaults choose among several."""
QUICK = LIGHT | {"active-kriging": ActiveKriging(runs=18, kernel="gaussian")}
FEWER_RUNS: dict[str, ReliabilityMethod] = {
    "kriging": Kriging(runs=40),
    "active-kriging": ActiveKriging(runs=40),
}
"""The choices of the defaults, on less than half of their runs."""
BY_DEFAULTS = {
    "one_unit_is_exact",
    "shared_inputs_correlate_units",
    "synchronization",
    "stated_errors_are_honest",
}
"""Checks that the defaults have to keep themselves; others see the same code by fewer fits."""
BY_CHOICES = {"rows_are_well_formed"}
"""Checks of how the defaults choose, whatever the runs are."""
BY_ITS_SURFACE = {
    "answers_are_monotone",
    "grid_agrees_with_single_criteria",
    "other_seed_other_answer",
    "plain_limit_state",
    "scale_and_shift",
    "structures",
    "synchronization",
}
"""Checks that hold of an answer from a surface: by default `kriging` alone is asked."""
TOGETHER, HONEST = "same_answer_in_a_fresh_process", "stated_errors_are_honest"


@pytest.mark.parametrize("name", METHODS)
def test_registered_method_keeps_the_contract(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # what it does around its surface is asked here; the surface is asked as a method of its own
    light_surface = partial(Kriging, runs=40, kernel="gaussian", trend="linear")
    monkeypatch.setattr("uqfold.methods.automatic.Kriging", light_surface)
    method = QUICK.get(name, METHODS[name]())
    left_out = BY_ITS_SURFACE if name in ("active-kriging", "auto") else set()
    others = [check for check in CHECKS if check not in {TOGETHER, HONEST, *left_out}]
    assert check_method(method, "quick", only=others) == others
    if name == "kriging":
        # a kernel and a trend that are prescribed are believed: their choice is part of the error
        method = FEWER_RUNS[name]
    assert check_method(method, "quick", only=[HONEST]) == [HONEST]


@pytest.mark.parametrize(
    ("name", "check"),
    [
        pytest.param(name, check, marks=pytest.mark.slow if (name, check) in SLOW else THOROUGH)
        for name in METHODS
        for check in CHECKS
        if check != TOGETHER
    ],
)
def test_registered_method_keeps_the_whole_contract(name: str, check: str) -> None:
    method = METHODS[name]()
    assert method.name == name
    if check in BY_CHOICES:
        method = FEWER_RUNS.get(name, method)
    elif check not in BY_DEFAULTS or name == "multifidelity-mc":
        method = LIGHT.get(name, method)
    assert check_method(method, only=[check]) == [check]


@pytest.mark.parametrize("level", ["quick", pytest.param("full", marks=THOROUGH)])
def test_registered_methods_give_the_same_answers_in_a_fresh_process(level: Level) -> None:
    """One process for all of them."""
    settings = Settings(level, tolerance=0.03, max_evals=6_000)
    chosen = QUICK if level == "quick" else FEWER_RUNS
    # by default one surface stands for those that learn, and for what chooses among methods
    left_out = ("active-kriging", "auto") if level == "quick" else ()
    names = [name for name in METHODS if name not in left_out]
    methods = [chosen.get(name, METHODS[name]()) for name in names]
    same_in_a_fresh_process(methods, settings)


def test_unknown_check_is_refused() -> None:
    with pytest.raises(ValueError, match=r"only\[0\] = 'speed': choose from"):
        check_method(METHODS["mc"](), only=["speed"])
