"""The surface of a model as that of its partner and of the difference from it."""

import numpy as np

from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.surrogates.partner_surface import PartnerSurface, factor_of
from uqfold.typing import FloatArray

U = np.random.default_rng(3).standard_normal((60, 2))
FEW = 20


def low(u: FloatArray) -> FloatArray:
    return np.asarray(u[:, 0] + 0.5 * np.sin(2.0 * u[:, 1]))


def high(u: FloatArray) -> FloatArray:
    return np.asarray(1.3 * low(u) + 0.4 * u[:, 1] + 0.05 * u[:, 0] ** 2)


def partner_surface(u: FloatArray, few: int) -> PartnerSurface:
    of_low = fit_gaussian_process(U, low(U), noise=0.0)
    own = fit_gaussian_process(U[:FEW], high(U[:FEW]) - low(U[:FEW]), noise=0.0, trend=1)
    settings = own.hyperparameters
    plain = GaussianProcess(u[:few], high(u[:few]), own.kernel, own.trend, settings)
    factor = factor_of(plain, low(u[:few]), plain.y)
    difference = GaussianProcess(
        u[:few], plain.y - factor * low(u[:few]), own.kernel, own.trend, settings
    )
    partner = GaussianProcess(u, low(u), of_low.kernel, of_low.trend, of_low.hyperparameters)
    return PartnerSurface(partner, difference, factor)


def test_the_factor_is_that_of_universal_kriging() -> None:
    """As if the partner's responses were one more function of the trend."""
    surface = partner_surface(U, FEW)
    own, y, told = surface.difference, high(U[:FEW]), low(U[:FEW])
    assert np.allclose(surface.y, y)
    # no other factor leaves less in the metric of P
    sizes = [
        own.product(y - f * told, y - f * told) for f in surface.factor + np.array([0, -1e-3, 1e-3])
    ]
    assert sizes[0] < min(sizes[1:])
    assert abs(surface.factor - 1.3) < 0.05


def test_draws_scatter_around_the_mean_and_meet_the_runs() -> None:
    surface = partner_surface(U, FEW)
    new = np.random.default_rng(5).standard_normal((40, 2))
    paths = surface.sample_paths(np.random.default_rng(1), 400)
    drawn = paths(new)
    std = drawn.std(axis=0)
    assert (np.abs(drawn.mean(axis=0) - surface.mean(new)) < 0.25 * std + 1e-9).all()
    assert np.abs(paths(U[:FEW]) - high(U[:FEW])).max() < 1e-3
    assert np.sqrt(np.mean((surface.mean(new) - high(new)) ** 2)) < 0.2


def test_runs_left_out_are_left_out_of_both() -> None:
    """Residuals against processes that never saw the run, neither of the model nor beside it."""
    surface = partner_surface(U, FEW)
    validated = surface.leave_one_out()
    for row in (0, 7):
        own = np.delete(np.arange(FEW), row)
        every = np.delete(np.arange(len(U)), row)
        partner, difference = surface.partner, surface.difference
        less = PartnerSurface(
            GaussianProcess(
                U[every], partner.y[every], partner.kernel, partner.trend, partner.hyperparameters
            ),
            GaussianProcess(
                U[own], difference.y[own], difference.kernel, difference.trend,
                difference.hyperparameters,
            ),
            surface.factor,
        )  # fmt: skip
        missed = high(U[row : row + 1]) - less.mean(U[row : row + 1])
        assert np.allclose(validated.residuals[row], missed, rtol=1e-4, atol=1e-7)
        without = surface.without([np.array([row])])
        # all further runs of the partner go with the only group
        assert without(U[row : row + 1]).shape == (1, 1)
