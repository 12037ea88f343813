"""Styles of words on a terminal; those of figures have moved to `uqfold.plots.style`."""

from uqfold.plots.style import (
    BAND_COLOR,
    COLUMN_INCHES,
    FURTHER_STYLES,
    REFERENCE_LINE,
    MethodStyle,
    figure_settings,
    method_styles,
    shades,
)

__all__ = [
    "BAND_COLOR",
    "COLUMN_INCHES",
    "FURTHER_STYLES",
    "REFERENCE_LINE",
    "STATUS_STYLES",
    "MethodStyle",
    "figure_settings",
    "method_styles",
    "shades",
]

STATUS_STYLES = {
    "converged": "green",
    "unchecked": "",
    "budget_exhausted": "yellow",
    "doubtful": "yellow",
    "unsupported": "bright_black",
    "failed": "bold red",
}
"""Status -> style on a terminal."""
