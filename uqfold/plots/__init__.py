"""Figures of comparisons, results and analyses: matplotlib, and nothing else draws.

Functions take a frame, a result or the table of an analysis, and return matplotlib axes, or a
figure where several panels are the point. Nothing here runs a model or knows a window.
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.plots.budgets import benchmark, benchmark_panels
    from uqfold.plots.comparison_figure import comparison
    from uqfold.plots.curves import reliability, reliability_panels
    from uqfold.plots.dependence import independence_panels
    from uqfold.plots.designs import design
    from uqfold.plots.error_figure import error_against_evaluations
    from uqfold.plots.saving import save
    from uqfold.plots.sensitivity import derivatives, derivatives_over_threshold, sobol
    from uqfold.plots.style import figure_settings, method_styles
    from uqfold.plots.telling import values

__all__ = [
    "benchmark",
    "benchmark_panels",
    "comparison",
    "derivatives",
    "derivatives_over_threshold",
    "design",
    "error_against_evaluations",
    "figure_settings",
    "independence_panels",
    "method_styles",
    "reliability",
    "reliability_panels",
    "save",
    "sobol",
    "values",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "comparison": "uqfold.plots.comparison_figure",
        "error_against_evaluations": "uqfold.plots.error_figure",
        "benchmark": "uqfold.plots.budgets",
        "benchmark_panels": "uqfold.plots.budgets",
        "derivatives": "uqfold.plots.sensitivity",
        "derivatives_over_threshold": "uqfold.plots.sensitivity",
        "design": "uqfold.plots.designs",
        "independence_panels": "uqfold.plots.dependence",
        "reliability": "uqfold.plots.curves",
        "reliability_panels": "uqfold.plots.curves",
        "sobol": "uqfold.plots.sensitivity",
        "figure_settings": "uqfold.plots.style",
        "method_styles": "uqfold.plots.style",
        "save": "uqfold.plots.saving",
        "values": "uqfold.plots.telling",
    },
)
