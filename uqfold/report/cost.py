"""Error against cost: which method tells most for its model runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance
from uqfold.comparison.records import Records
from uqfold.report.clouds import (
    Cloud,
    cost_limits,
    error_clouds,
    error_limits,
    side_steps,
)
from uqfold.report.style import (
    BAND_COLOR,
    MethodStyle,
    figure_settings,
    method_styles,
)
from uqfold.report.wording import finite, reference_resolution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE_INCHES = (7.0, 4.6)


@figure_settings()
def error_against_evaluations(records: Records) -> Figure | None:
    """Draw the error of Eq. (49) over the number of model runs, both logarithmic.

    A small marker is one criterion, filled where the error exceeds two standard errors of the
    reference and hollow where the reference cannot judge it; the large marker is the median.
    Methods of equal cost stand side by side.

    Parameters
    ----------
    records
        The comparison.

    Returns
    -------
    matplotlib.figure.Figure or None
        None where no row has a reference and an answer.
    """
    from matplotlib.figure import Figure

    instance("records", records, Records, "give Records")
    clouds = error_clouds(records)
    if not clouds:
        return None
    styles = method_styles(records.finished)
    figure = Figure(figsize=SIZE_INCHES, layout="constrained")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log")
    low, high = error_limits(clouds)
    left, right = cost_limits(clouds)
    axes.set(xlim=(left, right), ylim=(low, high))
    steps = side_steps(clouds, left, right)
    for cloud in clouds:
        _draw(axes, cloud, styles[cloud.label], steps[cloud.label], low)
    _format_ticks(axes)
    _draw_resolution(axes, records, low)
    header = records.header
    axes.set_xlabel("evaluations of the model")
    axes.set_ylabel("error of the failure probability, Eq. (49)")
    axes.set_title(f"{header.problem}: error against cost", loc="left", fontweight="bold")
    _add_legend(figure, axes, clouds, styles)
    return figure


def _draw(axes: Axes, cloud: Cloud, style: MethodStyle, step: float, low: float) -> None:
    # an error of exactly zero is drawn on the lower edge
    x, y = step * cloud.n_evals, np.maximum(cloud.error, low)
    for judged in (True, False):
        chosen = cloud.judged == judged
        axes.plot(
            x[chosen],
            y[chosen],
            style.marker,
            color=style.color,
            markersize=4.0,
            markeredgewidth=0.8,
            markerfacecolor=style.color if judged else "white",
            alpha=0.75,
        )
    axes.plot(
        step * cloud.cost,
        max(float(np.median(cloud.error)), low),
        style.marker,
        color=style.color,
        markersize=12.0,
        markeredgewidth=1.3,
        # the single criteria stay visible on it
        markerfacecolor=style.pale,
        zorder=1.9,
    )


def _format_ticks(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.7g}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100.0 * value:g} %"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())


def _draw_resolution(axes: Axes, records: Records, low: float) -> None:
    """Shade the errors that the reference is too uncertain to judge."""
    levels = finite(reference_resolution(row) for row in records.rows)
    for level, alpha, label in (
        (max(levels), 0.45, "below 2 standard errors\nof some references"),
        (min(levels), 1.0, "below 2 standard errors\nof every reference"),
    ):
        if level > low:
            axes.axhspan(
                low, level, facecolor=(BAND_COLOR, alpha), linewidth=0.0, zorder=0.2, label=label
            )


def _add_legend(
    figure: Figure, axes: Axes, clouds: Sequence[Cloud], styles: Mapping[str, MethodStyle]
) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D

    def marker(shape: str, color: str, size: float, face: Any, label: str) -> Line2D:
        return Line2D(
            [],
            [],
            linestyle="",
            marker=shape,
            color=color,
            markersize=size,
            markerfacecolor=face,
            label=label,
        )

    handles: list[Artist] = [
        marker(styles[one.label].marker, styles[one.label].color, 6.5, None, one.label)
        for one in clouds
    ]
    grey = MethodStyle("#555555", "o")
    handles.append(marker(grey.marker, grey.color, 11.0, grey.pale, "median of the criteria"))
    handles.append(marker(grey.marker, grey.color, 4.0, None, "one criterion"))
    if not all(one.judged.all() for one in clouds):
        label = "one criterion, below 2\nstandard errors of\nits reference"
        handles.append(marker(grey.marker, grey.color, 4.0, "white", label))
    figure.legend(handles=[*handles, *axes.patches], loc="outside right upper")
