"""Derivatives of pf on a fitted surface, against exact ones of a linear and of a curved system."""

from dataclasses import replace

import numpy as np
import openturns as ot
import pytest

from tests.analysis.exact_derivatives import exact_derivative
from uqfold import Binomial, Criterion, Problem, criteria
from uqfold.analysis import NoSurfaceError, PfDerivatives, surface_derivatives
from uqfold.inputs.score import moved_inputs
from uqfold.methods import Kriging, MonteCarlo, PolynomialChaos
from uqfold.problems import series
from uqfold.system.surface import reliability_index
from uqfold.system.surface_layout import laid_out
from uqfold.testing import LinearNormalSystem

SYSTEM = LinearNormalSystem(units=3, shared_std=0.7)
GRID = [Criterion(10.5, None, Binomial(4, 0.3)), Criterion(15.0), Criterion(13.0, 3.0)]


@pytest.fixture(scope="module")
def found() -> PfDerivatives:
    method = Kriging(runs=40, kernel="gaussian", trend="linear")
    return surface_derivatives(SYSTEM.problem(), GRID, method, rng=1)


def errors(found: PfDerivatives, system: LinearNormalSystem) -> np.ndarray:
    """Distance from the exact derivatives, in standard errors."""
    per_criterion = len(found) // len(GRID)
    return np.array(
        [
            (
                row.derivative
                - exact_derivative(system, GRID[i // per_criterion], row.input, row.moment)
            )
            / row.std_error
            for i, row in enumerate(found)
        ]
    )


def test_exact_on_a_linear_system(found: PfDerivatives) -> None:
    assert np.abs(errors(found, SYSTEM)).max() < 3.0
    for row in found:
        assert row.std_error < 6e-3 * abs(row.derivative) + 2e-3 * row.pf
        assert row.error_kind == "surrogate"


@pytest.mark.parametrize("wrong", [{"shared_std": 0.72}, {"individual_std": 1.01}], ids=str)
def test_the_comparison_can_fail(found: PfDerivatives, wrong: dict[str, float]) -> None:
    assert np.abs(errors(found, replace(SYSTEM, **wrong))).max() > 10.0


def test_numbers_without_unit_follow_from_the_derivative(found: PfDerivatives) -> None:
    for row in found:
        assert row.per_std == pytest.approx(row.std / row.pf * row.derivative, rel=1e-9)
        assert row.elasticity == pytest.approx(row.value / row.pf * row.derivative, rel=1e-9)
    frame = found.to_frame()
    assert len(frame) == len(GRID) * 6
    assert frame["input"].tolist()[:6] == ["V", "U", "W"] * 2
    assert frame["moment"].tolist()[:6] == ["mean"] * 3 + ["standard deviation"] * 3
    assert frame["shared"].tolist()[:3] == [True, False, False]


def test_repeats_with_its_seed() -> None:
    asked, light = [Criterion(12.0)], Kriging(runs=20, kernel="gaussian", trend="linear")
    one, again = (
        surface_derivatives(SYSTEM.problem(), asked, light, inputs=["U"], rng=1) for _ in range(2)
    )
    assert one.rows == again.rows
    assert [row.input for row in one] == ["U", "U"]
    assert one.n_evals == 20


@pytest.mark.slow
@pytest.mark.parametrize("method", [Kriging(), PolynomialChaos()], ids=lambda m: m.name)
def test_stated_errors_hold_on_a_curved_system(method: Kriging | PolynomialChaos) -> None:
    problem = series()
    grid = criteria([0.0, 4.0, 6.0], tau=[None, 16.0])

    def index(inputs: object) -> np.ndarray:
        """Reliability indices by integration over the model itself."""

        def surface(u: np.ndarray) -> np.ndarray:
            return problem.model(inputs.from_standard_normal(u))  # type: ignore[attr-defined]

        system = laid_out(surface, 3, 1, 4, grid)
        return np.array([reliability_index(one) for one in system.failures(surface, grid)])

    density = np.exp(-0.5 * index(problem.inputs) ** 2) / np.sqrt(2.0 * np.pi)
    exact = {}
    for name, std in zip(problem.inputs.names, problem.inputs.standard_deviations, strict=True):
        for moment in ("mean", "standard deviation"):
            at = {
                k: index(moved_inputs(problem.inputs, name, moment, 0.05 * k))
                for k in (-2, -1, 1, 2)
            }
            slope = (8.0 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12.0 * 0.05 * std)
            exact[name, moment] = -density * slope
    z = []
    for seed in range(8):
        found = surface_derivatives(problem, grid, method, rng=seed)
        for i, row in enumerate(found):
            z.append((row.derivative - exact[row.input, row.moment][i // 6]) / row.std_error)
    assert np.sqrt(np.mean(np.square(z))) < 1.5
    assert np.abs(z).max() < 6.0


def test_a_method_without_a_surface_is_refused() -> None:
    with pytest.raises(TypeError, match=r"method = .*: give Kriging"):
        surface_derivatives(SYSTEM.problem(), GRID, MonteCarlo())  # type: ignore[arg-type]


def test_an_unknown_input_is_refused_before_any_run() -> None:
    with pytest.raises(ValueError, match=r"inputs\[0\] = 'k': choose from 'V', 'U', 'W'"):
        surface_derivatives(SYSTEM.problem(), GRID, inputs=["k"])


def test_infinite_responses_allow_no_derivatives() -> None:
    def never(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 0] > 1.0, np.inf, x[:, 0] + x[:, 1])

    problem = Problem(never, shared={"v": ot.Normal()}, individual={"u": ot.Normal()}, units=2)
    with pytest.raises(NoSurfaceError, match="runs gave no finite response"):
        surface_derivatives(problem, criteria(2.0), Kriging(runs=30), rng=0)


def test_moving_bounds_are_refused() -> None:
    problem = Problem(
        lambda x: x.sum(axis=1), shared={"v": ot.Normal()}, individual={"u": ot.Uniform(0, 1)}
    )
    with pytest.raises(ValueError, match="u reaches beyond the bounds"):
        surface_derivatives(problem, criteria(2.0), Kriging(runs=30), rng=0)
