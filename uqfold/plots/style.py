"""Colours and markers of methods, the same in every figure, and readable without colour vision.

Colours are those of Okabe and Ito without black, which is the reference, and with the pale ones
darkened until their contrast with white paper is 3 (WCAG 2.2); every method also has a marker of
its own, as far as there are markers that may be filled or hollow: there are fifteen.

References
----------
Okabe M, Ito K. Color universal design: how to make figures and presentations that are friendly to
colorblind people. University of Tokyo, 2008.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, cycle
from typing import Any

from uqfold.checks import several, text


@dataclass(frozen=True)
class MethodStyle:
    """Colour and marker of one method."""

    color: str
    marker: str


_FIXED = {
    "ffni-spa": MethodStyle("#0072B2", "o"),
    "ffni-pearson": MethodStyle("#D55E00", "s"),
    "kriging": MethodStyle("#4897C4", "P"),
    "pce": MethodStyle("#882255", "<"),
    "active-kriging": MethodStyle("#7F6A00", "X"),
    "mc": MethodStyle("#009E73", "^"),
    "qmc": MethodStyle("#6B7A1E", "H"),
    "conditional-mc": MethodStyle("#332288", "*"),
    "multifidelity-mc": MethodStyle("#117733", "p"),
    "subset-simulation": MethodStyle("#5D3A9B", ">"),
    "importance-sampling": MethodStyle("#2F6B8A", "8"),
    "line-sampling": MethodStyle("#A0522D", "h"),
    "directional-sampling": MethodStyle("#1F8A70", "d"),
    "openturns-form": MethodStyle("#CC79A7", "D"),
    "sorm": MethodStyle("#B4436C", "v"),
    "openturns-nais": MethodStyle("#7A4B9E", "p"),
    "openturns-mc": MethodStyle("#BD8200", "v"),
}
"""Their colours and markers."""
FURTHER_STYLES = (
    MethodStyle("#8C510A", "H"),
    MethodStyle("#3F9C8D", "d"),
    MethodStyle("#AA4499", "h"),
    MethodStyle("#666666", "s"),
    MethodStyle("#5A6A00", "^"),
)

_CURVE_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")

COLUMN_INCHES = 3.5
"""Width of a column of print."""

REFERENCE_LINE: Any = {"color": "#000000", "linewidth": 1.0, "linestyle": (0, (4, 2))}
BAND_COLOR = "#D9D9D9"
SOFT_COLOR = "#555555"
"""Remarks, and what belongs to no method."""

FIGURE_SETTINGS: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
    "lines.markersize": 4.5,
    "savefig.dpi": 160,
    # the same numbers give the same SVG file, and its text stays text
    "svg.hashsalt": "uqfold",
    "svg.fonttype": "none",
}
"""Matplotlib settings under which every figure is drawn and written."""


@contextmanager
def figure_settings() -> Iterator[None]:
    """Apply `FIGURE_SETTINGS` for a while; the caller's own settings come back afterwards."""
    import matplotlib as mpl

    with mpl.rc_context(FIGURE_SETTINGS):
        yield


def method_styles(labels: Iterable[str]) -> dict[str, MethodStyle]:
    """Return the colour and marker of each label.

    The built-in methods always have theirs; other labels take the further ones in turn, in the
    order given, and then the same colours with other markers.
    """
    names = several("labels", list(labels) if isinstance(labels, Mapping) else labels, text)
    number = len(FURTHER_STYLES)
    looks = (
        MethodStyle(FURTHER_STYLES[i % number].color,
                    FURTHER_STYLES[(i + i // number) % number].marker)
        for i in count()
    )  # fmt: skip
    further = (look for look in looks if look not in _FIXED.values())
    return {name: _FIXED.get(name) or next(further) for name in names}


def shades(style: MethodStyle, number: int) -> list[MethodStyle]:
    """Return the looks of several curves of one method: its colour from dark to light."""
    from matplotlib.colors import LinearSegmentedColormap, to_hex, to_rgb

    if number == 1:
        return [style]
    color = to_rgb(style.color)
    dark, light = [0.45 * part for part in color], [0.5 + 0.5 * part for part in color]
    tones = LinearSegmentedColormap.from_list("tones", [dark, color, light])
    markers = cycle(_CURVE_MARKERS)
    return [MethodStyle(to_hex(tones(i / (number - 1))), next(markers)) for i in range(number)]
