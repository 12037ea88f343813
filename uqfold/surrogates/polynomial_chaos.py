"""Polynomial chaos: Hermite expansions of a response, fitted by regression.

The response is expanded in orthonormal Hermite polynomials of the standard-normal variables of
the Rosenblatt transformation. Which polynomials are kept is decided by the corrected
leave-one-out error: all up to some total degree, or the leading ones of a least-angle path
through many (`uqfold.surrogates.selection`).

References
----------
Blatman G., Sudret B. Adaptive sparse polynomial chaos expansion based on least angle regression.
J. Comput. Phys. 230 (2011) 2345-2367.
Sudret B. Global sensitivity analysis using polynomial chaos expansions. Reliab. Eng. Syst. Saf.
93 (2008) 964-979.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.surrogates.centring import centre_of
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.hermite import fixed_degree_indices, hermite_basis, rescaled
from uqfold.surrogates.random_field import RandomField, random_field
from uqfold.surrogates.selection import Regression, select_basis
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

_CHUNK = 8192
_FEATURES = 256
# Most polynomials of the next degree that stand for what was left out, and from how many.
_OMITTED, _MOST_OMITTED = 200, 100_000


@dataclass(frozen=True)
class VarianceShares:
    """Shares of the response's variance, each (d,): by an input alone, and with interactions."""

    main: FloatArray
    total: FloatArray


@dataclass(frozen=True, eq=False)
class PolynomialChaosExpansion:
    """Expansion of a response in orthonormal Hermite polynomials.

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
    """

    indices: IntArray
    coefficients: FloatArray
    residual_std: float
    regression: Regression
    transfer: FloatArray
    spread: float

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
        return evaluate(u, self.indices, self.coefficients[:, None])[:, 0]

    def leave_one_out(self) -> LeaveOneOut:
        """Prediction of every response from all others, basis kept."""
        fit = self.regression
        std = self.residual_std / np.sqrt(1.0 - fit.leverage)
        return LeaveOneOut(fit.residuals / (1.0 - fit.leverage), std)

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
        influence = self.sobol_indices().total
        omitted = _next_degree(influence, self.degree + 1)
        shares = _multinomial(omitted, influence)
        kept = np.argsort(-shares, kind="stable")[:_OMITTED]
        error = self.leave_one_out().rms
        size = error * np.sqrt(shares[kept] / shares[kept].sum())
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
        """Sobol' indices of all inputs; NaN for a response that does not vary."""
        share = self.coefficients**2 / (self.variance or math.nan)
        active = self.indices > 0
        alone = active & (active.sum(axis=1) == 1)[:, None]
        return VarianceShares(main=share @ alone, total=share @ active)

    def to_chaospy(self, names: Sequence[str] | None = None) -> Any:
        """Return the expansion as a chaospy polynomial of independent standard-normal variables.

        Parameters
        ----------
        names
            Names of the variables; by default chaospy's own.
        """
        import chaospy

        d = self.indices.shape[1]
        variables = chaospy.variable(d) if names is None else chaospy.symbols(list(names))
        variables = [variables] if d == 1 else list(variables)
        degree = self.indices.max(initial=0)
        ladders = [_ladder(variable, int(degree)) for variable in variables]
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
        Multi-indices (Q, d) of further polynomials of u / spread, and their coefficients (Q, R).
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
        values = evaluate(u, self.expansion.indices, self.coefficients)
        values += evaluate(u / self.expansion.spread, self.omitted, self.amplitudes)
        return values.T + self.field(u)


def evaluate(u: FloatArray, indices: IntArray, coefficients: FloatArray) -> FloatArray:
    """Values (m, R) of R expansions with coefficients (P, R) at u (m, d)."""
    out = np.empty((u.shape[0], coefficients.shape[1]))
    for start in range(0, u.shape[0], _CHUNK):
        check_time()
        rows = slice(start, start + _CHUNK)
        out[rows] = hermite_basis(u[rows], indices) @ coefficients
    return out


@one_blas_thread()
def fit_polynomial_chaos(
    u: FloatArray,
    y: FloatArray,
    *,
    sparse: bool = True,
    max_degree: int = 10,
    max_orders: IntArray | None = None,
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
    # Hermite polynomials of u / spread are about orthogonal over the design
    spread = float(np.sqrt(np.mean(u**2))) or 1.0
    centre = centre_of(y)
    found = select_basis(
        u / spread, y - centre, sparse=sparse, max_degree=max_degree, max_orders=max_orders
    )
    indices, transfer = _transfer(found.indices, spread)
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
    )


@one_blas_thread()
def fit_basis(
    u: FloatArray, y: FloatArray, indices: IntArray
) -> Callable[[FloatArray], FloatArray]:
    """Fit the polynomials with the given multi-indices (P, d), the constant among them."""
    centre = centre_of(y)
    found = np.linalg.lstsq(hermite_basis(u, indices), y - centre, rcond=None)[0]
    coefficients = np.asarray(found, dtype=float)

    def mean(points: FloatArray) -> FloatArray:
        return evaluate(points, indices, coefficients[:, None])[:, 0] + centre

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
