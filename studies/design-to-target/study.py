"""Design to a target: the smallest T and the smallest drive force for R >= 0.999.

Which threshold T must be granted to the wings, and which mean of the drive force k_d must they get,
so that the system works with R >= 0.999, and how sure are we of these values?

A design value is where pf crosses the target of 1e-3. It is found on a Kriging surface of 100 model
runs, whose error becomes the interval of the value; the safe value is the end of that interval at
which the target is met with 97.5 % confidence. For k_d the surface is fitted once, over drive
forces spread over the whole range, at T = 0.56 s. Conditional Monte Carlo on the real model, with
another seed, verifies each value and each safe value; it is far less sharp than the surface, so
that both are often undecided. Thresholds found by simulation alone and by FFNI stand beside. Under
a synchronization threshold failures of synchronization alone may exceed the target: then no T meets
it, and the row says so.
"""

import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

import uqfold
from uqfold import criteria, plots
from uqfold.analysis import design_input, design_thresholds, designs_to_frame
from uqfold.methods import ConditionalMonteCarlo, FFNIPearson, Kriging

sys.path.append(str(Path(__file__).parents[1]))
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-9)

TARGET = 1e-3
WING = uqfold.problems.folding_wing()
PROBLEMS = {"wing": WING}
METHODS = {
    "kriging": Kriging(),
    "conditional-mc": ConditionalMonteCarlo(blocks=2000, missions_per_draw=5),
    "ffni-pearson": FFNIPearson(check=False),
}
SMALL = ConditionalMonteCarlo(blocks=400, missions_per_draw=4)
QUICK = ConditionalMonteCarlo(blocks=12, missions_per_draw=4)
THRESHOLDS = ("threshold-by-surface", "threshold-by-simulation", "threshold-by-ffni")


def tables(run: Run) -> None:
    """Find thresholds in three ways and drive forces in one; verify by simulation."""
    simulation = run.choose(METHODS["conditional-mc"], QUICK)
    evaluator = run.evaluator(WING)
    profiles = [(tau, m) for tau in (None, 0.04, 0.06) for m in (1, 5)]
    for name, method, seed in (
        ("threshold-by-surface", METHODS["kriging"], 0),
        ("threshold-by-simulation", simulation, 5),
        ("threshold-by-ffni", METHODS["ffni-pearson"], 0),
    ):
        found = design_thresholds(
            WING, TARGET, (0.54, 0.60), run.choose(profiles, profiles[:1]), method=method,
            rng=seed, evaluator=evaluator,
        )  # fmt: skip
        verify_by = simulation if name == "threshold-by-surface" else None
        frame = designs_to_frame(found, verify_by, rng=1, evaluator=evaluator)
        run.keep(name, frame, problem="wing")

    found = [
        design_input(
            WING, criterion, TARGET, "k_d", (530, 650), method=METHODS["kriging"], rng=0,
            evaluator=evaluator,
        )
        for criterion in criteria(0.56, *run.choose(([None, 0.06], [1, 5]), (None, 1)))
    ]  # fmt: skip
    frame = designs_to_frame(found, run.choose(SMALL, QUICK), rng=1, evaluator=evaluator)
    run.keep("force-by-surface", frame, problem="wing")


def page(run: Run) -> "uqfold.report.Page":
    """Show both designs as tables and figures."""
    page = new_page(run, __doc__)
    title = "Smallest threshold T for R >= 0.999"
    page.section("Smallest threshold")
    page.table(
        design_table(run.rows(*THRESHOLDS)),
        title,
        "In brackets the interval of 95 % of the simulation. `met`: the whole of it lies below the "
        "target, `missed`: above, `undecided`: on both sides, as it should where pf is the target.",
    )
    page.figure(plots.design(run.rows(*THRESHOLDS)), title, name="thresholds")
    title = "Smallest mean of the drive force k_d for R >= 0.999"
    page.section("Smallest drive force")
    page.table(design_table(run.rows("force-by-surface")), title)
    page.figure(plots.design(run.rows("force-by-surface")), title, name="forces")
    return finish(page, run, {**METHODS, "conditional-mc for k_d": SMALL})


def design_table(frame: pd.DataFrame) -> pd.DataFrame:
    """Return every design with its interval, and the verdict of simulation."""
    rows = []
    for row in frame.to_dict("records"):
        width = row["high"] - row["low"]
        # an interval is shown to its second digit
        digits = 1 - math.floor(math.log10(width)) if width > 0.0 else 4
        value, low, high = (f"{row[name]:.{digits}f}" for name in ("value", "low", "high"))
        tau = "no tau" if math.isnan(row["tau"]) else f"tau = {row['tau']:g} s"
        rows.append({
            "criterion": f"{tau}, m = {row['missions']}",
            "method": row["label"],
            "evaluations": row["n_evals"],
            f"{row['parameter']} ({row['unit']})": row["status"] if value == "nan" else value,
            "interval, 95 %": f"{low} to {high}" if width > 0.0 else "-",
            "simulated pf at the value": simulated(row, "value"),
            "at the safe value": simulated(row, "safe"),
            "intervals agree": row["agrees"] or "-",
            "note": row["message"] if row["status"] == "doubtful" else "",
        })  # fmt: skip
    return pd.DataFrame(rows)


def simulated(row: Mapping[str, Any], place: str) -> str:
    """Write what simulation says of a design at its value or safe value."""
    pf, low, high = (row[f"{place}_{name}"] for name in ("pf", "ci_low", "ci_high"))
    verdicts = {"": "", "yes": "met", "no": "missed", "undecided": "undecided"}
    verdict = verdicts[row[f"{place}_meets"]]
    return f"{pf:.3g} ({low:.2g} to {high:.2g}): {verdict}" if verdict else "-"


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
