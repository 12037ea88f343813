"""Running, listing and checking studies for the command line."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console

from uqfold.cli.compare import (
    COMPILING,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    run_once,
    say,
    stdout_console,
)
from uqfold.cli.invocation import Invocation
from uqfold.cli.streams import shown_path
from uqfold.cli.study import DEFAULT_ROOT, QUICK_FOLDER
from uqfold.comparison.studies.check import compare_tables
from uqfold.comparison.studies.document import StudyError
from uqfold.comparison.studies.loading import load_study
from uqfold.comparison.studies.results import (
    FOLDER,
    RECORD_NAME,
    ResultsError,
    read_record,
    read_tables,
    results_state,
    write_record,
    write_table,
)
from uqfold.comparison.studies.runner import StudyRunner
from uqfold.comparison.studies.study import FILE_NAME, Study
from uqfold.evaluation import EngineError, FailedRunError
from uqfold.provenance import shown_command
from uqfold.report.progress import ComparisonProgressBar, notice_if_slow
from uqfold.report.studies.exhibits import write_exhibits
from uqfold.report.studies.page import write_page
from uqfold.report.studies.registry import figure_kinds, table_kinds
from uqfold.report.studies.selection import SelectionError
from uqfold.writing import check_writable

CACHE_NAME = ".cache"
MOST_DIFFERENCES = 10


@dataclass(frozen=True)
class Options:
    """The options of ``study run``."""

    quick: bool = False
    out: Path | None = None
    store: Path | None = None
    keep: bool = True
    redraw: bool = False
    quiet: bool = False


def run_all(folders: Sequence[Path], options: Options, invocation: Invocation) -> int:
    """Run studies one after the other; give the exit code of the program."""
    try:
        studies = [_loaded(folder, quick=options.quick) for folder in folders]
    except StudyError as error:
        say(f"error: {error}")
        return EXIT_FAILED
    for study in studies:
        code = _run_one(study, options, invocation)
        if code:
            return code
    return 0


def show_list(root: Path) -> int:
    """Print the studies below a folder with question and state; give the exit code."""
    from uqfold.report.layout import hanging, line

    folders = _found(root)
    if not folders:
        say(f"error: no folder in {shown_path(root)} holds a {FILE_NAME}")
        return EXIT_FAILED
    out = stdout_console(quiet=False)
    code = 0
    for folder in folders:
        try:
            study = _loaded(folder)
        except StudyError as error:
            out.print(line(f"{shown_path(folder)}: unreadable", "bold"))
            for one in hanging("  ", str(error), out.width, "red"):
                out.print(one)
            code = EXIT_FAILED
            continue
        out.print(line(f"{shown_path(folder)}: {study.title}", "bold"))
        for one in hanging("  ", " ".join(study.question.split()), out.width):
            out.print(one)
        state = results_state(study)
        out.print(line(f"  results: {state}", "green" if state == "present" else "yellow"))
    return code


def check_all(
    folders: Sequence[Path] | None, store: Path | None, invocation: Invocation, *, run: bool
) -> int:
    """Check studies and print what was found; give the exit code."""
    out = stdout_console(quiet=False)
    chosen = _found(DEFAULT_ROOT) if folders is None else folders
    if not chosen:
        say(f"error: no folder in {DEFAULT_ROOT} holds a {FILE_NAME}")
        return EXIT_FAILED
    code = 0
    for folder in chosen:
        try:
            problems = _check_one(_loaded(folder), store, invocation, run=run)
        except (StudyError, ResultsError) as error:
            problems = [str(error)]
        except KeyboardInterrupt:
            say("interrupted")
            return EXIT_INTERRUPTED
        verdict = "holds" if not problems else "does not hold"
        out.print(f"{shown_path(folder)}: {verdict}", highlight=False)
        for problem in problems[:MOST_DIFFERENCES]:
            out.print(f"  {problem}", highlight=False, markup=False, soft_wrap=True)
        if len(problems) > MOST_DIFFERENCES:
            out.print(f"  and {len(problems) - MOST_DIFFERENCES} more", highlight=False)
        code = EXIT_FAILED if problems else code
    return code


def _loaded(folder: Path, *, quick: bool = False) -> Study:
    return load_study(folder, figure_kinds(), table_kinds(), quick=quick)


def _found(root: Path) -> list[Path]:
    return sorted(path.parent for path in root.glob(f"*/{FILE_NAME}"))


def _run_one(study: Study, options: Options, invocation: Invocation) -> int:
    folder = options.out
    if folder is None:
        name = study.folder.resolve().name
        folder = QUICK_FOLDER / name if options.quick else study.folder
    store = options.store or study.folder.resolve().parent / CACHE_NAME
    try:
        check_writable(folder)
        if not options.redraw:
            _make_results(study, folder, store if options.keep else None, invocation, options.quiet)
        written = _draw(study, folder, Console(stderr=True, quiet=options.quiet))
    except KeyboardInterrupt:
        kept = (
            "finished jobs and model runs are kept; to go on from there"
            if options.keep
            else ("nothing is kept with --no-store; to start again")
        )
        say(f"interrupted: {kept}: {_words(invocation)}")
        return EXIT_INTERRUPTED
    except (StudyError, ResultsError, SelectionError, FailedRunError, EngineError) as error:
        say(f"error: {error}")
        return EXIT_FAILED
    out = stdout_console(quiet=options.quiet)
    out.print(
        f"{study.title}: {len(study.columns)} tables, {len(study.figures)} figures and "
        f"{written.name} written to {shown_path(folder)}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
    return 0


def _make_results(
    study: Study, folder: Path, cache: Path | None, invocation: Invocation, quiet: bool
) -> None:
    """Run everything, and write tables and record."""
    terminal = Console(stderr=True, quiet=quiet)
    runner = StudyRunner(study, cache)
    with notice_if_slow(COMPILING, terminal):
        for name, problem in runner.problems.items():
            if study.problems[name].is_ours:
                run_once(problem)
    with ComparisonProgressBar([job.title for job in runner.jobs()], terminal) as bar:

        def progress(title: str, n_evals: int, expected: int | None) -> None:
            invocation.interrupts.check()
            bar(title, n_evals, expected)

        runner = replace(runner, progress=progress)
        # without a record, tables of an interrupted run are not taken for results
        (folder / FOLDER / RECORD_NAME).unlink(missing_ok=True)
        entries = [write_table(folder, table) for table in runner.tables()]
    words = ["study", "run", shown_path(study.folder), *(["--quick"] if study.quick else [])]
    write_record(folder, study, shown_command(words), entries)
    kept = {f"{entry.name}.csv" for entry in entries}
    for path in (folder / FOLDER).glob("*.csv"):
        if path.name not in kept:
            path.unlink()


def _draw(study: Study, folder: Path, terminal: Console) -> Path:
    """Draw figures and write the report from results; a terminal is told which figure."""
    record = read_record(folder)
    if record.study != study.digest:
        raise ResultsError(
            f"the results are those of another {FILE_NAME}: run the study without --redraw"
        )
    results = read_tables(folder, study.columns)
    with terminal.status("drawing") as status:
        shown, _ = write_exhibits(
            study, results, folder, lambda name: status.update(f"drawing {name}")
        )
    return write_page(study, record, results, shown, folder)


def _check_one(study: Study, store: Path | None, invocation: Invocation, *, run: bool) -> list[str]:
    """Give what is wrong with a study and its results, in words."""
    state = results_state(study)
    if state != "present":
        return [f"results: {state}; uqfold study run {shown_path(study.folder)}"]
    committed = read_tables(study.folder, study.columns)
    if not run:
        return []
    quick = _loaded(study.folder, quick=True)
    cache = store or study.folder.resolve().parent / CACHE_NAME
    problems: list[str] = []
    with tempfile.TemporaryDirectory() as temporary:
        _make_results(quick, Path(temporary), cache, invocation, quiet=False)
        fresh = read_tables(Path(temporary), quick.columns)
    compared = 0
    adaptive = [label for label, method in study.methods.items() if method.adaptive]
    for name, columns in study.columns.items():
        found = compare_tables(
            committed[name], fresh[name], columns, study.identities[name], study.check, adaptive
        )
        compared += found.numbers
        problems += [f"{name}: {difference}" for difference in found.differences]
    if compared == 0:
        problems.append("no number could be compared: give the reduced form points of the full one")
    return problems


def _words(invocation: Invocation) -> str:
    import shlex

    return shlex.join(["uqfold", *invocation.words])
