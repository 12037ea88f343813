"""Questions beyond a failure probability: what it answers to, and how to design for it."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.analysis.derivatives_by_simulation import score_derivatives
    from uqfold.analysis.derivatives_by_surface import surface_derivatives
    from uqfold.analysis.fitted_surface import NoSurfaceError
    from uqfold.analysis.pf_derivatives import InputParameter, PfDerivative, PfDerivatives

__all__ = [
    "InputParameter",
    "NoSurfaceError",
    "PfDerivative",
    "PfDerivatives",
    "score_derivatives",
    "surface_derivatives",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "InputParameter": "uqfold.analysis.pf_derivatives",
        "NoSurfaceError": "uqfold.analysis.fitted_surface",
        "PfDerivative": "uqfold.analysis.pf_derivatives",
        "PfDerivatives": "uqfold.analysis.pf_derivatives",
        "score_derivatives": "uqfold.analysis.derivatives_by_simulation",
        "surface_derivatives": "uqfold.analysis.derivatives_by_surface",
    },
)
