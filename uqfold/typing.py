"""Array types used throughout: every number is float64, rows are samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
IntArray: TypeAlias = npt.NDArray[np.int64]
Model: TypeAlias = Callable[[FloatArray], npt.NDArray[Any]]
"""A response model: takes X (n, d), gives y (n,)."""
