"""Records of many wings side by side: one row of numbers per field, one lane per wing.

Structure of arrays: an array holds rows of `LANES` numbers, and row k of lane i is element
k * LANES + i. With that layout known at compile time, the compiler packs the lanes of a loop into
vector instructions. Which rows hold which field follows from the record, so that nobody counts.
"""

from collections.abc import Callable
from itertools import count
from typing import Any, get_args, get_type_hints

from uqfold.mechanism.compiled import inlined

LANES = 32
"""Wings that advance side by side; two sets of states and the constants fit a level 1 cache."""


def rows_of(record: type) -> dict[str, range]:
    """Return the rows of each field of a record.

    Parameters
    ----------
    record : type
        A NamedTuple whose fields are floats or tuples of floats.

    Examples
    --------
    >>> from typing import NamedTuple
    >>> rows_of(NamedTuple("Point", [("t", float), ("x", tuple[float, float]), ("v", float)]))
    {'t': range(0, 1), 'x': range(1, 3), 'v': range(3, 4)}
    """
    rows, first = {}, 0
    for name, kind in get_type_hints(record).items():
        rows[name] = range(first, first + (len(get_args(kind)) or 1))
        first = rows[name].stop
    return rows


def row_count(record: type) -> int:
    """Return how many rows the fields of a record take."""
    return sum(map(len, rows_of(record).values()))


def lane_access(record: type) -> tuple[Callable[..., Any], Callable[..., None]]:
    """Return compiled functions that read a record from a lane and write it there.

    Parameters
    ----------
    record : type
        A NamedTuple as for `rows_of`.

    Returns
    -------
    read : callable
        ``read(rows, i)`` returns the record of lane i; with k * LANES + i in place of i, the
        one whose first row is row k.
    write : callable
        ``write(rows, i, values)`` puts the record `values` there.
    """
    reads, writes = [], []
    element = count(0, LANES)
    for name, kind in get_type_hints(record).items():
        parts = [f"[{k}]" for k in range(len(get_args(kind)))]
        places = [f"rows[i + {next(element)}]" for _ in parts or [""]]
        reads.append(f"{name}=({', '.join(places)})" if parts else f"{name}={places[0]}")
        writes += [
            f"{place} = values.{name}{part}"
            for place, part in zip(places, parts or [""], strict=True)
        ]
    # written out field by field, as numba cannot loop over the fields of a record
    source = (
        f"def read(rows, i):\n    return record({', '.join(reads)})\n"
        "def write(rows, i, values):\n    " + "\n    ".join(writes)
    )
    made: dict[str, Any] = {"__name__": __name__, "record": record}
    exec(source, made)
    return inlined(made["read"]), inlined(made["write"])
