"""A chart as data: axes, series of points, bands and lines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

Scale: TypeAlias = Literal["linear", "log"]
DASHED = "--"
"""Marker of a key that stands for a dashed line."""
Side: TypeAlias = Literal["x", "y"]


@dataclass(frozen=True)
class Key:
    """Something that can be switched on and off in a page: a method, a criterion, a curve.

    Attributes
    ----------
    name
        What it is called in switches; the same name is switched everywhere in the page.
    label
        What readers see.
    color
        Six-digit hexadecimal colour, or empty for none.
    marker
        A marker of matplotlib, one of ``o s ^ v < > D d P X p h H 8 *``; or `DASHED`; empty for
        none.
    """

    name: str
    label: str
    color: str = ""
    marker: str = ""


@dataclass(frozen=True)
class Axis:
    """An axis.

    Attributes
    ----------
    name
        What it shows, with its unit.
    scale
        ``linear`` or ``log``.
    categories
        Names of the places 0, 1, 2, ... instead of numbers, first on top; only for y.
    percent
        Whether numbers are shown in percent.
    """

    name: str
    scale: Scale = "linear"
    categories: tuple[str, ...] = ()
    percent: bool = False


@dataclass(frozen=True)
class Point:
    """One point of a series.

    Attributes
    ----------
    x, y
        Where it is; NaN is a gap.
    low, high
        Ends of its error bar; NaN where there is none. A bar without a point at its place is an
        upper bound.
    text
        What readers are told about it.
    hollow
        Whether it is drawn without filling.
    """

    x: float
    y: float
    low: float = math.nan
    high: float = math.nan
    text: str = ""
    hollow: bool = False


@dataclass(frozen=True)
class Series:
    """Points that belong together.

    Attributes
    ----------
    key
        Whose points they are.
    points
        In the order in which they are joined.
    joined
        Whether a line joins them.
    band
        Whether low and high are drawn as a band, not as bars.
    dashed
        Whether the line is a dashed one in the colour of text: the reference.
    size
        Diameter of the markers; 0 draws none.
    """

    key: Key
    points: tuple[Point, ...]
    joined: bool = True
    band: bool = False
    dashed: bool = False
    size: float = 7.0


@dataclass(frozen=True)
class Band:
    """A stripe across the chart between two values of one axis; fainter where `faint`."""

    side: Side
    low: float
    high: float
    faint: bool = False


@dataclass(frozen=True)
class Mark:
    """A line across the chart at one value of an axis, with a label."""

    side: Side
    at: float
    label: str = ""


@dataclass(frozen=True)
class Chart:
    """One panel.

    Attributes
    ----------
    title
        Says what this panel shows.
    x, y
        The axes.
    series
        Drawn in order.
    bands, marks
        Behind the series.
    bars
        Along which axis error bars lie.
    keys
        Names of keys with which the whole panel is hidden.
    limits
        Ends of the y axis, or None to find them.
    """

    title: str
    x: Axis
    y: Axis
    series: tuple[Series, ...]
    bands: tuple[Band, ...] = ()
    marks: tuple[Mark, ...] = ()
    bars: Side = "y"
    keys: tuple[str, ...] = ()
    limits: tuple[float, float] | None = None

    def points(self) -> Iterator[Point]:
        """Give all points of all series."""
        for series in self.series:
            yield from series.points


@dataclass(frozen=True)
class Strip:
    """Numbers on one logarithmic line, for a cell of a table.

    Attributes
    ----------
    key
        Colour and marker.
    values
        The numbers; those off the axis are drawn at its end.
    typical
        The one drawn large.
    ends
        Ends of the axis.
    marks
        Numbers marked by a line.
    """

    key: Key
    values: tuple[float, ...]
    typical: float
    ends: tuple[float, float]
    marks: tuple[float, ...] = ()
