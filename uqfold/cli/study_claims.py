"""Judging the paper's claims for the command line."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from uqfold.cli.compare import EXIT_FAILED, say, stdout_console
from uqfold.cli.streams import shown_path

if TYPE_CHECKING:
    import pandas as pd

FILE_NAME = "claims.md"


def read_studies(root: Path) -> dict[str, dict[str, pd.DataFrame]]:
    """Read the results of all studies below a folder; a study without results is left out.

    Raises
    ------
    StudyError, ResultsError
        If a study file or its results are damaged.
    """
    from uqfold.comparison.studies.loading import load_study
    from uqfold.comparison.studies.results import read_tables, results_state
    from uqfold.comparison.studies.study import FILE_NAME as STUDY
    from uqfold.report.studies.registry import figure_kinds, table_kinds

    results = {}
    for file in sorted(root.glob(f"*/{STUDY}")):
        study = load_study(file.parent, figure_kinds(), table_kinds())
        if results_state(study) == "present":
            results[file.parent.name] = read_tables(study.folder, study.columns)
    return results


def judge_claims(root: Path, *, check: bool) -> int:
    """Judge all claims, print the verdicts, write or check the page; give the exit code."""
    from uqfold.comparison.claims import CLAIMS, judged
    from uqfold.comparison.studies.document import StudyError
    from uqfold.comparison.studies.results import ResultsError
    from uqfold.report.claims import claims_page
    from uqfold.report.layout import hanging, line
    from uqfold.writing import write_text

    try:
        results = read_studies(root)
    except (StudyError, ResultsError) as error:
        say(f"error: {error}")
        return EXIT_FAILED
    if not results:
        say(f"error: no study in {shown_path(root)} has results: uqfold study run makes them")
        return EXIT_FAILED
    verdicts = [judged(claim, results) for claim in CLAIMS.values()]
    out = stdout_console(quiet=False)
    styles = {"holds": "green", "does not hold": "bold red", "cannot be judged": "yellow"}
    for one in verdicts:
        out.print(line(f"{one.claim.key}: {one.verdict}", styles[one.verdict]))
        for text in hanging("  ", one.claim.statement, out.width):
            out.print(text)
        for finding in one.findings:
            if one.verdict == "holds" or finding.verdict != one.verdict:
                continue
            for text in hanging("  - ", finding.words, out.width, "dim"):
                out.print(text)
    page, path = claims_page(verdicts), root / FILE_NAME
    if check:
        same = path.is_file() and path.read_text(encoding="utf-8") == page
        if not same:
            say(f"error: {shown_path(path)} is not what the results give: uqfold study claims")
        return 0 if same else EXIT_FAILED
    write_text(path, page)
    out.print(f"{shown_path(path)} written", highlight=False, markup=False)
    return 0
