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
from typing import Literal, TypeAlias

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
        if self.above.independent:
            values = x[:, self.column]
            logs = (part.columns[self.column].log_pdf(values) for part in (self.above, self.below))
            score, nothing = self._difference(*logs), np.zeros(len(x))
            return (score, nothing) if self.column < self.above.n_shared else (nothing, score)
        above, below = self.above.log_density(x), self.below.log_density(x)
        return self._difference(above[0], below[0]), self._difference(above[1], below[1])

    def _difference(self, above: FloatArray, below: FloatArray) -> FloatArray:
        return np.asarray((above - below) / self.width)


def score_function(inputs: JointInputs, name: str, moment: Moment) -> ScoreFunction:
    """Return the score of the mean or the standard deviation of one input.

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
                f"a bound of {name} = {inputs.columns[column]} moves with its {moment}, so there "
                "is not a score function; give a distribution whose bounds do not move"
            )
    width = 2.0 * _STEP * float(inputs.standard_deviations[column])
    return ScoreFunction(above, below, column, width)


def moved_inputs(inputs: JointInputs, name: str, moment: Moment, steps: float) -> JointInputs:
    """Return the inputs with one moment of one input moved by so many of its standard deviations.

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
