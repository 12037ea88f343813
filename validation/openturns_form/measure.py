"""OpenTURNS' FORM called directly, and the same limit states through uqfold's interface.

The direct runs use OpenTURNS alone: its own distributions, a limit state that is a symbolic
function, its event and its algorithm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import openturns as ot

from uqfold.methods.openturns_form import OpenTURNSFORM
from uqfold.problems.base import Problem
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work

AGREEMENT = 1e-3
"""Largest difference of reliability indices; either search may stop within it."""


@dataclass(frozen=True)
class LimitState:
    """A limit state that fails for g <= 0: formula, inputs, and their copula."""

    name: str
    variables: tuple[str, ...]
    formula: str
    marginals: tuple[Any, ...]
    copula: Any = None

    def distribution(self, *, dependent: bool = True) -> Any:
        """Joint distribution of the inputs."""
        joint = (
            ot.JointDistribution(list(self.marginals))
            if self.copula is None or not dependent
            else ot.JointDistribution(list(self.marginals), self.copula)
        )
        joint.setDescription(self.variables)
        return joint

    def function(self) -> Any:
        """The limit state."""
        return ot.SymbolicFunction(list(self.variables), [self.formula])


def limit_states() -> list[LimitState]:
    """Linear, products, powers; normal, skewed, bounded and dependent inputs."""
    return [
        LimitState("sum of normals", ("a", "b"), "5 - a - 2*b",
                   (ot.Normal(1.0, 1.0), ot.Normal(0.5, 0.5))),
        LimitState("resistance and load", ("R", "S"), "R - S",
                   (ot.LogNormalMuSigma(7.0, 1.0).getDistribution(), ot.Gumbel(0.3, 3.0))),
        LimitState("beam", ("E", "F", "L", "I"), "20 - F*L^3/(3*E*I)",
                   (ot.Normal(3e4, 2e3), ot.LogNormalMuSigma(30.0, 4.0).getDistribution(),
                    ot.Uniform(250.0, 260.0), ot.Beta(2.5, 4.0, 310.0, 450.0)),
                   _beam_copula()),
        LimitState("parabola", ("u", "v"), "3 + 0.1*(u - v)^2 - (u + v)/sqrt(2)",
                   (ot.Normal(), ot.Normal())),
        LimitState("dependent lognormals", ("a", "b"), "8 - a*b",
                   (ot.LogNormal(0.0, 0.4, 0.0), ot.LogNormal(0.2, 0.3, 0.0)),
                   ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.6], [0.6, 1.0]]))),
    ]  # fmt: skip


def _beam_copula() -> Any:
    correlation = ot.CorrelationMatrix(4)
    correlation[2, 3] = -0.2
    return ot.NormalCopula(ot.NormalCopula.GetCorrelationFromSpearmanCorrelation(correlation))


def direct(state: LimitState) -> tuple[float, float]:
    """Reliability index and failure probability by OpenTURNS alone."""
    inputs = state.distribution()
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(state.function(), ot.RandomVector(inputs)),
        ot.LessOrEqual(),
        0.0,
    )
    solver = ot.AbdoRackwitz()
    solver.setMaximumIterationNumber(1_000)
    solver.setMaximumAbsoluteError(1e-8)
    solver.setMaximumConstraintError(1e-8)
    solver.setStartingPoint(inputs.getMean())
    algorithm = ot.FORM(solver, event)
    algorithm.run()
    result = algorithm.getResult()
    return result.getHasoferReliabilityIndex(), result.getEventProbability()


def through_uqfold(state: LimitState, fault: str | None) -> tuple[float, float, str, int]:
    """Reliability index, failure probability, status and runs by `openturns-form`."""
    formula = state.function()

    def g(x: FloatArray) -> FloatArray:
        values = np.array(formula(x))[:, 0]
        return -values if fault == "wrong sign" else values

    inputs = state.distribution(dependent=fault != "dependence forgotten")
    row = OpenTURNSFORM().estimate(Problem.from_limit_state(g, inputs))[0]
    return row.beta, row.pf, row.status, row.n_evals


def measure(work: Work) -> Measurement:
    """Run all limit states; the tiers do not differ."""
    rows, findings = [], []
    for state in limit_states():
        beta, pf = direct(state)
        ours, our_pf, status, runs = through_uqfold(state, work.fault)
        rows.append(
            {
                "limit state": state.name,
                "beta, OpenTURNS": beta,
                "beta, uqfold": ours,
                "pf, OpenTURNS": pf,
                "pf, uqfold": our_pf,
                "status": status,
                "model runs": runs,
            }
        )
        findings.append(Finding(f"{state.name}: difference of beta", abs(ours - beta), AGREEMENT))
    return Measurement(findings, [Table.of("FORM by both", rows)])
