"""Write ``docs/catalogue.md`` from the entries of the catalogue and its table of the literature.

python docs/catalogue.py           # write it anew
python docs/catalogue.py --check   # exit 1 if the page is not the present one
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from uqfold.problems import catalogue
from uqfold.problems.catalogue import Entry
from uqfold.report.page.builder import Page

PAGE = Path(__file__).resolve().parent / "catalogue.md"


def written() -> str:
    """Return the page."""
    entries = {name: catalogue.entry(name) for name in catalogue.titles()}
    page = Page("A catalogue of limit states")
    page.text(
        f"{len(entries)} limit states of the literature, each in a file of its own in "
        "`uqfold/problems/catalogue/limit_states`, with a failure probability found by "
        'us: `uqfold compare rp22`, or `uqfold.problems.catalogue.problem("rp22")`. '
        "`entry(name).reference()` finds the probability again, in closed form or by integration "
        "without sampling; its error is a bound. Made by `python docs/catalogue.py`."
    )
    page.table(pd.DataFrame([row(name, one) for name, one in entries.items()]), "Limit states")
    kinds = [
        {"kind": kind, "meaning": meaning, "limit states": names_of(kind, entries)}
        for kind, meaning in catalogue.KINDS.items()
    ]
    page.table(pd.DataFrame(kinds), "What makes them hard")
    sources = [{"name": name, "source": one.source} for name, one in entries.items()]
    page.table(pd.DataFrame(sources), "Sources")
    page.table(pd.DataFrame(wrong(entries)), "Published as known, and wrong")
    page.text(
        "Wrong is what is further from our value than one unit of its last printed digit. The next "
        "table holds what methods are reported to give (`uqfold.problems.catalogue.literature()`); "
        "its last column is relative to our pf."
    )
    page.table(literature(entries), "Reports of the literature")
    return page.markdown()


def row(name: str, one: Entry) -> dict[str, str]:
    """Return what the first table says of a limit state."""
    return {
        "name": name,
        "title": catalogue.titles()[name],
        "inputs": str(dimension(one.inputs())),
        "kinds": ", ".join(one.kinds),
        "pf": f"{one.pf:.6g}",
        "error": f"{one.error:.0e}",
        "how": one.how,
    }


def dimension(inputs: Any) -> int:
    """Return how many inputs there are, in a mapping or a joint distribution."""
    return len(inputs) if isinstance(inputs, Mapping) else int(inputs.getDimension())


def names_of(kind: str, entries: dict[str, Entry]) -> str:
    """Return the limit states of a kind."""
    return ", ".join(name for name, one in entries.items() if kind in one.kinds)


def wrong(entries: dict[str, Entry]) -> list[dict[str, str]]:
    """Return the published values that are wrong."""
    return [
        {
            "name": name,
            "who": who,
            "published": one.published[who],
            "ours": f"{one.pf:.6g}",
            "off": f"{100.0 * off:+.2g} %",
        }
        for name, one in entries.items()
        for who, off in one.wrong().items()
    ]


def literature(entries: dict[str, Entry]) -> pd.DataFrame:
    """Return the reports beside our references."""
    table = catalogue.literature()
    ours = table.problem.map({name: one.pf for name, one in entries.items()})
    return pd.DataFrame(
        {
            "problem": table.problem,
            "method": table.method,
            "runs": ["" if pd.isna(n) else f"{n:,.0f}" for n in table.runs],
            "pf": [f"{pf:.4g}" for pf in table.pf],
            "cov": ["" if pd.isna(cov) else f"{cov:.3g}" for cov in table["cov"]],
            "source": table.source,
            "off": [f"{100.0 * off:+.2g} %" for off in table.pf / ours - 1.0],
        }
    )


def main(arguments: list[str]) -> int:
    """Write the page, or check it."""
    text = written()
    if "--check" in arguments:
        return int(PAGE.read_text(encoding="utf-8") != text)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
