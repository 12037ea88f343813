"""Correlated against independent units over the threshold T."""

from __future__ import annotations

from typing import TYPE_CHECKING

from uqfold.plots.panels import GREY, key, limit_pf, stacked
from uqfold.plots.rows import distinct, having, joined, threshold_label, value_text
from uqfold.plots.style import figure_settings, method_styles, shades

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

NEEDS = ("units", "threshold", "pf", "pf_independent", "difference", "sampled_difference")
STANDARD_ERRORS = 2.0
"""Length of the bars on sampled differences."""
INDEPENDENT = (0, (3, 1.5))
"""Dashes of the curves of independent units."""


@figure_settings()
def independence_panels(table: pd.DataFrame) -> Figure:
    """Draw what `uqfold.analysis.independence` found, one shade per number of units.

    From top to bottom: reliability of correlated and of independent units; its difference, with
    that found by sampling; failure probabilities on a logarithmic axis.

    Parameters
    ----------
    table
        Its rows, of one tau and one number of missions. A column ``label`` gives the colour.

    Returns
    -------
    matplotlib.figure.Figure
    """
    frame = joined(table, NEEDS, "table").sort_values("threshold", kind="stable")
    label = str(frame["label"].iloc[0]) if "label" in frame else "ffni-spa"
    numbers = sorted(distinct(frame, "units"))
    looks = shades(method_styles([label])[label], len(numbers), own_markers=True)
    handles = [
        key(value_text("units", number, ""), color=look.color, linewidth=2.5)
        for number, look in zip(numbers, looks, strict=True)
    ]
    handles.append(key("correlated", color=GREY))
    handles.append(key("independent", color=GREY, linestyle=INDEPENDENT))
    if frame["sampled_difference"].notna().any():
        text = f"sampled, ± {STANDARD_ERRORS:g} s.e."
        handles.append(key(text, color=GREY, linestyle="", marker="o", markerfacecolor="white"))
    figure, grid = stacked((1.6, 1.6, 1.8), 1, handles)
    body, gap, tail = grid[:, 0]
    for number, look in zip(numbers, looks, strict=True):
        own = having(frame, "units", number)
        for column, dashes in (("pf", "-"), ("pf_independent", INDEPENDENT)):
            body.plot(own["threshold"], 1.0 - own[column], linestyle=dashes, color=look.color)
            tail.plot(own["threshold"], own[column], linestyle=dashes, color=look.color)
        gap.plot(own["threshold"], own["difference"], color=look.color)
        gap.errorbar(
            own["threshold"], own["sampled_difference"],
            yerr=STANDARD_ERRORS * own["sampled_std_error"], fmt=look.marker, color=look.color,
            markersize=3.2, markerfacecolor="white", markeredgewidth=0.9, elinewidth=0.9,
            capsize=1.5,
        )  # fmt: skip
    body.set_ylabel("reliability")
    body.set_ylim(-0.03, 1.03)
    gap.set_ylabel("$R$ − $R_{independent}$")
    tail.set_ylabel("failure probability")
    limit_pf(tail, [*frame["pf"], *frame["pf_independent"]], None)
    tail.set_xlabel(threshold_label(frame))
    figure.align_ylabels(grid[:, 0])
    return figure
