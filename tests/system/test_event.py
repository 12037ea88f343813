"""The system event against definitions written out by hand, and against exact probabilities."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, norm

import uqfold
from uqfold import Binomial, Criterion
from uqfold.inputs import normal
from uqfold.problems.base import LIMIT_STATE_THRESHOLD
from uqfold.system import SystemEvent
from uqfold.system.event import Worst, mission_fails
from uqfold.system.structure import SystemUnits
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray

INF, NAN = math.inf, math.nan
MEAN, SHARED, INDIVIDUAL = 10.0, 0.5, 1.0


def response(x: FloatArray) -> FloatArray:
    """Linear in one shared and two individual standard-normal inputs."""
    return MEAN + SHARED * x[:, 0] + INDIVIDUAL * (0.6 * x[:, 1] + 0.8 * x[:, 2])


def linear_problem(units: int = 3, model=response) -> uqfold.Problem:
    one = normal(0.0, 1.0)
    return uqfold.Problem(
        model, shared={"V": one}, individual={"U": one, "W": one}, units=units, name="linear"
    )


def works(y: list[float], threshold: float, tau: float | None) -> bool:
    """Say by the definition whether a mission without failed runs works."""
    if any(t == INF for t in y) or any(not t <= threshold for t in y):
        return False
    if tau is None:
        return True
    if any(math.isinf(t) for t in y):
        return False
    return all(a - b <= tau for a in y for b in y)


def mission_margin(
    y: FloatArray,
    threshold: float,
    tau: float | None,
    *,
    missing_fails: bool,
    units: SystemUnits | None = None,
) -> FloatArray:
    """Continuous margin of one mission."""
    return Worst.of_missions(y, missing_fails=missing_fails, units=units).margin(threshold, tau)


finite = st.floats(allow_nan=False, allow_infinity=False)
responses = st.floats(allow_nan=False) | st.sampled_from([0.0, 0.1, 0.3, 0.1 + 0.2, -1.0])
taus = st.none() | st.floats(min_value=0.0) | st.sampled_from([0.0, 0.2, 0.1 + 0.2 - 0.1])


class TestOneMission:
    @given(
        st.lists(responses, min_size=1, max_size=4), st.floats(allow_nan=False) | responses, taus
    )
    def test_decision_and_margin_follow_the_definition(
        self, y: list[float], threshold: float, tau: float | None
    ) -> None:
        expected = not works(y, threshold, tau)
        for missing_fails in (False, True):
            fails = mission_fails(np.array(y), threshold, tau, missing_fails=missing_fails)
            margin = mission_margin(np.array(y), threshold, tau, missing_fails=missing_fails)
            assert bool(fails) == expected
            assert bool(margin > 0.0) == expected
            assert not np.isnan(margin)

    @given(st.lists(responses | st.just(NAN), min_size=1, max_size=4), finite, taus)
    def test_margin_and_decision_agree_with_failed_runs(
        self, y: list[float], threshold: float, tau: float | None
    ) -> None:
        for missing_fails in (False, True):
            fails = mission_fails(np.array(y), threshold, tau, missing_fails=missing_fails)
            margin = mission_margin(np.array(y), threshold, tau, missing_fails=missing_fails)
            assert bool(margin > 0.0) == bool(fails)

    @given(st.lists(finite, min_size=1, max_size=3), responses, finite, taus)
    def test_failed_runs_are_bracketed_whatever_they_would_have_been(
        self, y: list[float], truth: float, threshold: float, tau: float | None
    ) -> None:
        known, seen = np.array([*y, truth]), np.array([*y, NAN])
        actual = mission_fails(known, threshold, tau, missing_fails=False)
        low = mission_fails(seen, threshold, tau, missing_fails=False)
        high = mission_fails(seen, threshold, tau, missing_fails=True)
        assert bool(low) <= bool(actual) <= bool(high)

    @pytest.mark.parametrize(
        ("y", "threshold", "tau", "low", "high"),
        [
            ([1.0, 2.0], 2.0, None, False, False),  # t = T works
            ([1.0, 2.0], np.nextafter(2.0, 0.0), None, True, True),
            ([1.0, 2.0], 5.0, 1.0, False, False),  # max - min = tau works
            ([1.0, 2.0], 5.0, np.nextafter(1.0, 0.0), True, True),
            ([3.0], 3.0, 0.0, False, False),
            ([1.0, INF], INF, None, True, True),  # never locks: fails every criterion
            ([INF, INF], 5.0, INF, True, True),  # inf - inf is no agreement
            ([-INF, 1.0], 5.0, None, False, False),
            ([-INF, 1.0], 5.0, 9.0, True, True),
            ([-INF, -INF], 5.0, 9.0, True, True),
            ([-INF], -INF, None, False, False),
            ([1.0], -INF, None, True, True),
            ([1.0, NAN], 5.0, None, False, True),
            ([1.0, NAN], 5.0, 0.0, False, True),
            ([1.0, 3.0, NAN], 5.0, 1.0, True, True),  # the other two decide
            ([6.0, NAN], 5.0, None, True, True),
            ([NAN, NAN], 5.0, 1.0, False, True),
        ],
    )
    def test_cases(
        self, y: list[float], threshold: float, tau: float | None, low: bool, high: bool
    ) -> None:
        assert bool(mission_fails(np.array(y), threshold, tau, missing_fails=False)) is low
        assert bool(mission_fails(np.array(y), threshold, tau, missing_fails=True)) is high

    def test_margin_is_the_distance_to_the_nearest_limit(self) -> None:
        y = np.array([[1.0, 4.0], [1.0, 4.5], [2.0, 2.0]])
        margin = mission_margin(y, 5.0, 2.5, missing_fails=True)
        assert margin == pytest.approx([0.5, 1.0, -2.5])
        assert mission_margin(y, 5.0, None, missing_fails=True) == pytest.approx([-1, -0.5, -3])

    def test_any_leading_shape(self) -> None:
        y = np.random.default_rng(1).normal(size=(5, 2, 3))
        whole = mission_fails(y, 0.5, 1.0, missing_fails=True)
        assert whole.shape == (5, 2)
        one = [
            mission_fails(y[i, j], 0.5, 1.0, missing_fails=True) for i in range(5) for j in range(2)
        ]
        assert whole.ravel().tolist() == one

    def test_a_limit_state_fails_at_zero(self) -> None:
        y = -np.array([[0.0], [5e-324], [-5e-324]])  # the response is -g
        fails = mission_fails(y, LIMIT_STATE_THRESHOLD, None, missing_fails=True)
        assert fails.tolist() == [True, False, True]


class TestLayout:
    @pytest.mark.parametrize(
        ("missions", "dimension", "cost"), [(1, 7, 3), (4, 25, 12), (Binomial(4, 0.3), 26, 12)]
    )
    def test_dimension_and_largest_cost(
        self, missions: int | Binomial, dimension: int, cost: int
    ) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, missions=missions))
        assert event.dimension == dimension
        assert event.max_evals_per_sample == cost

    @pytest.mark.parametrize("missions", [3, Binomial(3, 0.6)])
    @pytest.mark.parametrize("tau", [None, 1.5])
    def test_margin_equals_a_simulation_sample_by_sample(
        self, missions: int | Binomial, tau: float | None
    ) -> None:
        criterion = Criterion(11.0, tau, missions)
        event = SystemEvent(linear_problem(), criterion)
        u = np.random.default_rng(2).standard_normal((50, event.dimension))
        seen = []

        def evaluate(x: FloatArray) -> FloatArray:
            seen.append(len(x))
            return response(x)

        margin = event.margin(u, evaluate)
        for row, got in zip(u, margin, strict=True):
            count = 3 if missions == 3 else int(binom.ppf(norm.cdf(row[-1]), 3, 0.6))
            expected = -INF
            for mission in range(count):
                t = []
                for unit in range(3):
                    first = 1 + 2 * (3 * mission + unit)
                    own = 0.6 * row[first] + 0.8 * row[first + 1]
                    t.append(MEAN + SHARED * row[0] + INDIVIDUAL * own)
                expected = max(expected, max(t) - 11.0)
                if tau is not None:
                    expected = max(expected, max(t) - min(t) - tau)
            assert got == pytest.approx(expected, abs=1e-12)
        assert seen == [event.evals(u).sum()]

    def test_only_flown_missions_cost(self) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, missions=Binomial(5, 0.5)))
        u = np.zeros((3, event.dimension))
        u[:, -1] = [-10.0, 0.0, 10.0]  # 0.5^5 = 0.031 either side: none, the median, all
        assert event.missions(u).tolist() == [0, 2, 5]
        assert event.evals(u).tolist() == [0, 6, 15]
        margin = event.margin(u, response)
        assert margin[0] == -INF
        assert margin[1] == margin[2] == MEAN - 11.0

    @pytest.mark.parametrize(("p", "expected"), [(0.0, 0), (1.0, 4)])
    def test_certain_number_of_missions(self, p: float, expected: int) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, missions=Binomial(4, p)))
        u = np.zeros((3, event.dimension))
        u[:, -1] = [-37.0, 0.0, 37.0]
        assert event.missions(u).tolist() == [expected] * 3

    @pytest.mark.parametrize(("planned", "p"), [(10, 0.7), (40, 0.02), (1, 0.5), (30, 1e-4)])
    def test_number_of_missions_has_its_binomial_distribution(self, planned: int, p: float) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, missions=Binomial(planned, p)))
        for k in range(planned):
            # just below the (1 - P(K > k)) quantile K is at most k, just above it is more
            tail = binom.sf(k, planned, p)
            if tail < 1e-280:
                continue
            z = norm.isf(tail)
            u = np.zeros((2, event.dimension))
            u[:, -1] = [z - 1e-6, z + 1e-6]
            below, above = event.missions(u)
            assert below <= k < above

    def test_zero_missions_run_nothing(self) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, missions=Binomial(2, 0.0)))

        def evaluate(x: FloatArray) -> FloatArray:
            assert len(x) == 0
            return np.empty(0)

        assert event.margin(np.zeros((4, event.dimension)), evaluate).tolist() == [-INF] * 4

    def test_wrong_width_is_refused(self) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0))
        with pytest.raises(ValueError, match=r"shape \(N, 7\)"):
            event.margin(np.zeros((2, 6)), response)

    def test_other_systems_are_refused(self) -> None:
        problem = uqfold.Problem(
            response, individual=[normal(0, 1)] * 3, units=2, structure=uqfold.Parallel()
        )
        with pytest.raises(ValueError, match="no system event"):
            SystemEvent(problem, Criterion(11.0, tau=1.0))

    @pytest.mark.parametrize("failed", [(0, 1, 0), (1, 0, 1), (0, 0, 1), (1, 1, 1)])
    @pytest.mark.parametrize(
        ("structure", "must_fail"),
        [
            (uqfold.Parallel(), all),
            (uqfold.KOutOfN(2), lambda f: sum(f) >= 2),
            (uqfold.CutSets([[0, 1], [2]]), lambda f: f[2] or (f[0] and f[1])),
        ],
    )
    def test_a_structure_decides_what_failed_units_mean(
        self, structure: Any, must_fail: Any, failed: tuple[int, ...]
    ) -> None:
        """Structures other than series had no event; a failed run is a unit that may fail."""
        units = SystemUnits.of(uqfold.Problem(response, individual=[normal(0, 1)], units=3,
                                              structure=structure))  # fmt: skip
        y = np.where(failed, 2.0, 0.5)
        expected = bool(must_fail(failed))
        margin = mission_margin(y, 1.0, None, missing_fails=True, units=units)
        assert mission_fails(y, 1.0, None, missing_fails=True, units=units) == expected
        assert (margin > 0.0) == expected
        lost = np.where(failed, np.nan, 0.5)
        assert mission_fails(lost, 1.0, None, missing_fails=True, units=units) == expected
        assert not mission_fails(lost, 1.0, None, missing_fails=False, units=units)

    @pytest.mark.parametrize("missions", [2, Binomial(2, 0.4)])
    def test_units_that_differ_in_any_structure(self, missions: int | Binomial) -> None:
        """One event for other models, offsets and numbers of inputs; none of its variables idle."""

        def valve(x: FloatArray) -> FloatArray:
            return 9.0 + 0.4 * x[:, 0] + x[:, 1] * np.exp(0.2 * x[:, 2])

        def pump(x: FloatArray) -> FloatArray:
            return 9.5 - 0.3 * x[:, 0] + x[:, 1]

        one = normal(0.0, 1.0)
        problem = uqfold.Problem(
            pump,
            shared={"V": one},
            individual={"U": one},
            units=[
                uqfold.Unit(name="a"),
                uqfold.Unit(valve, [one] * 2, name="b"),
                uqfold.Unit(offset=-0.4, name="c"),
            ],
            structure=uqfold.Structure("a & b | c"),
        )
        event = SystemEvent(problem, Criterion(10.0, missions=missions))
        random = isinstance(missions, Binomial)
        assert event.dimension == 1 + 2 * 4 + random
        u = np.random.default_rng(5).standard_normal((200, event.dimension))
        flown = event.missions(u)
        expected = np.full(200, -INF)
        for mission in range(2):
            own = u[:, 1 + 4 * mission :]
            a = pump(np.stack([u[:, 0], own[:, 0]], axis=1))
            b = valve(np.stack([u[:, 0], own[:, 1], own[:, 2]], axis=1))
            c = pump(np.stack([u[:, 0], own[:, 3]], axis=1)) - 0.4
            margin = np.minimum(np.maximum(a, b), c) - 10.0
            expected = np.where(flown > mission, np.maximum(expected, margin), expected)
        seen = []

        def evaluate(x: FloatArray) -> FloatArray:
            seen.append(len(x))
            return problem.kinds.model(x)

        assert event.margin(u, evaluate) == pytest.approx(expected, abs=1e-12)
        assert seen == [event.evals(u).sum()]
        assert 0 < np.count_nonzero(expected > 0.0) < 100
        lost = event.margin(u, lambda x: np.where(x[:, -1] == 1.0, NAN, problem.kinds.model(x)))
        # without b the system fails if a and c do, or if c does and b might
        assert set(np.flatnonzero(lost > 0.0)) <= set(np.flatnonzero(expected > 0.0))
        assert np.isnan(lost).any()


class TestFailedRuns:
    def lost(self, x: FloatArray) -> FloatArray:
        """Fail where the first individual input is above one."""
        return np.where(x[:, 1] > 1.0, np.nan, response(x))

    def test_open_samples_are_nan_and_bounded(self) -> None:
        event = SystemEvent(linear_problem(), Criterion(11.0, tau=2.0, missions=2))
        u = np.random.default_rng(3).standard_normal((400, event.dimension))
        margin = event.margin(u, self.lost)
        low, high = event.margin_bounds(u, self.lost)
        true = event.margin(u, response)
        decided = ~np.isnan(margin)
        assert 0 < decided.sum() < 400
        assert (low <= high).all()
        assert ((low > 0) <= (true > 0)).all()
        assert ((true > 0) <= (high > 0)).all()
        assert ((margin > 0) == (true > 0))[decided].all()
        # open means open: the two bounds really disagree there
        assert ((low <= 0) & (high > 0))[~decided].all()


def exact(units: int, criterion: Criterion) -> float:
    return LinearNormalSystem(units, MEAN, SHARED, INDIVIDUAL).pf(criterion)


@pytest.mark.parametrize("missions", [1, 3, Binomial(4, 0.7)])
@pytest.mark.parametrize(("threshold", "tau"), [(11.5, None), (12.0, 2.0), (16.0, 2.5)])
def test_probability_of_the_event_is_exact(
    threshold: float, tau: float | None, missions: int | Binomial
) -> None:
    criterion = Criterion(threshold, tau, missions)
    event = SystemEvent(linear_problem(units=3), criterion)
    n = 20_000
    u = np.random.default_rng(4).standard_normal((n, event.dimension))
    pf = float((event.margin(u, response) > 0.0).mean())
    true = exact(3, criterion)
    standard_error = math.sqrt(true * (1 - true) / n)
    assert abs(pf - true) < 4 * standard_error
    # the check can fail: one unit or mission fewer is far outside
    assert abs(pf - exact(2, criterion)) > 4 * standard_error
