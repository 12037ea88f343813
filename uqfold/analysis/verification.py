"""Verification of a design: the real model is simulated at the value that was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from uqfold.analysis.design import Design
from uqfold.checks import instance, listed, or_none, real, refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import checked_budget, checked_evaluator
from uqfold.methods.base import ReliabilityMethod, checked_method
from uqfold.methods.monte_carlo import MonteCarlo
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.methods.seeding import RandomSource, reduced_seed

Meets: TypeAlias = Literal["yes", "no", "undecided"]


@dataclass(frozen=True)
class Verification:
    """Simulation of the real model at a design value.

    Attributes
    ----------
    value
        The value.
    pf, std_error, ci_low, ci_high
        pf by simulation, its standard error and interval of 95 %.
    meets
        Whether the target is met: ``yes`` and ``no`` where the whole interval lies on one side.
    agrees
        Whether the interval meets the one that the design states at this value.
    method, n_evals, seconds, seed
        How it was simulated, and the cost.
    """

    value: float
    pf: float
    std_error: float
    ci_low: float
    ci_high: float
    meets: Meets
    agrees: bool
    method: str
    n_evals: int
    seconds: float
    seed: int


def verify(
    design: Design,
    method: ReliabilityMethod | None = None,
    value: float | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> Verification:
    """Simulate the real model at a design value.

    Parameters
    ----------
    design
        A design with a value.
    method
        A simulation on the real model; None: `MonteCarlo` with 100,000 systems.
    value
        Where; None: at the design's best value. `Design.safe` is the other place of interest.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Raises
    ------
    ValueError
        If there is no value to verify.
    RuntimeError
        If the simulation gives no answer.
    """
    instance("design", design, Design, "give what design_threshold or design_input returned")
    at = or_none("value", value, real)
    places = [(design, design.value if at is None else at)]
    return verify_all(places, method, max_evals=max_evals, rng=rng, evaluator=evaluator)[0]


def verify_all(
    places: Sequence[tuple[Design, float]],
    method: ReliabilityMethod | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> list[Verification]:
    """Simulate the real model at several design values; see `verify`.

    Designs of thresholds for the same problem share one simulation.
    """
    chosen = checked_method(method) or MonteCarlo(systems=100_000)
    checked_budget(max_evals)
    checked_evaluator(evaluator)
    seed = reduced_seed(rng)
    placed = []
    for i, pair in enumerate(listed("places", places)):
        if len(listed(f"places[{i}]", pair)) != 2:
            raise refused(f"places[{i}]", pair, "give a Design and a value")
        design, value = pair
        instance(f"places[{i}][0]", design, Design, "give a Design")
        if value is not design.value:  # which is NaN in a design without one
            value = real(f"places[{i}][1]", value)
        if not math.isfinite(value):
            raise ValueError(f"{design.parameter}: no value to verify ({design.status})")
        placed.append(design.place(value))
    rows: dict[int, CriterionResult] = {}
    for problem in {id(one): one for one, _ in placed}.values():
        mine = [i for i, (one, _) in enumerate(placed) if one is problem]
        result = chosen.estimate(
            problem, [placed[i][1] for i in mine],
            max_evals=max_evals, rng=seed, evaluator=evaluator,
        )  # fmt: skip
        rows.update(zip(mine, result, strict=True))
    return [_verified(*places[i], rows[i]) for i in range(len(places))]


def _verified(design: Design, value: float, row: CriterionResult) -> Verification:
    if row.status in NO_ANSWER:
        raise RuntimeError(f"{design.parameter} = {value:g}: {row.message}")
    meets: Meets = "undecided"
    if row.ci_high <= design.target_pf:
        meets = "yes"
    elif row.ci_low > design.target_pf:
        meets = "no"
    low, high = design.scan.interval(value)
    return Verification(
        value=value,
        pf=row.pf,
        std_error=row.std_error,
        ci_low=row.ci_low,
        ci_high=row.ci_high,
        meets=meets,
        agrees=bool(row.ci_low <= high and low <= row.ci_high),
        method=row.method,
        n_evals=row.n_evals,
        seconds=row.seconds,
        seed=row.seed,
    )
