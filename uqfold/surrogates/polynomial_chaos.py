"""Polynomial chaos: expansions of a response in orthonormal polynomials, fitted by regression.

The polynomials are those of Hermite, in the standard-normal variables of the Rosenblatt
transformation, or those of the inputs' own distributions. Which ones are kept is decided by the
corrected leave-one-out error: all up to some total degree, or the leading ones of a least-angle
path through many (`uqfold.surrogates.selection`).

References
----------
Blatman G., Sudret B. Adaptive sparse polynomial chaos expansion based on least angle regression.
J. Comput. Phys. 230 (2011) 2345-2367.
Xiu D., Karniadakis G. E. The Wiener-Askey polynomial chaos for stochastic differential equations.
SIAM J. Sci. Comput. 24 (2002) 619-644.
Sudret B. Global sensitivity analysis using polynomial chaos expansions. Reliab. Eng. Syst. Saf.
93 (2008) 964-979.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.surrogates.centring import centre_of
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.curved_directions import curved_directions
from uqfold.surrogates.hermite import (
    fixed_degree_indices,
    hermite_basis,
    one_dimensional,
    product_basis,
    rescaled,
)
from uqfold.surrogates.random_field import RandomField, random_field
from uqfold.surrogates.selection import (
    MANY_INPUTS,
    Basis,
    Regression,
    regression,
    select_basis,
)
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

_CHUNK = 8192
# A mean square error, relative to the variance, with which no other polynomials are looked for.
_EXACT = 1e-8
# Pairs of points between which inputs are exchanged.
_EXCHANGED = 2_000
_FEATURES = 256
# Most polynomials of the next degree that stand for what was left out, and from how many.
_OMITTED, _MOST_OMITTED = 200, 100_000


@dataclass(frozen=True)
class VarianceShares:
    """Shares of the response's variance, each (d,): by an input alone, and with interactions."""

    main: FloatArray
    total: FloatArray


class InputPolynomials(Protocol):
    """Orthonormal polynomials of one input's own distribution."""

    @property
    def highest(self) -> int:
        """Highest degree there is."""
        ...

    def __call__(self, u: FloatArray, degree: int) -> FloatArray:
        """Values (n, degree + 1) at the input's normal scores u (n,)."""
        ...

    def ladder(self, x: Any, degree: int) -> list[Any]:
        """Polynomials of degree 0 to `degree` in the input x, an array or a symbol."""
        ...


@dataclass(frozen=True, eq=False)
class PolynomialChaosExpansion:
    """Expansion of a response in orthonormal polynomials.

    Attributes
    ----------
    indices
        Multi-indices (P, d), the constant first.
    coefficients
        Coefficients (P,), in the unit of the response.
    residual_std
        Standard deviation of the residuals, degrees of freedom taken off.
    regression
        The fit behind it, in the basis of the design's own spread.
    transfer
        Matrix (P, p) from the p coefficients of the regression to those here.
    spread
        Root mean square of the design's coordinates.
    design
        Points (n, d) of the fit.
    own
        The polynomials of each of the d inputs, None for those of Hermite; None: all of Hermite.
    rotation
        Directions in columns (d, d) along which the variables of the polynomials are measured;
        None: the inputs themselves.
    """

    indices: IntArray
    coefficients: FloatArray
    residual_std: float
    regression: Regression
    transfer: FloatArray
    spread: float
    design: FloatArray
    own: Sequence[InputPolynomials | None] | None = None
    rotation: FloatArray | None = None

    @property
    def basis(self) -> Basis:
        """The polynomials."""
        return _basis(self.own, self.rotation)

    @property
    def degree(self) -> int:
        """Largest total degree."""
        return int(self.indices.sum(axis=1).max())

    @property
    def mean_response(self) -> float:
        """Mean of the response."""
        return float(self.coefficients[0])

    @property
    def variance(self) -> float:
        """Variance of the response."""
        return float(np.sum(self.coefficients[1:] ** 2))

    def mean(self, u: FloatArray) -> FloatArray:
        """Values (m,) of the expansion at u (m, d)."""
        return evaluate(u, self.indices, self.coefficients[:, None], self.basis)[:, 0]

    def leave_one_out(self) -> LeaveOneOut:
        """Prediction of every response from all others, basis kept."""
        fit = self.regression
        std = self.residual_std / np.sqrt(1.0 - fit.leverage)
        return LeaveOneOut(fit.residuals / (1.0 - fit.leverage), std)

    def without(self, groups: Sequence[IntArray]) -> Callable[[FloatArray], FloatArray]:
        """Return the surfaces that some runs less would have given, polynomials kept.

        Parameters
        ----------
        groups
            For each surface the runs (k,) that it leaves out.

        Returns
        -------
        Callable
            Takes u (m, d), gives (len(groups), m).
        """
        fit = self.regression
        points = self.design / self.spread if self.own is None else self.design
        solver = self.basis(points, fit.indices) @ fit.root_covariance
        coefficients = np.tile(self.coefficients[:, None], len(groups))
        for column, some in enumerate(groups):
            # what a fit to all others misses these by
            others = np.eye(some.size) - solver[some] @ solver[some].T
            missed = np.linalg.lstsq(others, fit.residuals[some], rcond=None)[0]
            change = fit.root_covariance @ (solver[some].T @ missed)
            coefficients[:, column] -= self.transfer @ change
        return lambda u: evaluate(u, self.indices, coefficients, self.basis).T

    def sample_paths(self, rng: np.random.Generator, count: int) -> ExpansionPaths:
        """Draw whole surfaces that the residuals allow.

        Each has coefficients drawn from their distribution, and on top what an expansion may
        leave out, which is not noise that averages away: a smooth random field as large as the
        leave-one-out residuals, and random polynomials of the next degree, just as large over the
        design, which grow into the tails. These mix the variables as the response does: a function
        of one direction with the same Sobol' indices would have multinomial shares.

        Parameters
        ----------
        rng
            Source of randomness.
        count
            Number of surfaces R.
        """
        fit, d = self.regression, self.indices.shape[1]
        scatter = fit.root_covariance @ rng.standard_normal((fit.root_covariance.shape[1], count))
        drawn = self.transfer @ (self.residual_std * scatter)
        influence = self._shares().total
        omitted = _next_degree(influence, self.degree + 1)
        if self.own is not None:
            omitted = omitted[(omitted <= _highest(self.own)).all(axis=1)]
        shares = _multinomial(omitted, influence)
        kept = np.argsort(-shares, kind="stable")[:_OMITTED]
        error = self.leave_one_out().rms
        size = error * np.sqrt(shares[kept] / shares[kept].sum())
        if self.own is not None:
            size = size / np.sqrt(np.mean(self.basis(self.design, omitted[kept]) ** 2, axis=0))
        amplitudes = size[:, None] * rng.standard_normal((kept.size, count))
        field = random_field("gaussian", np.full(d, self.spread), _FEATURES, count, rng)
        return ExpansionPaths(
            expansion=self,
            coefficients=self.coefficients[:, None] + drawn,
            omitted=omitted[kept],
            amplitudes=amplitudes,
            field=field.scaled(error),
        )

    def sobol_indices(self) -> VarianceShares:
        """Sobol' indices of all inputs; NaN for a response that does not vary.

        Of polynomials along other directions than the inputs they are sampled, to about 0.02.
        """
        return self._shares() if self.rotation is None else self._sampled_shares()

    def _shares(self) -> VarianceShares:
        """Shares of the variables of the polynomials."""
        share = self.coefficients**2 / (self.variance or math.nan)
        active = self.indices > 0
        alone = active & (active.sum(axis=1) == 1)[:, None]
        return VarianceShares(main=share @ alone, total=share @ active)

    def _sampled_shares(self) -> VarianceShares:
        """Shares of the inputs, by exchanging one at a time between two samples (Jansen)."""
        rng = np.random.default_rng(0)
        one, other = rng.standard_normal((2, _EXCHANGED, self.indices.shape[1]))
        of_one, of_other = self.mean(one), self.mean(other)
        main, total = np.empty((2, self.indices.shape[1]))
        for i in range(main.size):
            mixed = one.copy()
            mixed[:, i] = other[:, i]
            of_mixed = self.mean(mixed)
            main[i] = np.mean(of_other * (of_mixed - of_one))
            total[i] = 0.5 * np.mean((of_one - of_mixed) ** 2)
        return VarianceShares(main / self.variance, total / self.variance)

    def to_chaospy(self, names: Sequence[str] | None = None) -> Any:
        """Return the expansion as a chaospy polynomial.

        Its variables are independent and standard-normal, or, for an expansion in the inputs' own
        polynomials, the inputs themselves where they are not normal.

        Parameters
        ----------
        names
            Names of the variables; by default chaospy's own.
        """
        import chaospy

        d = self.indices.shape[1]
        variables = chaospy.variable(d) if names is None else chaospy.symbols(list(names))
        variables = [variables] if d == 1 else list(variables)
        if self.rotation is not None:
            variables = [
                sum(
                    float(share) * variable for share, variable in zip(axis, variables, strict=True)
                )
                for axis in self.rotation.T
            ]
        own = self.own or [None] * d
        ladders = [
            _ladder(variable, degree) if one is None else one.ladder(variable, degree)
            for variable, one, degree in zip(
                variables, own, self.indices.max(axis=0).tolist(), strict=True
            )
        ]
        total: Any = 0.0
        for index, coefficient in zip(self.indices, self.coefficients, strict=True):
            term: Any = float(coefficient)
            for ladder, order in zip(ladders, index, strict=True):
                if order:
                    term = term * ladder[order]
            total = total + term
        return total


@dataclass(frozen=True, eq=False)
class ExpansionPaths:
    """Surfaces around an expansion; call it at u (m, d) for (R, m).

    Attributes
    ----------
    expansion
        The expansion.
    coefficients
        R sets of coefficients in its polynomials (P, R).
    omitted, amplitudes
        Multi-indices (Q, d) of further polynomials, those of Hermite of u / spread, and their
        coefficients (Q, R).
    field
        A random field on top of each surface.
    """

    expansion: PolynomialChaosExpansion
    coefficients: FloatArray
    omitted: IntArray
    amplitudes: FloatArray
    field: RandomField

    def __call__(self, u: FloatArray) -> FloatArray:
        """Values (R, m) at u (m, d)."""
        base = self.expansion
        values = evaluate(u, base.indices, self.coefficients, base.basis)
        scaled = u / base.spread if base.own is None else u
        values += evaluate(scaled, self.omitted, self.amplitudes, base.basis)
        return values.T + self.field(u)


def evaluate(
    u: FloatArray, indices: IntArray, coefficients: FloatArray, basis: Basis = hermite_basis
) -> FloatArray:
    """Values (m, R) of R expansions with coefficients (P, R) at u (m, d)."""
    out = np.empty((u.shape[0], coefficients.shape[1]))
    for start in range(0, u.shape[0], _CHUNK):
        check_time()
        rows = slice(start, start + _CHUNK)
        out[rows] = basis(u[rows], indices) @ coefficients
    return out


@one_blas_thread()
def fit_polynomial_chaos(
    u: FloatArray,
    y: FloatArray,
    *,
    sparse: bool = True,
    max_degree: int = 10,
    max_orders: IntArray | None = None,
    own: Sequence[InputPolynomials | None] | None = None,
    directions: bool = False,
) -> PolynomialChaosExpansion:
    """Fit an expansion to responses.

    Parameters
    ----------
    u
        Points (n, d) in standard-normal space.
    y
        Finite responses (n,).
    sparse
        Whether a least-angle path may leave out polynomials, or all up to a total degree are kept.
    max_degree
        Highest total degree that is tried.
    max_orders
        Highest degree in each variable (d,), where the design can tell no higher ones apart;
        None: no further limit.
    own
        Polynomials of each of the d inputs' own distributions, None for those of Hermite; None:
        all of Hermite.
    directions
        Whether polynomials along a few directions of curvature are tried too, if inputs are many.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or there are fewer than 2 points.
    """
    u, y = np.asarray(u, dtype=float), np.asarray(y, dtype=float)
    if u.ndim != 2 or y.shape != (u.shape[0],) or u.shape[0] < 2:
        raise ValueError(f"u has shape {u.shape}, y {y.shape}: expected (n, d) and (n,), n >= 2")
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise ValueError("u and y must be finite: leave out failed runs and infinite responses")
    spread = float(np.sqrt(np.mean(u**2))) or 1.0
    centre = centre_of(y)
    # Hermite polynomials of u / spread are about orthogonal over the design
    points, limits = (u / spread, max_orders) if own is None else (u, _highest(own, max_orders))
    found = select_basis(
        points, y - centre,
        sparse=sparse, max_degree=max_degree, max_orders=limits, basis=_basis(own),
    )  # fmt: skip
    rotation = None
    if directions and own is None and max_orders is None and u.shape[1] >= MANY_INPUTS:
        found, rotation = _along_directions(points, y - centre, found)
    if own is None:
        indices, transfer = _transfer(found.indices, spread)
    else:
        indices, transfer = found.indices, np.eye(found.indices.shape[0])
    freedom = max(y.size - found.coefficients.size, 1)
    coefficients = transfer @ found.coefficients
    coefficients[0] += centre
    return PolynomialChaosExpansion(
        indices=indices,
        coefficients=coefficients,
        residual_std=math.sqrt(float(found.residuals @ found.residuals) / freedom),
        regression=found,
        transfer=transfer,
        spread=spread,
        design=u,
        own=own,
        rotation=rotation,
    )


def _along_directions(
    u: FloatArray, y: FloatArray, known: Regression
) -> tuple[Regression, FloatArray | None]:
    """Take polynomials along directions of curvature where they foretell left-out runs better."""
    if known.error <= _EXACT or np.ptp(y) == 0.0:
        return known, None
    curved = curved_directions(u, y)
    if curved is None:
        return known, None
    found = regression(hermite_basis(u @ curved.rotation, curved.indices), y, curved.indices)
    return (found, curved.rotation) if found.error < known.error else (known, None)


def _basis(
    own: Sequence[InputPolynomials | None] | None, rotation: FloatArray | None = None
) -> Basis:
    if rotation is not None:
        return lambda u, indices: hermite_basis(u @ rotation, indices)
    if own is None:
        return hermite_basis
    return partial(product_basis, polynomials=[one or one_dimensional for one in own])


def _highest(
    own: Sequence[InputPolynomials | None], max_orders: IntArray | None = None
) -> IntArray:
    """Highest degree (d,) of each input's polynomials."""
    most = np.iinfo(np.int64).max
    highest = np.array([most if one is None else one.highest for one in own], dtype=np.int64)
    return highest if max_orders is None else np.minimum(highest, max_orders)


@one_blas_thread()
def fit_basis(
    u: FloatArray, y: FloatArray, indices: IntArray, basis: Basis = hermite_basis
) -> Callable[[FloatArray], FloatArray]:
    """Fit the polynomials with the given multi-indices (P, d), the constant among them."""
    centre = centre_of(y)
    found = np.linalg.lstsq(basis(u, indices), y - centre, rcond=None)[0]
    coefficients = np.asarray(found, dtype=float)

    def mean(points: FloatArray) -> FloatArray:
        return evaluate(points, indices, coefficients[:, None], basis)[:, 0] + centre

    return mean


def _next_degree(influence: FloatArray, degree: int) -> IntArray:
    """Multi-indices (P, d) of one degree; of too many variables only the influential ones occur."""
    d = influence.size
    count = d
    while math.comb(count + degree - 1, degree) > _MOST_OMITTED and count > 1:
        count -= 1
    if count == d:
        return fixed_degree_indices(d, degree)
    kept = np.sort(np.argsort(-np.nan_to_num(influence), kind="stable")[:count])
    few = fixed_degree_indices(count, degree)
    indices = np.zeros((few.shape[0], d), dtype=np.int64)
    indices[:, kept] = few
    return indices


def _multinomial(indices: IntArray, influence: FloatArray) -> FloatArray:
    """Multinomial probabilities (P,) of the multi-indices (P, d), all of one total degree."""
    from scipy.special import gammaln, xlogy

    known = np.nan_to_num(influence, nan=1.0)
    # no variable is ruled out
    shares = (known + 1e-3) / (known + 1e-3).sum()
    degree = indices.sum(axis=1)
    logs = (
        gammaln(degree + 1.0)
        - gammaln(indices + 1.0).sum(axis=1)
        + xlogy(indices, shares).sum(axis=1)
    )
    return np.asarray(np.exp(logs))


def _transfer(indices: IntArray, spread: float) -> tuple[IntArray, FloatArray]:
    """Multi-indices (P, d) and matrix (P, p) that express H(u / spread) in H(u)."""
    table = rescaled(int(indices.max(initial=0)), 1.0 / spread)
    entries: dict[tuple[int, ...], dict[int, float]] = defaultdict(dict)
    for column, index in enumerate(indices):
        check_time()
        terms: dict[tuple[int, ...], float] = {(): 1.0}
        for order in index:
            terms = {
                (*head, low): value * float(table[order, low])
                for head, value in terms.items()
                for low in range(int(order) % 2, int(order) + 1, 2)
            }
        for term, value in terms.items():
            entries[term][column] = value
    order = sorted(entries, key=lambda term: (sum(term), term))
    matrix = np.zeros((len(order), indices.shape[0]))
    for row, term in enumerate(order):
        for column, value in entries[term].items():
            matrix[row, column] = value
    return np.array(order, dtype=np.int64), matrix


def _ladder(variable: Any, degree: int) -> list[Any]:
    """Orthonormal Hermite polynomials of one chaospy variable."""
    steps: list[Any] = [1.0, variable]
    for k in range(1, degree):
        steps.append((variable * steps[k] - math.sqrt(k) * steps[k - 1]) / math.sqrt(k + 1))
    return steps
