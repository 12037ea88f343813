"""Tables of a benchmark: which method is best at which budget, and which ones know their error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.benchmark import NEEDS
from uqfold.comparison.studies.keys import COUNT, TABLE_NAMES, Key, Kind
from uqfold.report.studies.benchmark import decade_text, summarised
from uqfold.report.wording import NO_VALUE, count_text, percent

if TYPE_CHECKING:
    import pandas as pd


def ranking(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Rank methods by the median over problems of their root mean square error.

    Settings are the values of the keys of `RANKING`. A method is ranked where it answers all
    criteria of the decade on every problem that has a reference there. The worst problem is named
    where the reference can judge it.
    """
    import pandas as pd

    summary = summarised(tables, settings["table"])
    complete = summary[summary["answers"] == summary["runs"]]
    rows = []
    for (synchronized, decade, budget), own in summary.groupby(
        ["synchronized", "decade", "max_evals"], sort=False
    ):
        mine = complete.loc[complete.index.intersection(own.index)]
        problems = own["problem"].nunique()
        errors = mine.groupby("label")["rms"].agg(["median", "size"])
        errors["max"] = mine[mine["judged"]].groupby("label")["rms"].max()
        errors = errors[errors["size"] == problems].sort_values("median", kind="stable")
        first = [
            f"{label} {percent(one['median'])}"
            + (f" (worst {percent(one['max'])})" if one["max"] > one["median"] else "")
            for label, one in errors.head(settings["places"]).iterrows()
        ]
        rows.append(
            {
                "order": (synchronized, -decade, budget),
                "tau": "yes" if synchronized else "no",
                "reference pf": decade_text(int(decade)),
                "budget": count_text(int(budget)),
                "problems": str(problems),
                **{
                    f"{i + 1}.": first[i] if i < len(first) else NO_VALUE
                    for i in range(settings["places"])
                },
            }
        )
    rows.sort(key=lambda row: row["order"])
    return pd.DataFrame(rows).drop(columns="order")


def trust(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Say of every method and budget how much it answers, how wrong it is, and whether it knows.

    Settings are the values of the keys of `TRUST`. Medians are over problems and decades.
    """
    import pandas as pd

    summary = summarised(tables, settings["table"])
    rows = []
    for (label, budget), own in summary.groupby(["label", "max_evals"], sort=False):
        answered = own[own["answers"] > 0]
        weights = own["answers"].sum(), own["runs"].sum()
        rows.append(
            {
                "method": label,
                "budget": count_text(int(budget)),
                "evaluations used": NO_VALUE
                if answered.empty
                else count_text(round(float(answered["n_evals"].mean()))),
                "answered": f"{100.0 * weights[0] / weights[1]:.0f} %",
                "median |bias|": _percent(answered["bias"].abs().median()),
                "median rms": _percent(answered["rms"].median()),
                "median efficiency": _factor(answered["efficiency"].median()),
                "intervals that hold the reference": _share(answered["coverage"].mean()),
                "error found / error stated": _ratio(answered["error_ratio"].median()),
            }
        )
    return pd.DataFrame(rows)


def seconds_table(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Give the wall time of every method: settings are the values of the keys of `SECONDS`."""
    import pandas as pd

    from uqfold.report.studies.selection import joined
    from uqfold.report.wording import seconds_text

    frame = joined(tables, settings["table"])
    budgets = list(dict.fromkeys(frame["max_evals"]))
    rows = []
    for label, own in frame.groupby("label", sort=False):
        found = {row["max_evals"]: row for row in own.to_dict("records")}
        line = {"method": str(label)}
        for budget in budgets:
            row = found.get(budget)
            line[f"{count_text(int(budget))} evaluations"] = (
                NO_VALUE
                if row is None or math.isnan(row["seconds"])
                else seconds_text(row["seconds"])
            )
        rows.append(line)
    return pd.DataFrame(rows)


def _percent(value: float) -> str:
    return NO_VALUE if math.isnan(value) else percent(value)


def _factor(value: float) -> str:
    return NO_VALUE if math.isnan(value) else f"{value:,.3g}"


def _share(value: float) -> str:
    return NO_VALUE if math.isnan(value) else f"{100.0 * value:.0f} %"


def _ratio(value: float) -> str:
    return NO_VALUE if math.isnan(value) else f"{value:.2g}"


_TABLES = Key("table", TABLE_NAMES, "Runs with several budgets and seeds.")
RANKING = Kind(
    "ranking",
    "The best methods for every decade of pf and budget, by the median over problems of their root "
    "mean square error.",
    (_TABLES, Key("places", COUNT, "How many.", 3)),
    ranking,
    needs=NEEDS,
)
TRUST = Kind(
    "trust",
    "How much every method answers at every budget, how wrong it is, and whether it knows.",
    (_TABLES,),
    trust,
    needs=NEEDS,
)
SECONDS = Kind(
    "seconds",
    "Wall time of every method at every budget.",
    (Key("table", TABLE_NAMES, "Timings."),),
    seconds_table,
    needs=("label", "max_evals", "seconds"),
)
