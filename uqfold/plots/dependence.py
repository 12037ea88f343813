"""Correlated against independent units over the threshold T."""

from __future__ import annotations

from typing import TYPE_CHECKING

from uqfold.plots.curves import limit_pf
from uqfold.plots.panels import key, legend_below, mark, stacked
from uqfold.plots.rows import checked, distinct, having
from uqfold.plots.style import SOFT_COLOR, figure_settings, method_styles, shades
from uqfold.plots.wording import threshold_label, value_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

NEEDS = ("units", "threshold", "pf", "pf_independent", "difference", "sampled_difference")
STANDARD_ERRORS = 2.0
"""Length of the bars on sampled differences."""
DASHES = {"pf": "-", "pf_independent": (0, (3, 1.5))}


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
    frame = checked("table", table, NEEDS).sort_values("threshold", kind="stable")
    label = str(frame["label"].iloc[0]) if "label" in frame else "ffni-spa"
    numbers = sorted(distinct(frame, "units"))
    looks = shades(method_styles([label])[label], len(numbers), own_markers=True)
    figure, grid = stacked((1.6, 1.6, 1.8), 1)
    body, gap, tail = grid[:, 0]
    handles = []
    for number, look in zip(numbers, looks, strict=True):
        own = having(frame, "units", number)
        T = own["threshold"]
        for column, dashes in DASHES.items():
            body.plot(T, 1.0 - own[column], linestyle=dashes, color=look.color)
            tail.plot(T, own[column], linestyle=dashes, color=look.color)
        gap.plot(T, own["difference"], color=look.color)
        gap.errorbar(
            T, own["sampled_difference"], STANDARD_ERRORS * own["sampled_std_error"],
            fmt=look.marker, color=look.color, markerfacecolor="white", elinewidth=0.8, capsize=1.8,
        )  # fmt: skip
        handles.append(key(value_text("units", number, ""), color=look.color, linewidth=2.5))
    for name, dashes in zip(("correlated", "independent"), DASHES.values(), strict=True):
        handles.append(key(name, color=SOFT_COLOR, linestyle=dashes))
    if frame["sampled_difference"].notna().any():
        text = f"sampled, ± {STANDARD_ERRORS:g} s.e."
        handles.append(mark(text, hollow=True, color=SOFT_COLOR))
    body.set(ylabel="reliability", ylim=(-0.03, 1.03))
    gap.set_ylabel("$R$ − $R_{independent}$")
    tail.set(ylabel="failure probability", xlabel=threshold_label(frame))
    limit_pf(tail, [*frame["pf"], *frame["pf_independent"]])
    figure.align_ylabels(grid[:, 0])
    legend_below(figure, handles)
    return figure
