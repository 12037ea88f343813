"""Write into ``docs/which-method.md`` what each method answers, as the methods themselves say.

    python docs/capabilities.py           # write it anew
    python docs/capabilities.py --check   # exit 1 if the table is not the present one

Whether a criterion, a system or an input is answered is what `supports` says of one that has it.
"""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import uqfold
from uqfold.inputs import bernoulli, normal
from uqfold.methods import ReliabilityMethod, available
from uqfold.methods.registry import built_in
from uqfold.typing import FloatArray

PAGE = Path(__file__).resolve().parent / "which-method.md"
BEGIN, END = "<!-- made by python docs/capabilities.py -->", "<!-- end of the table -->"


def plane(x: FloatArray) -> FloatArray:
    """Return the sum of the inputs (n,), standardised."""
    return np.asarray(x.sum(axis=1) / np.sqrt(x.shape[1]))


def of(dimension: int) -> uqfold.Problem:
    """Return a plane in so many standard-normal inputs as a problem with a partner."""
    inputs = {f"u{i}": normal(0.0, 1.0) for i in range(dimension)}
    return uqfold.Problem(plane, individual=inputs, low_fidelity=plane)


def some_share_all() -> uqfold.Problem:
    """Return a system of which one unit has an input of its own, and the other has none."""
    shared, own = {"v": normal(0.0, 1.0)}, {"u": normal(0.0, 1.0)}
    units = [uqfold.Unit(), uqfold.Unit(model=lambda x: x[:, 0], individual=[], low_fidelity=plane)]
    return uqfold.Problem(plane, shared=shared, individual=own, units=units, low_fidelity=plane)


def questions() -> Iterator[tuple[str, uqfold.Problem, uqfold.Criterion]]:
    """Yield what is asked of every method, and the column that it fills."""
    three, plain = replace(of(2), units=3), uqfold.Criterion(2.0)
    units = [uqfold.Unit(), uqfold.Unit(model=lambda x: plane(x) + 1.0, low_fidelity=plane)]
    yield "tau", three, uqfold.Criterion(2.0, tau=1.0)
    yield "missions", three, uqfold.Criterion(2.0, missions=uqfold.Binomial(3, 0.5))
    yield "structures", replace(three, structure=uqfold.KOutOfN(2)), plain
    differing = replace(of(2), units=units)
    yield "units that differ", differing, plain
    yield "these under tau", differing, uqfold.Criterion(2.0, tau=1.0)
    yield "some share all inputs", some_share_all(), plain
    inputs = {"load": normal(0.0, 1.0), "open": bernoulli(0.1)}
    yield "discrete inputs", uqfold.Problem(plane, individual=inputs, low_fidelity=plane), plain


def said(yes: bool) -> str:
    """Return the cell of a column."""
    return "yes" if yes else "no"


def asked(method: ReliabilityMethod) -> dict[str, str]:
    """Return what the table says of a method, by column."""
    cells = {
        column: said(method.supports(problem, criterion) is None)
        for column, problem, criterion in questions()
    }
    return cells | {
        "failed runs": "bounds" if method.bounds_failed_runs else "no answer",
        "ask and tell": said(hasattr(method, "start")),
        "seeds matter": said(method.stochastic),
    }


def table() -> str:
    """Return the table of all built-in methods."""
    rows = {name: asked(available()[name]()) for name in built_in()}
    columns = list(next(iter(rows.values())))
    lines = [f"| method | {' | '.join(columns)} |", "| --- " * (len(columns) + 1) + "|"]
    lines += [f"| `{name}` | {' | '.join(cells.values())} |" for name, cells in rows.items()]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Write the table, or check it."""
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    made = f"{before}{BEGIN}\n{table()}\n{END}{rest.split(END)[1]}"
    if "--check" in arguments:
        return int(page != made)
    PAGE.write_text(made, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
