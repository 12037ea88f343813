"""Writing the figures of a comparison."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from uqfold.checks import instance
from uqfold.checks import path as checked_path
from uqfold.comparison.records import Records
from uqfold.report.cost import error_against_evaluations
from uqfold.report.curves import reliability_curves
from uqfold.report.style import figure_settings
from uqfold.writing import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    instance("records", records, Records, "give Records")
    directory = checked_path("folder", folder)
    directory.mkdir(parents=True, exist_ok=True)
    figures = {
        CURVES_STEM: reliability_curves(records),
        COST_STEM: error_against_evaluations(records),
    }
    written: list[Path] = []
    for stem, figure in figures.items():
        if figure is not None:
            written += save_figure(figure, directory, stem)
    return written


def save_figure(figure: Figure, folder: Path, stem: str) -> list[Path]:
    """Write one figure in all `FORMATS`; each file appears whole or not at all."""
    paths = [folder / f"{stem}.{suffix}" for suffix in FORMATS]
    for path in paths:
        with figure_settings(), replacing(path) as stream:
            # without a date the same records give the same file
            metadata = {"Date": None} if path.suffix == ".svg" else None
            figure.savefig(stream, format=path.suffix.removeprefix("."), metadata=metadata)
    return paths
