"""What the reference scripts share: what is asked, the file format, the comparison.

A reference file is JSON with one row per line, so that a change shows as a readable difference.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from decimal import ROUND_UP, Context
from itertools import product
from pathlib import Path
from typing import Any

from uqfold.problems.criterion import Binomial, Criterion, Missions
from uqfold.problems.reference import SCHEMA, Reference, ReferenceTable, parse_references
from uqfold.typing import FloatArray
from uqfold.writing import write_text

SHIPPED = Path(__file__).resolve().parents[2] / "uqfold" / "problems" / "references"
"""Where the references of the package live."""

# Fig. 15 (d) varies the number of planned flights at p = 0.5, Fig. 15 (e) varies p at ten flights
BINOMIAL_PROFILES: tuple[Missions, ...] = (
    *(Binomial(planned, 0.5) for planned in (2, 4, 6, 8, 10)),
    *(Binomial(10, p) for p in (0.3, 0.7, 0.9)),
)


@dataclass(frozen=True)
class Grid:
    """What is asked of a system: all combinations, arrays (taus, profiles, thresholds).

    Attributes
    ----------
    thresholds, taus, profiles
        T (finite), tau (None: not required) and mission profiles.
    units
        Number of units n.
    """

    thresholds: Sequence[float]
    taus: Sequence[float | None]
    profiles: Sequence[Missions]
    units: int = 4

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the arrays of answers."""
        return len(self.taus), len(self.profiles), len(self.thresholds)

    @property
    def criteria(self) -> list[Criterion]:
        """The criteria in the order of the arrays."""
        every = product(self.taus, self.profiles, self.thresholds)
        return [Criterion(threshold, tau, profile) for tau, profile, threshold in every]

    def references(self, pf: FloatArray, std_error: FloatArray) -> list[Reference]:
        """Return the answers with their errors as references."""
        answers = zip(self.criteria, pf.ravel(), std_error.ravel(), strict=True)
        return [Reference(criterion, float(p), float(error)) for criterion, p, error in answers]


def as_text(
    problem: str, kind: str, how: str, command: str, references: Iterable[Reference]
) -> str:
    """Return the text of a reference file, checked by the parser of the package.

    pf has 13 digits, its error is rounded up to two.
    """
    head = {"schema": SCHEMA, "problem": problem, "kind": kind, "how": how, "command": command}
    rows = []
    for one in references:
        row = asdict(one.criterion) | {
            "pf": float(f"{one.pf:.12e}"),
            "std_error": rounded_up(one.std_error),
        }
        rows.append(f"  {json.dumps(row)}")
    text = json.dumps(head, indent=1)[:-2] + ',\n "rows": [\n' + ",\n".join(rows) + "\n ]\n}\n"
    parse_references(json.loads(text))
    return text


def rounded_up(value: float) -> float:
    """Round a positive number up to two significant digits."""
    return float(Context(prec=2, rounding=ROUND_UP).create_decimal(repr(float(value))))


def mismatches(shipped: ReferenceTable, computed: ReferenceTable) -> list[str]:
    """Return where two tables of integrated references differ by more than their own bounds."""
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
    files: Mapping[str, Callable[[], str]],
    arguments: Sequence[str] | None = None,
) -> int:
    """Run the command line of a script that integrates: write its files, or check them.

    Parameters
    ----------
    description
        Docstring of the script.
    files
        Name of each shipped file -> the function that computes its text.
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
        "--out", type=Path, default=SHIPPED, help="folder of the files (default: the package's)"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing: exit 1 if the files differ"
    )
    options: Any = parser.parse_args(arguments)
    different = False
    for name, compute in files.items():
        path, text = options.out / name, compute()
        if not options.check:
            write_text(path, text)
            continue
        shipped = parse_references(json.loads(path.read_text(encoding="utf-8")))
        found = mismatches(shipped, parse_references(json.loads(text)))
        print(f"{path}: {len(found)} rows differ beyond their bounds", *found, sep="\n  ")
        different = different or bool(found)
    return int(different)
