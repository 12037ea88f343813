"""Figures and axes that a notebook shows by themselves, without pyplot and its global state."""

from __future__ import annotations

import io
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uqfold.plots.saving import write

_PIXELS_PER_INCH = 96


class ShownFigure(Figure):
    """A figure that a notebook shows where it is the last value of a cell."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        return _png(self)


class ShownAxes(Axes):
    """The axes of a figure of one panel, which a notebook shows as that figure."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        return _png(self.figure)


def _png(figure: Any) -> tuple[bytes, dict[str, int]]:
    """Return a figure for a notebook: a PNG, and the size at which it is shown."""
    stream = io.BytesIO()
    write(figure, stream, "png")
    width, height = (round(inches * _PIXELS_PER_INCH) for inches in figure.get_size_inches())
    return stream.getvalue(), {"width": width, "height": height}
