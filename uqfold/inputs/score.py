"""Score functions: how the density of the inputs answers to their means and standard deviations.

The score of a parameter is the derivative of the log-density by it. Its mean is zero, and the
expectation of anything times the score is the derivative of the expectation.

References
----------
Rubinstein R. Y., Shapiro A. Discrete Event Systems: Sensitivity Analysis and Stochastic
Optimization by the Score Function Method. Wiley, 1993.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from uqfold.inputs.joint import JointInputs
from uqfold.typing import FloatArray

Moment: TypeAlias = Literal["mean", "standard deviation"]

_STEP = 1e-4
"""Half width of the central difference of the log-density, in standard deviations."""


@dataclass(frozen=True, eq=False)
class ScoreFunction:
    """Score of one parameter, built by `score_function`.

    Attributes
    ----------
    above, below
        The inputs with the parameter moved by the step up and down.
    column
        Which input is moved.
    width
        Distance of the two parameter values, in the unit of the input.
    """

    above: JointInputs
    below: JointInputs
    column: int
    width: float

    def __call__(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Scores at rows X.

        Parameters
        ----------
        x
            Inputs (n, d), shared ones first.

        Returns
        -------
        of_shared, of_individual
            Each (n,): the part of the density of the shared inputs, and that of the density of
            the individual inputs given the shared ones.
        """
        n_shared = self.above.n_shared
        if self.above.independent:
            column = x[:, [self.column]]
            score = self._difference(
                self.above.marginals[self.column], self.below.marginals[self.column], column
            )
            nothing = np.zeros(len(x))
            return (score, nothing) if self.column < n_shared else (nothing, score)
        joint = self._difference(self.above.distribution, self.below.distribution, x)
        if n_shared == 0:
            return np.zeros(len(x)), joint
        if n_shared == self.above.dimension:
            return joint, np.zeros(len(x))
        columns = list(range(n_shared))
        shared = self._difference(
            self.above.distribution.getMarginal(columns),
            self.below.distribution.getMarginal(columns),
            x[:, :n_shared],
        )
        return shared, joint - shared

    def _difference(self, above: Any, below: Any, x: FloatArray) -> FloatArray:
        logs = [
            np.array(part.computeLogPDF(x), dtype=np.float64).ravel() for part in (above, below)
        ]
        return np.asarray((logs[0] - logs[1]) / self.width)


def score_function(inputs: JointInputs, name: str, moment: Moment) -> ScoreFunction:
    """Give the score of the mean or the standard deviation of one input.

    What a change of the moment does to the distribution: see `JointInputs.with_moments`.

    Raises
    ------
    ValueError
        If there is no such input, it has no such moments, or its bounds move with the parameter:
        then densities of both values do not cover each other, and there is no score.
    """
    above, below = (moved_inputs(inputs, name, moment, steps) for steps in (_STEP, -_STEP))
    column = inputs.names.index(name)
    for bound, other in zip(above.bounds, below.bounds, strict=True):
        if _distance(bound[column], other[column]) > 1e-9 * inputs.standard_deviations[column]:
            raise ValueError(
                f"a bound of {name} = {inputs.marginals[column]} moves with its {moment}, so there "
                "is no score function; give a distribution whose bounds do not move"
            )
    width = 2.0 * _STEP * float(inputs.standard_deviations[column])
    return ScoreFunction(above, below, column, width)


def moved_inputs(inputs: JointInputs, name: str, moment: Moment, steps: float) -> JointInputs:
    """Give the inputs with one moment of one input moved by so many of its standard deviations.

    Raises
    ------
    ValueError
        If there is no such input, or its distribution cannot have that moment.
    """
    if name not in inputs.names:
        raise ValueError(f"{name!r} is not one of the inputs {list(inputs.names)}")
    column = inputs.names.index(name)
    std = float(inputs.standard_deviations[column])
    if moment == "mean":
        return inputs.with_moments(means={name: float(inputs.means[column]) + steps * std})
    return inputs.with_moments(standard_deviations={name: (1.0 + steps) * std})


def _distance(bound: float, other: float) -> float:
    return 0.0 if bound == other else abs(bound - other)
