"""Frames of comparisons, whatever became of them since `uqfold.compare` returned them."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance
from uqfold.comparison.columns import ATTRIBUTE, COLUMNS, rows_to_frame
from uqfold.comparison.form import ROWS
from uqfold.comparison.header import checked_header
from uqfold.comparison.possible_rows import criterion_of
from uqfold.documents import said

if TYPE_CHECKING:
    import pandas as pd

# what rows alone tell of how they were made: nothing but problem, criteria, methods and seed
_UNKNOWN: dict[str, Any] = {
    **dict.fromkeys(("response_unit", "failed_runs", "command", "date", "machine"), ""),
    **dict.fromkeys(("system", "max_evals", "reference")),
    **{"response": "response", "versions": {}, "source": {}},
}
_UNKNOWN_METHOD: dict[str, Any] = {
    "title": "",
    "settings": "",
    "theory": {"summary": "", "equations": [], "references": []},
}


def checked_frame(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a comparison in their columns and types, with the header of these rows.

    How the comparison was made travels in ``frame.attrs``. The header returned has the criteria
    that occur in the rows, the methods that do, and those that had not finished. A frame without
    a header (read from a CSV file, say) gets one with what the rows alone tell: settings,
    equations, versions and date are then unknown.

    Parameters
    ----------
    frame
        Rows with the columns of `columns.COLUMNS`, of one problem.

    Raises
    ------
    ValueError
        If columns are missing, there is no row, or rows of several problems.
    """
    import pandas as pd

    instance("frame", frame, pd.DataFrame, "give one that uqfold.compare returned")
    missing = [name for name in COLUMNS if name not in frame.columns]
    if missing:
        raise ValueError(
            f"the frame has no column {missing[0]!r}: give one that uqfold.compare returned"
        )
    try:
        rows = ROWS.validate_python(frame[list(COLUMNS)].to_dict("records"))
    except ValueError as error:
        raise ValueError(f"the frame holds what no comparison does: {said(error)}") from error
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    if len(problems) != 1:
        named = ", ".join(problems) if problems else "none"
        raise ValueError(f"a report is about one problem, the frame holds {named}: select one")
    checked = rows_to_frame(rows)
    checked.attrs[ATTRIBUTE] = _header(frame.attrs.get(ATTRIBUTE), checked)
    return checked


def comparison_header(frame: pd.DataFrame) -> dict[str, Any]:
    """Return how the comparison in a frame was made; see `checked_frame`, and ``docs/records.md``.

    Raises
    ------
    ValueError
        If the frame is not one of a comparison.
    """
    header: dict[str, Any] = checked_frame(frame).attrs[ATTRIBUTE]
    return header


def _header(document: Any, frame: pd.DataFrame) -> dict[str, Any]:
    labels = dict(zip(frame["label"], frame["method"], strict=True))
    stated = frame[["threshold", "tau", "missions", "missions_planned", "missions_p"]]
    criteria = [asdict(criterion_of(row)) for row in stated.drop_duplicates().to_dict("records")]
    told = {"criteria": criteria, "finished": list(labels)}
    if document is not None:
        header = checked_header(document)
        if set(labels) <= {one["label"] for one in header["methods"]}:
            left_out = set(header["finished"]) - set(labels)
            methods = [one for one in header["methods"] if one["label"] not in left_out]
            return header | told | {"methods": methods}
    # where rows of another comparison were appended, nothing is known about how they were made
    methods = [{"label": label, "method": name} | _UNKNOWN_METHOD for label, name in labels.items()]
    problem, seed = frame["problem"].iloc[0], int(frame["seed"].iloc[0])
    return _UNKNOWN | told | {"problem": problem, "methods": methods, "seed": seed}
