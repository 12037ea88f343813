"""Which unit matters: importance measures with the common cause in them, and without."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.checks import choice
from uqfold.plots.panels import axes_or_new, draw_rows, mark
from uqfold.plots.rows import checked, distinct
from uqfold.plots.style import SOFT_COLOR, figure_settings, method_styles
from uqfold.plots.wording import value_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

MEASURES = {
    "pf": "failure probability of the system",
    "birnbaum": "Birnbaum importance:\npf at stake with the unit",
    "fussell_vesely": "Fussell-Vesely importance:\nshare of pf that a perfect unit saves",
    "risk_achievement_worth": "risk achievement worth:\nfactor on pf while the unit is out",
    "risk_reduction_worth": "risk reduction worth:\nfactor that a perfect unit takes off pf",
}
ROW_INCHES = 0.34
INDEPENDENT = ", independent"


@figure_settings()
def importance(
    table: pd.DataFrame, measure: str = "fussell_vesely", ax: Axes | None = None
) -> Axes:
    """Draw one measure of every unit, with the common cause (filled) and without (hollow).

    Parameters
    ----------
    table
        What `uqfold.analysis.importance_of_units` returned.
    measure
        ``birnbaum``, ``fussell_vesely``, ``risk_achievement_worth``, ``risk_reduction_worth`` or
        ``pf``. Infinite values are not drawn.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    import pandas as pd
    from matplotlib.ticker import LogLocator, NullFormatter

    choice("measure", measure, MEASURES)
    needs = ("unit", "threshold", "missions", measure, f"{measure}_independent")
    frame = checked("table", table, needs)
    frame = frame.assign(
        row=frame["unit"],
        series=[
            ", ".join(value_text(name, row[name], "") for name in ("threshold", "missions"))
            for row in frame.to_dict("records")
        ],
    )
    asked = method_styles(distinct(frame, "series"))
    both = []
    for column, ending in ((measure, ""), (f"{measure}_independent", INDEPENDENT)):
        value = frame[column].where(np.isfinite(frame[column]))
        both.append(
            frame.assign(series=frame["series"] + ending, value=value, low=value, high=value)
        )
    looks = {f"{name}{end}": asked[name] for name in asked for end in ("", INDEPENDENT)}
    axes = axes_or_new(ax, height=1.3 + ROW_INCHES * frame["unit"].nunique())
    draw_rows(axes, pd.concat(both), looks, hollow=INDEPENDENT)
    axes.set_xlabel(MEASURES[measure])
    if measure == "fussell_vesely":
        axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    else:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
    handles = [mark(label, marker=look.marker, color=look.color) for label, look in asked.items()]
    handles += [
        mark("causes shared", color=SOFT_COLOR),
        mark("as if independent", hollow=True, color=SOFT_COLOR),
    ]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.4, -0.35), ncols=2)
    return axes
