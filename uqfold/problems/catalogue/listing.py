"""The limit states of the catalogue by name: modules of `limit_states`, each with an `ENTRY`."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from uqfold.checks import choice
from uqfold.problems.base import Problem
from uqfold.problems.catalogue.folder import titles
from uqfold.problems.catalogue.record import Entry

if TYPE_CHECKING:
    import pandas as pd


def entry(name: str) -> Entry:
    """Return what the catalogue says of a limit state.

    Parameters
    ----------
    name
        A key of `titles`.

    Raises
    ------
    ValueError
        If there is none of that name; the message lists those that exist.
    """
    stem = choice("name", name, titles()).replace("-", "_")
    found: Entry = import_module(f"uqfold.problems.catalogue.limit_states.{stem}").ENTRY
    return found


def problem(name: str) -> Problem:
    """Return a limit state of the catalogue as a problem.

    Parameters
    ----------
    name
        A key of `titles`.

    Returns
    -------
    Problem
        One unit; the response is y = -g. The reference for g <= 0 is attached.

    Raises
    ------
    ValueError
        If there is none of that name; the message lists those that exist.

    Examples
    --------
    >>> from uqfold.problems import catalogue
    >>> catalogue.problem("rp22").inputs.names
    ('x1', 'x2')
    """
    return entry(name).problem(name)


def literature() -> pd.DataFrame:
    """Return what methods are reported to give on limit states of the catalogue.

    Returns
    -------
    pandas.DataFrame
        ``problem``, ``method``, ``runs`` of the model, ``pf`` and its coefficient of variation
        ``cov`` (both NaN where the source does not say), and ``source``; one row per report.
    """
    import pandas as pd

    return pd.read_csv(Path(__file__).with_name("literature.csv"))
