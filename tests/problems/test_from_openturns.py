"""Problems made of the events of OpenTURNS."""

from collections.abc import Callable
from typing import Any

import numpy as np
import openturns as ot
import pytest

from uqfold import Problem
from uqfold.methods import MonteCarlo
from uqfold.problems.base import LIMIT_STATE_THRESHOLD

X = ot.RandomVector(ot.Normal(2))


def event(formula: str, operator: Any, threshold: float) -> Any:
    function = ot.SymbolicFunction(["a", "b"], [formula])
    return ot.ThresholdEvent(ot.CompositeRandomVector(function, X), operator, threshold)


JOINED: list[tuple[Callable[[], Any], Callable[[np.ndarray, np.ndarray], np.ndarray]]] = [
    (lambda: event("a + b", ot.Greater(), 1.0), lambda a, b: a + b > 1.0),
    (lambda: event("a + b", ot.GreaterOrEqual(), 1.0), lambda a, b: a + b >= 1.0),
    (lambda: event("a + b", ot.Less(), -1.0), lambda a, b: a + b < -1.0),
    (lambda: event("a + b", ot.LessOrEqual(), -1.0), lambda a, b: a + b <= -1.0),
    (
        lambda: ot.UnionEvent([event("a", ot.Greater(), 1.0), event("b", ot.LessOrEqual(), -1.0)]),
        lambda a, b: (a > 1.0) | (b <= -1.0),
    ),
    (
        lambda: ot.IntersectionEvent(
            [event("a", ot.GreaterOrEqual(), 0.5), event("b", ot.Less(), 0.5)]
        ),
        lambda a, b: (a >= 0.5) & (b < 0.5),
    ),
    (
        lambda: ot.IntersectionEvent(
            [
                ot.UnionEvent([event("a", ot.Greater(), 1.0), event("b", ot.Greater(), 1.0)]),
                event("a", ot.Less(), 0.0),
            ]
        ),
        lambda a, b: ((a > 1.0) | (b > 1.0)) & (a < 0.0),
    ),
    (
        lambda: event("a", ot.Greater(), 1.0).join(event("b", ot.Less(), 0.0)),
        lambda a, b: (a > 1.0) | (b < 0.0),
    ),
]


@pytest.mark.parametrize(("make", "fails"), JOINED)
def test_a_problem_fails_exactly_when_the_event_occurs(
    make: Callable[[], Any], fails: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> None:
    """Also on the threshold itself: all points of this grid are exact."""
    problem = Problem.from_openturns(make())
    a, b = (one.ravel() for one in np.meshgrid(*[np.arange(-2.0, 2.25, 0.25)] * 2))
    (criterion,) = problem.default_criteria or ()
    found = problem.model(np.column_stack([a, b])) > criterion.threshold
    np.testing.assert_array_equal(found, fails(a, b))


def test_an_event_has_its_name_inputs_and_options() -> None:
    """A limit state g <= 0 is one for us, too."""
    stated = event("2 - a", ot.LessOrEqual(), 0.0)
    stated.setName("bar")
    problem = Problem.from_openturns(stated, shared=["X0"], units=2, response_unit="kN")
    assert (problem.name, problem.n_units, problem.response_unit) == ("bar", 2, "kN")
    assert problem.inputs.shared_names == ("X0",)
    assert [one.threshold for one in problem.default_criteria or ()] == [LIMIT_STATE_THRESHOLD]
    row = MonteCarlo().estimate(Problem.from_openturns(stated), max_evals=100_000, rng=0)[0]
    assert abs(row.pf - 0.0227501319) < 4.0 * row.std_error


def test_other_events_are_refused() -> None:
    """Also inputs beside those of the event."""
    function = ot.SymbolicFunction(["a", "b"], ["a", "b"])
    domain = ot.DomainEvent(ot.CompositeRandomVector(function, X), ot.Interval(2))
    for other in (domain, X):
        with pytest.raises(
            (TypeError, ValueError), match=r"event = .*: give an openturns\.ThresholdEvent"
        ):
            Problem.from_openturns(other)
    with pytest.raises(ValueError, match=r"inputs = .*: the event has its own; give names="):
        Problem.from_openturns(event("a", ot.Less(), 0.0), inputs=ot.Normal(2))
    with pytest.raises(TypeError, match=r"event = .*: give an openturns\.ThresholdEvent"):
        Problem.from_openturns(ot.Normal(2))
    with pytest.raises(ValueError, match="compare by Less"):
        Problem.from_openturns(event("a", ot.Equal(), 1.0))
