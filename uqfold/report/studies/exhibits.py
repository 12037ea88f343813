"""Drawing the figures and making the tables of a study from its results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.study import Spec, Study
from uqfold.report.figures import FORMATS, save_figure
from uqfold.report.studies.selection import SelectionError
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

FIGURES_FOLDER = "figures"


def write_exhibits(
    study: Study,
    tables: Mapping[str, pd.DataFrame],
    folder: Path,
    progress: Callable[[str], None] | None = None,
) -> tuple[dict[str, pd.DataFrame], list[Path]]:
    """Make all tables and draw all figures.

    Parameters
    ----------
    study
        What to show.
    tables
        Its results by name, the built-in tables among them.
    folder
        The figures are written into ``figures/`` below it; figures of other names that an earlier
        run left there are removed.
    progress
        Called with the name of each figure before it is drawn.

    Returns
    -------
    tuple[dict[str, pandas.DataFrame], list[pathlib.Path]]
        The tables of the report by name, and the files written.

    Raises
    ------
    SelectionError
        If a table or figure chooses no row; the message names it.
    """
    shown = {spec.name: _called(spec, tables) for spec in study.tables}
    directory = folder / FIGURES_FOLDER
    written: list[Path] = []
    for spec in study.figures:
        if progress is not None:
            progress(spec.name)
        figure = _called(spec, tables)
        directory.mkdir(parents=True, exist_ok=True)
        if spec.kind.picture == "svg":
            written.append(_save_picture(figure, directory / f"{spec.name}.svg"))
        else:
            written += save_figure(figure, directory, spec.name)
    if directory.is_dir():
        for path in directory.iterdir():
            if path.suffix.removeprefix(".") in FORMATS and path not in written:
                path.unlink()
    return shown, written


def _save_picture(text: str, path: Path) -> Path:
    write_text(path, text)
    return path


def _called(spec: Spec, tables: Mapping[str, pd.DataFrame]) -> Any:
    try:
        return spec.kind.call(spec.settings, tables)
    except SelectionError as error:
        raise SelectionError(f"{spec.name}: {error}") from error
