"""OpenTURNS' FORM called directly, and the same limit states through uqfold's interface.

The direct runs use OpenTURNS alone: its own distributions, a limit state that is a symbolic
function, its event and its algorithm.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import openturns as ot

from uqfold.methods.openturns_form import OpenTURNSFORM
from uqfold.problems.base import Problem
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work

AGREEMENT = 1e-3
"""Largest difference of reliability indices; either search may stop within it."""


def beam_copula() -> Any:
    """Return the dependence of length and moment of inertia."""
    correlation = ot.CorrelationMatrix(4)
    correlation[2, 3] = -0.2
    return ot.NormalCopula(ot.NormalCopula.GetCorrelationFromSpearmanCorrelation(correlation))


LIMIT_STATES: dict[str, tuple[str, dict[str, Any], Any]] = {
    "sum of normals": (
        "5 - a - 2*b", {"a": ot.Normal(1.0, 1.0), "b": ot.Normal(0.5, 0.5)}, None,
    ),
    "resistance and load": (
        "R - S",
        {"R": ot.LogNormalMuSigma(7.0, 1.0).getDistribution(), "S": ot.Gumbel(0.3, 3.0)},
        None,
    ),
    "beam": (
        "20 - F*L^3/(3*E*I)",
        {
            "E": ot.Normal(3e4, 2e3),
            "F": ot.LogNormalMuSigma(30.0, 4.0).getDistribution(),
            "L": ot.Uniform(250.0, 260.0),
            "I": ot.Beta(2.5, 4.0, 310.0, 450.0),
        },
        beam_copula(),
    ),
    "parabola": (
        "3 + 0.1*(u - v)^2 - (u + v)/sqrt(2)", {"u": ot.Normal(), "v": ot.Normal()}, None,
    ),
    "dependent lognormals": (
        "8 - a*b",
        {"a": ot.LogNormal(0.0, 0.4, 0.0), "b": ot.LogNormal(0.2, 0.3, 0.0)},
        ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.6], [0.6, 1.0]])),
    ),
}  # fmt: skip
"""Name -> formula, which fails for g <= 0, inputs, and their copula (None: independent)."""


def direct(g: Any, inputs: Any) -> tuple[float, float]:
    """Reliability index and failure probability by OpenTURNS alone."""
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(g, ot.RandomVector(inputs)), ot.LessOrEqual(), 0.0
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


def measure(work: Work) -> Measurement:
    """Run all limit states; the tiers do not differ."""
    sign = -1.0 if work.fault == "wrong sign" else 1.0
    rows, findings = [], []
    for name, (formula, marginals, copula) in LIMIT_STATES.items():
        function = ot.SymbolicFunction([*marginals], [formula])
        independent = ot.IndependentCopula(len(marginals))
        joint = ot.JointDistribution([*marginals.values()], copula or independent)
        joint.setDescription([*marginals])
        beta, pf = direct(function, joint)

        def g(x: FloatArray, function: Any = function) -> FloatArray:
            return sign * np.array(function(x))[:, 0]

        if work.fault == "dependence forgotten":
            joint.setCopula(independent)
        ours = OpenTURNSFORM().estimate(Problem.from_limit_state(g, joint))[0]
        rows.append(
            {
                "limit state": name,
                "beta, OpenTURNS": beta,
                "beta, uqfold": ours.beta,
                "pf, OpenTURNS": pf,
                "pf, uqfold": ours.pf,
                "status": ours.status,
                "model runs": ours.n_evals,
            }
        )
        difference = abs(ours.beta - beta)
        findings.append(Finding(f"{name}: difference of beta", difference, AGREEMENT))
    return Measurement(findings, [Table.of("FORM by both", rows)])
