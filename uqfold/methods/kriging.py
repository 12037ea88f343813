"""Kriging: one Gaussian-process surface over all inputs, and every answer from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Literal, TypeAlias, get_args

from uqfold.checks import choice, flag, keep, or_none, real, refused, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.arguments import certain_under_tau
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import STREAMS, Learned, grown
from uqfold.methods.partner_sample import without_partner
from uqfold.methods.partner_trend import PartnerRuns, SurfaceOfKind, with_partner
from uqfold.methods.response_surface import ErrorParts, surface_estimates
from uqfold.methods.result import TARGET_COV
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.task import Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_surfaces import KRIGING
from uqfold.methods.warped import WarpedSurface, transformed, warp_for
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.curved_directions import without_products
from uqfold.surrogates.designs import checked_spread
from uqfold.surrogates.gaussian_process import (
    GaussianProcess,
    checked_noise,
    fit_gaussian_process,
)
from uqfold.surrogates.kernels import Kernel, KernelChoice
from uqfold.surrogates.partner_surface import PartnerSurface
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.surrogates.warping import Warp
from uqfold.system.surface_rule import MAX_POINTS
from uqfold.typing import FloatArray, IntArray

Trend: TypeAlias = Literal["best", "constant", "linear", "quadratic", "pce"]

Tried: TypeAlias = tuple[int, Trend, Kernel]

MAX_RUNS = 2_000
"""Ceiling on the training size: a fit costs its cube."""
_DEGREES = {"constant": 0, "linear": 1, "quadratic": 2}
# Evaluations of the correlation function that an integration over the surface may cost.
_MOST_CORRELATIONS = 80_000_000


@dataclass(frozen=True, eq=False)
class KrigingDetails:
    """The surface of a `Kriging` run.

    Attributes
    ----------
    surface
        The Gaussian process, with training points, hyperparameters, `mean` and `std`; where it is
        one of transformed responses, that process and the transformation; with a partner, its
        process and that of the difference.
    cross_validation
        Leave-one-out residuals, of transformed responses in that case.
    relative_error
        Their root mean square, as a share of the standard deviation of these responses.
    errors
        Where the stated errors come from.
    of_other_kinds
        The same for the surfaces of other kinds of units, in the order in which they occur.
    partner_evals, partner_failed
        Runs of the partners of all kinds, and how many of them failed. They do not count as
        evaluations.
    gain
        By what the partner has divided the mean square of these residuals; NaN where it was not
        used.
    """

    surface: GaussianProcess | WarpedSurface | PartnerSurface
    cross_validation: LeaveOneOut
    relative_error: float
    errors: ErrorParts
    of_other_kinds: tuple[KrigingDetails, ...] = ()
    partner_evals: int = 0
    partner_failed: int = 0
    gain: float = math.nan


@dataclass(frozen=True)
class Kriging(SequentialMethod):
    """Kriging on a space-filling design, integrated over without sampling.

    A Gaussian process with a polynomial trend is fitted to the responses at a Sobol' design in
    standard-normal space, spread wider than the inputs so that it reaches into the tails; units of
    several kinds, which have models or inputs of their own, have one each. The
    conditional distribution of the response given the shared inputs, and from it every criterion
    with its missions and tau, follow by integration over the surface. Surfaces drawn from the
    posterior give the stated error.

    Attributes
    ----------
    runs
        Evaluations, those of all kinds of units together; fewer if the budget allows fewer. More
        than 2,000 are `unsupported`. None: for each kind 100, or five for each input if that is
        more; where a budget is given that allows more, they are doubled as long as the stated error
        is above its target and this may help, and six more at each of up to three thresholds check
        the answers.
    trend
        ``constant``, ``linear`` or ``quadratic`` polynomial, or ``pce``: the polynomials that a
        sparse polynomial chaos expansion picks; ``best``: the better of the last two.
    kernel
        ``gaussian`` for smooth models, ``matern52`` for rougher ones; ``best``: the better one.
        What is better predicts left-out runs with the higher density, from which a trend that
        was picked with the same responses loses the optimism of that choice; the distance between
        the answers of the best and the others is a part of the stated error.
    noise
        Standard deviation of what the model does at the smallest scale, in the unit of the
        response; None learns it. It counts as a part of the response.
    spread
        Standard deviation of the design points, in standard deviations of the inputs. Where the
        model is noisy, what a run says about the tail grows with its distance from the centre.
    target_cov
        Stated error, relative to pf or to the reliability, whichever is smaller, that is aimed for:
        a row that states more is ``doubtful``.
    warp
        Whether responses that span decades may be transformed first, by a power or a logarithm that
        is found from the runs, if this predicts left-out runs better; `noise`, units that differ
        and a synchronization threshold keep them as they are.
    partner_runs
        Runs of the problem's `low_fidelity` for each run of the model: a surface of the partner is
        fitted to them, and the model's runs only have to tell the difference. 0: none.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    name: ClassVar[str] = "kriging"
    title: ClassVar[str] = "Kriging"
    theory: ClassVar[Theory] = KRIGING
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    runs: int | None = None
    trend: Trend = "best"
    kernel: KernelChoice = "best"
    noise: float | None = None
    spread: float = 2.0
    target_cov: float = TARGET_COV
    warp: bool = True
    partner_runs: int = 0

    def __post_init__(self) -> None:
        keep(self, "runs", or_none, whole, at_least=1)
        keep(self, "trend", choice, get_args(Trend))
        keep(self, "kernel", choice, get_args(KernelChoice))
        keep(self, "noise", or_none, checked_noise)
        keep(self, "spread", checked_spread)
        keep(self, "target_cov", real, above=0.0)
        keep(self, "warp", flag)
        keep(self, "partner_runs", whole, at_least=0)
        if self.partner_runs and self.noise is not None:
            remedy = "it is that of the model alone: leave it out where a partner is asked"
            raise refused("noise", self.noise, remedy)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: they scramble the design."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Refuse more training runs than a fit can bear."""
        if self.runs is not None and self.runs > MAX_RUNS:
            return f"runs = {self.runs}: {self.name} takes at most {MAX_RUNS} training runs"
        reason = super().supports(problem, criterion) or certain_under_tau(problem, criterion)
        if reason is None and self.partner_runs > 0:
            return without_partner(f"partner_runs = {self.partner_runs}", problem)
        return reason

    def _steps(self, task: Task) -> Steps:
        partner = None
        if self.partner_runs > 0:
            partner = PartnerRuns(task, self.partner_runs, self.spread, MAX_RUNS)
        answered = partial(self._answered, task, {}, partner)
        found = yield from grown(task, self.runs, MAX_RUNS, self.spread, answered)
        return found if partner is None else partner.noted(found)

    def _answered(
        self,
        task: Task,
        known: dict[Tried, GaussianProcess],
        partner: PartnerRuns | None,
        runs: Sequence[DesignRuns],
    ) -> Learned:
        kinds = [self._kind(task, known, kind, own) for kind, own in enumerate(runs)]
        gains = [math.nan] * len(kinds)
        if partner is not None:
            partner.note = ""
            for kind, alone in enumerate(kinds):
                fit = partial(self._fitted, task, {}, kind)
                kinds[kind], gains[kind] = with_partner(task, partner, kind, alone, fit)
        warp = warp_for(task, runs[0]) if self.warp and self.noise is None else None
        if warp is not None:
            asked, seen = transformed(task, runs[0], warp)
            warped = self._kind(task, {}, 0, seen)
            # in the same unit: the mean logarithm of the transformation's slope is 0
            if warped[1].validated.log_density > kinds[0][1].validated.log_density:
                task, kinds, gains = asked, [warped], [math.nan]
            else:
                warp = None
        largest = max(surface.size for surface, _ in kinds)
        fitted = [fitted for _, fitted in kinds]
        found = surface_estimates(
            task, fitted, task.generator(1),
            target_cov=self.target_cov,
            max_points=min(MAX_POINTS, _MOST_CORRELATIONS // largest),
            stated_noise=self.noise,
        )  # fmt: skip
        return Learned(task, fitted, found, partial(_details, kinds, gains, partner, warp), warp)

    def _kind(
        self, task: Task, known: dict[Tried, GaussianProcess], kind: int, runs: DesignRuns
    ) -> tuple[SurfaceOfKind, FittedKind]:
        """Fit the surface of one kind of units."""
        fits, stopped = task.summed_up(partial(self._fitted, task, known, kind, runs))
        surface, *others = fits
        made = replace(runs, stopped=stopped) if stopped else runs
        rivals = [Rival.by_prediction(surface, other) for other in others]
        return surface, FittedKind(surface, made, surface.noise_std, rivals)

    def _fitted(
        self,
        task: Task,
        known: dict[Tried, GaussianProcess],
        kind: int,
        runs: DesignRuns,
        stopped: str,
    ) -> tuple[list[GaussianProcess], str]:
        """SurfaceOfKind of one kind with the trends and kernels that are tried, the best one first.

        Those `known` from fewer runs are where the search for their hyperparameters starts. When
        the time is over, the quickest alone, and why there are no more.
        """
        u, y = runs.u[runs.finite], runs.y[runs.finite]
        names: tuple[Trend, ...]
        names = ("quadratic", "pce") if self.trend == "best" else (self.trend,)
        kernels: tuple[Kernel, ...]
        kernels = ("gaussian", "matern52") if self.kernel == "best" else (self.kernel,)
        planned = len(names) * len(kernels)
        if stopped := stopped or runs.stopped:
            names, kernels = names[:1], kernels[:1]
            if planned > 1:
                stopped = f"1 of {planned} surfaces fitted; {stopped}"
        found: list[tuple[float, GaussianProcess]] = []
        try:
            for name in names:
                trend, rotation, n_picked = _trend(name, u, y)
                for kernel in kernels:
                    fit = fit_gaussian_process(
                        u, y, noise=self.noise, trend=trend, kernel=kernel,
                        rng=task.generator(2 + kind * STREAMS),
                        start=known.get((kind, name, kernel)), rotation=rotation,
                    )  # fmt: skip
                    known[kind, name, kernel] = fit
                    # what is picked with all responses foretells those left out better than new
                    # ones: each counts as one parameter fitted, as in Akaike's criterion
                    optimism = n_picked / y.size
                    found.append((fit.leave_one_out().log_density - optimism, fit))
        except TimeLimitError as error:
            if not found:
                raise
            stopped = f"{len(found)} of {planned} surfaces fitted; {error}"
        found.sort(key=lambda pair: pair[0], reverse=True)
        return [fit for _, fit in found], stopped


def _details(
    kinds: Sequence[tuple[SurfaceOfKind, FittedKind]],
    gains: Sequence[float],
    partner: PartnerRuns | None,
    warp: Warp | None,
    errors: ErrorParts,
) -> KrigingDetails:
    details = []
    evals, failed = (0, 0) if partner is None else (partner.evals, partner.failed)
    for (surface, fitted), gain in zip(kinds, gains, strict=True):
        scatter, validated = float(surface.y.std()), fitted.validated
        relative = validated.rms / scatter if scatter > 0.0 else 0.0
        shown = surface if warp is None else WarpedSurface(surface, warp)
        found = KrigingDetails(shown, validated, relative, errors)
        details.append(replace(found, partner_evals=evals, partner_failed=failed, gain=gain))
    return replace(details[0], of_other_kinds=tuple(details[1:]))


def _trend(
    name: Trend, u: FloatArray, y: FloatArray
) -> tuple[int | IntArray, FloatArray | None, int]:
    """Degree or polynomials of a trend, the directions they have, and how much was picked."""
    if name != "pce":
        return _DEGREES[name], None, 0
    expansion = fit_polynomial_chaos(u, y, directions=True)
    n_picked = expansion.indices.shape[0]
    if expansion.rotation is None:
        return expansion.indices, None, n_picked
    return without_products(expansion.indices), expansion.rotation, n_picked
