"""Which kernel describes a surface: judged by how well it foretells each run from the others.

The Gaussian kernel learns smooth surfaces with few runs, but on one with kinks it is sure of
itself where it should not be; the Matern kernel needs more runs and errs less boldly. Both are
fitted, and the leave-one-out predictions tell.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.surrogates.kernels import Kernel
from uqfold.typing import FloatArray

# A kernel whose leave-one-out errors exceed the stated ones by more than this is overconfident.
_OVERCONFIDENT = 1.1


@dataclass
class KernelFits:
    """Fits growing sets of runs, one process per kernel, each from where it stood before.

    Attributes
    ----------
    kernels
        The kernels to choose from.
    noise
        Standard deviation of the noise; None learns it.
    trend
        Total degree of the polynomial trend.
    """

    kernels: tuple[Kernel, ...]
    noise: float | None = None
    trend: int = 1
    _known: dict[Kernel, GaussianProcess] = field(default_factory=dict)

    def fit(self, u: FloatArray, y: FloatArray) -> GaussianProcess:
        """Return the process that predicts left-out runs best; overconfident ones come last.

        Parameters
        ----------
        u, y
            All training points (n, d) in standard-normal space and finite responses (n,).
        """
        for kernel in self.kernels:
            self._known[kernel] = fit_gaussian_process(
                u, y, noise=self.noise, kernel=kernel, trend=self.trend,
                start=self._known.get(kernel),
            )  # fmt: skip
        return max(self._known.values(), key=_quality)


def _quality(process: GaussianProcess) -> tuple[bool, float]:
    left_out = process.leave_one_out()
    return left_out.ratio <= _OVERCONFIDENT, left_out.log_density
