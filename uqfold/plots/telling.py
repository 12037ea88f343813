"""What artists of a figure belong to, and what readers are told about their points.

An artist that belongs to a method, a criterion or a series says so in its gid, for instance
``method=mc;criterion=1 mission``: a page switches it on and off by that. Beside its gid it carries
one text per point.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from uqfold.plots.saving import figure_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Spot: TypeAlias = tuple[float, float, str]
"""A point of a figure: to the right and down from its upper left corner (points), and its text."""

_TEXTS = "_uqfold_texts"
_NOT_TOLD = ("None", "none", "", " ", None, "_", "|")
"""Markers of lines without points, and of the ends of error bars."""


def gid(**belongs: str) -> str:
    """Return the name of what an artist belongs to.

    Examples
    --------
    >>> gid(method="mc", criterion="T = 2, 1 mission")
    'method=mc;criterion=T = 2, 1 mission'
    """
    return ";".join(f"{kind}={name.replace(';', ',')}" for kind, name in belongs.items())


def tell(artist: Any, belongs: str, texts: Sequence[str] = ()) -> None:
    """Name what an artist, or each artist of a container, belongs to, and say its points.

    Parameters
    ----------
    artist
        An artist, a container such as error bars, or a list of these.
    belongs
        What `gid` returned.
    texts
        One for each point of the artist, gaps included, of one or more lines; without texts
        readers are told the coordinates, under the names of the axes.
    """
    if isinstance(artist, Iterable):
        for one in artist:
            tell(one, belongs, texts)
    elif artist is not None:
        artist.set_gid(belongs)
        setattr(artist, _TEXTS, tuple(texts))


def told(figure: Figure) -> Iterator[tuple[Artist, list[Spot]]]:
    """Return the artists that belong to something, with those of their points that are marked."""
    for axes in figure.axes:
        # axes scale to what is drawn in them only when somebody asks
        axes.get_xlim()
        for artist in (axes, *axes.get_children()):
            if "=" in (artist.get_gid() or ""):
                yield artist, _spots(artist, figure)


def values(figure: Figure | Axes) -> dict[str, list[str]]:
    """Return what there is to read in a figure: gid -> the text of each marked point.

    Parameters
    ----------
    figure
        A figure, or any of its axes, whose artists were named, as those of `uqfold.plots` are.
    """
    found: dict[str, list[str]] = {}
    for artist, spots in told(figure_of(figure)):
        found.setdefault(artist.get_gid() or "", []).extend(text for *_, text in spots)
    return {name: texts for name, texts in found.items() if texts}


def _spots(artist: Artist, figure: Figure) -> list[Spot]:
    from matplotlib.lines import Line2D

    if not isinstance(artist, Line2D) or artist.get_marker() in _NOT_TOLD:
        return []
    points = np.column_stack([artist.get_xdata(orig=False), artist.get_ydata(orig=False)])
    texts = getattr(artist, _TEXTS, ())
    if len(texts) != len(points):
        texts = [_coordinates(artist, *point) for point in points]
    with np.errstate(divide="ignore", invalid="ignore"):
        places = artist.get_transform().transform(points) * 72.0 / figure.dpi
    width, height = 72.0 * figure.get_size_inches()
    return [
        (float(x), float(height - y), text)
        for (x, y), text in zip(places, texts, strict=True)
        if 0.0 <= x <= width and 0.0 <= y <= height
    ]


def _coordinates(line: Any, x: float, y: float) -> str:
    names = (line.axes.get_xlabel() or "x", line.axes.get_ylabel() or "y")
    return "\n".join(f"{name}: {value:.4g}" for name, value in zip(names, (x, y), strict=True))
