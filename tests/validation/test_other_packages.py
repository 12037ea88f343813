"""Adapters of other packages: runs counted by our evaluator, errors of the budget not swallowed."""

from contextlib import suppress

import numpy as np
import pytest

from uqfold.methods import Estimate, Task
from uqfold.problems import Problem, catalogue
from uqfold.testing.counting import RowCount
from validation.benchmarks.other_packages import Margin, PeerMethod, methods


@pytest.mark.parametrize(
    ("label", "budget"),
    [("OpenTURNS FORM", 100), ("OpenTURNS NAIS", 6_000), ("OpenTURNS directional", 500)],
)
def test_runs_are_those_that_the_model_has_seen(label: str, budget: int) -> None:
    base, count = catalogue.problem("rp8"), RowCount()

    def model(x: np.ndarray) -> np.ndarray:
        count.add(x)
        return base.model(x)

    counting = Problem(model, inputs=base.inputs.distribution, names=base.inputs.names)
    first, second = (
        methods()[label].estimate(counting, base.default_criteria, max_evals=budget, rng=3)[0]
        for _ in range(2)
    )
    assert 0 < first.n_evals <= budget
    assert count.rows == first.n_evals + second.n_evals
    assert first.pf == second.pf
    reference = next(iter(base.references or ())).pf
    assert 0.2 * reference < first.pf < 5.0 * reference


class Swallows(PeerMethod):
    """Goes on when the model raises."""

    name = "swallows"

    def _of_event(self, margin: Margin, dimension: int, task: Task) -> Estimate:
        with suppress(Exception):
            margin(np.zeros((10, dimension)))
        return Estimate(0.1)


def test_what_a_package_makes_of_runs_that_it_did_not_get_is_no_answer() -> None:
    """Line sampling of PySTRA goes on beyond the budget, and is 87 % off then."""
    answer = Swallows().estimate(catalogue.problem("rp8"), max_evals=5)[0]
    assert answer.status == "failed"
    assert "out of budget" in answer.message
