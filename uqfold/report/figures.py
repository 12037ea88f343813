"""Writing the figures of a comparison."""

from __future__ import annotations

import os
from pathlib import Path

from uqfold.comparison.records import Records, replacing
from uqfold.report.cost import error_against_evaluations
from uqfold.report.curves import reliability_curves
from uqfold.report.style import figure_settings

CURVES_STEM = "reliability-curves"
COST_STEM = "error-against-evaluations"
FORMATS = ("png", "svg")


def figure_paths(folder: str | os.PathLike[str]) -> list[Path]:
    """Give the files that `write_figures` may write."""
    return [
        Path(folder) / f"{stem}.{suffix}" for stem in (CURVES_STEM, COST_STEM) for suffix in FORMATS
    ]


def write_figures(records: Records, folder: str | os.PathLike[str]) -> list[Path]:
    """Write the figures of a comparison as PNG and SVG.

    Parameters
    ----------
    records
        The comparison.
    folder
        Where to; made if it is missing.

    Returns
    -------
    list[pathlib.Path]
        The files written. Without any reference there is no figure of errors, and without any
        answer no figure at all.
    """
    directory = Path(folder)
    directory.mkdir(parents=True, exist_ok=True)
    figures = {
        CURVES_STEM: reliability_curves(records),
        COST_STEM: error_against_evaluations(records),
    }
    written = []
    for path in figure_paths(directory):
        figure = figures[path.stem]
        if figure is None:
            continue
        with figure_settings(), replacing(path) as temporary:
            # without a date the same records give the same file
            metadata = {"Date": None} if path.suffix == ".svg" else None
            figure.savefig(temporary, metadata=metadata)
        written.append(path)
    return written
