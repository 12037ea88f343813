"""The system with a known answer: is the answer right?"""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

from uqfold.problems.criterion import Criterion
from uqfold.testing.linear_normal import LinearNormalSystem


@pytest.mark.parametrize("individual_std", [1.0, 0.1, 1e-3])
@pytest.mark.parametrize("missions", [1, 5, 1000])
def test_exact_however_suddenly_units_fail(individual_std: float, missions: int) -> None:
    """Shared causes that outweigh the others make failure a step over V: a rule missed 1e-3."""
    system = LinearNormalSystem(units=4, mean=0.0, shared_std=2.0, individual_std=individual_std)

    def integrand(v: float) -> float:
        late = float(ndtr((2.0 * v - 3.0) / individual_std))
        failure = -math.expm1(4 * missions * math.log1p(-min(late, 1.0 - 2.0**-53)))
        return failure * math.exp(-0.5 * v * v) / math.sqrt(2.0 * math.pi)

    edges = np.clip(1.5 + 0.5 * individual_std * np.linspace(-10.0, 10.0, 41), -9.0, 9.0)
    exact = sum(
        quad(integrand, low, high, epsabs=0.0, epsrel=1e-12)[0]
        for low, high in zip([-9.0, *edges], [*edges, 9.0], strict=True)
        if high > low
    )
    assert system.pf(Criterion(3.0, missions=missions)) == pytest.approx(exact, rel=1e-11, abs=0.0)


def test_thresholds_at_infinity() -> None:
    system = LinearNormalSystem()
    assert system.pf(Criterion(math.inf)) == 0.0
    assert system.pf(Criterion(-math.inf)) == pytest.approx(1.0, rel=1e-12)
