"""What the reference scripts share: the mission profiles, the file format, the comparison.

A reference file is JSON with one row per line, so that a change shows as a readable difference.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from uqfold.problems.criterion import Binomial, Missions
from uqfold.problems.reference import SCHEMA, ReferenceTable, parse_references
from uqfold.writing import write_text

SHIPPED = Path(__file__).resolve().parents[2] / "uqfold" / "problems" / "references"
"""Where the references of the package live."""

# Fig. 15 (d) varies the number of planned flights at p = 0.5, Fig. 15 (e) varies p at ten flights
BINOMIAL_PROFILES: tuple[Missions, ...] = (
    *(Binomial(planned, 0.5) for planned in (2, 4, 6, 8, 10)),
    *(Binomial(10, p) for p in (0.3, 0.7, 0.9)),
)


@dataclass(frozen=True)
class Row:
    """One reference: a criterion, its failure probability and the error of that number."""

    threshold: float
    tau: float | None
    missions: Missions
    pf: float
    std_error: float

    def to_json(self) -> str:
        """Give the row as one line, pf with 13 digits and the error rounded up to two."""
        missions: object = self.missions
        if isinstance(self.missions, Binomial):
            missions = {"planned": self.missions.planned, "p": self.missions.p}
        return json.dumps(
            {
                "threshold": self.threshold,
                "tau": self.tau,
                "missions": missions,
                "pf": float(f"{self.pf:.12e}"),
                "std_error": rounded_up(self.std_error),
            }
        )


def rounded_up(value: float) -> float:
    """Round a positive number up to two significant digits."""
    if value == 0.0:
        return 0.0
    unit = math.floor(math.log10(value)) - 1
    return float(f"{math.ceil(value / 10.0**unit)}e{unit}")


def as_text(problem: str, kind: str, how: str, command: str, rows: Iterable[Row]) -> str:
    """Give the text of a reference file, checked by the parser of the package."""
    head = {"schema": SCHEMA, "problem": problem, "kind": kind, "how": how, "command": command}
    lines = ",\n".join(f"  {row.to_json()}" for row in rows)
    text = json.dumps(head, indent=1)[:-2] + ',\n "rows": [\n' + lines + "\n ]\n}\n"
    parse_references(json.loads(text))
    return text


def write(path: Path, text: str) -> None:
    """Write the file whole or not at all, so that an interrupted run leaves the former one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)


def read(path: Path) -> ReferenceTable:
    """Read a reference file."""
    return parse_references(json.loads(path.read_text(encoding="utf-8")))


def mismatches(shipped: ReferenceTable, computed: ReferenceTable) -> list[str]:
    """Say where two tables of integrated references differ by more than their own bounds."""
    found = []
    for criterion in {**shipped.entries, **computed.entries}:
        old, new = shipped.lookup(criterion), computed.lookup(criterion)
        if old is None or new is None:
            found.append(f"{criterion}: only in the {'computed' if old is None else 'shipped'} one")
        # a NaN must count as a mismatch, hence "not <="
        elif not abs(old.pf - new.pf) <= old.std_error + new.std_error:
            found.append(f"{criterion}: shipped {old.pf!r}, computed {new.pf!r}")
    return found


def integration_command(
    description: str | None,
    files: Sequence[tuple[str, Callable[[], str]]],
    arguments: Sequence[str] | None = None,
) -> int:
    """Run the command line of a script that integrates: write its files, or check them.

    Parameters
    ----------
    description
        Docstring of the script.
    files
        Name of each shipped file and the function that computes its text.
    arguments
        Command-line arguments; None takes those of the process.

    Returns
    -------
    int
        Exit code: 0, or 1 when `--check` finds a difference.
    """
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--out", type=Path, default=SHIPPED, help="folder for the files (default: the package's)"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing: recompute, compare with the files in --out, exit 1 if they differ",
    )
    options: Any = parser.parse_args(arguments)
    code = 0
    for name, compute in files:
        path = options.out / name
        text = compute()
        if not options.check:
            write(path, text)
            print(f"{path}: {len(json.loads(text)['rows'])} rows")
            continue
        if not path.exists():
            print(f"{path}: missing", file=sys.stderr)
            code = 1
            continue
        found = mismatches(read(path), parse_references(json.loads(text)))
        print(f"{path}: {len(found)} rows differ beyond their bounds")
        for line in found:
            print(f"  {line}", file=sys.stderr)
        code = 1 if found else code
    return code
