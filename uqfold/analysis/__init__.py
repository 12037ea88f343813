"""Questions beyond a failure probability: what it answers to, and how to design for it."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.analysis.conditional_indices import conditional_sobol
    from uqfold.analysis.derivatives_by_simulation import score_derivatives
    from uqfold.analysis.derivatives_by_surface import surface_derivatives
    from uqfold.analysis.design import Design, Scan
    from uqfold.analysis.design_table import designs_to_frame
    from uqfold.analysis.designed_input import design_input
    from uqfold.analysis.designed_threshold import design_threshold, design_thresholds
    from uqfold.analysis.fitted_surface import NoSurfaceError
    from uqfold.analysis.independent_units import independence
    from uqfold.analysis.paired import PairedDifference, PairedDifferences, paired_differences
    from uqfold.analysis.pf_derivatives import InputParameter, PfDerivative, PfDerivatives
    from uqfold.analysis.sobol import SobolIndex, SobolIndices, chaos_sobol, pick_freeze
    from uqfold.analysis.verification import Verification, verify, verify_all

__all__ = [
    "Design",
    "InputParameter",
    "NoSurfaceError",
    "PairedDifference",
    "PairedDifferences",
    "PfDerivative",
    "PfDerivatives",
    "Scan",
    "SobolIndex",
    "SobolIndices",
    "Verification",
    "chaos_sobol",
    "conditional_sobol",
    "design_input",
    "design_threshold",
    "design_thresholds",
    "designs_to_frame",
    "independence",
    "paired_differences",
    "pick_freeze",
    "score_derivatives",
    "surface_derivatives",
    "verify",
    "verify_all",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Design": "uqfold.analysis.design",
        "Scan": "uqfold.analysis.design",
        "Verification": "uqfold.analysis.verification",
        "verify": "uqfold.analysis.verification",
        "verify_all": "uqfold.analysis.verification",
        "designs_to_frame": "uqfold.analysis.design_table",
        "design_input": "uqfold.analysis.designed_input",
        "design_threshold": "uqfold.analysis.designed_threshold",
        "design_thresholds": "uqfold.analysis.designed_threshold",
        "InputParameter": "uqfold.analysis.pf_derivatives",
        "NoSurfaceError": "uqfold.analysis.fitted_surface",
        "independence": "uqfold.analysis.independent_units",
        "PairedDifference": "uqfold.analysis.paired",
        "PairedDifferences": "uqfold.analysis.paired",
        "paired_differences": "uqfold.analysis.paired",
        "PfDerivative": "uqfold.analysis.pf_derivatives",
        "PfDerivatives": "uqfold.analysis.pf_derivatives",
        "SobolIndex": "uqfold.analysis.sobol",
        "SobolIndices": "uqfold.analysis.sobol",
        "chaos_sobol": "uqfold.analysis.sobol",
        "conditional_sobol": "uqfold.analysis.conditional_indices",
        "pick_freeze": "uqfold.analysis.sobol",
        "score_derivatives": "uqfold.analysis.derivatives_by_simulation",
        "surface_derivatives": "uqfold.analysis.derivatives_by_surface",
    },
)
