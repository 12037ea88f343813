"""Figures of comparisons, results and analyses: matplotlib, and nothing else draws.

Functions take a frame, a result or the table of an analysis, and return matplotlib axes, or a
figure where several panels are the point. Nothing here runs a model or knows a window.
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.plots.comparison_figure import comparison
    from uqfold.plots.error_figure import error_against_evaluations
    from uqfold.plots.saving import save
    from uqfold.plots.style import method_styles
    from uqfold.plots.telling import values

__all__ = ["comparison", "error_against_evaluations", "method_styles", "save", "values"]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "comparison": "uqfold.plots.comparison_figure",
        "error_against_evaluations": "uqfold.plots.error_figure",
        "method_styles": "uqfold.plots.style",
        "save": "uqfold.plots.saving",
        "values": "uqfold.plots.telling",
    },
)
