"""Gradients that a model offers: asked for row by row, and checked for what can be seen at once."""

from __future__ import annotations

import numpy as np

from uqfold.checks import raised
from uqfold.evaluation.errors import GradientError
from uqfold.problems.responses import numbers_in
from uqfold.typing import FloatArray, Model


def gradients_at(gradient: Model, x: FloatArray) -> FloatArray:
    """Return what a gradient function says at rows; NaN where an entry is masked or no number.

    Parameters
    ----------
    gradient
        Takes inputs (n, d), returns derivatives (n, d) of the response by each of them.
    x
        Inputs (n, d).

    Raises
    ------
    GradientError
        If it raises (`sys.exit()` included), or returns something of another shape or no numbers.
    """
    try:
        with np.errstate(all="ignore"):
            found = numbers_in(gradient(x.copy()))
    except (Exception, SystemExit) as error:
        raise GradientError(f"the gradient raised {raised(error)}") from error
    if found.shape != x.shape:
        raise GradientError(f"the gradient has shape {found.shape} for inputs of {x.shape}")
    return found
