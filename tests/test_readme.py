"""The Python code of README and docs runs as printed, and README's commands are found."""

import io
import re
import runpy
import shlex
import tomllib
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

from uqfold.cli import main
from uqfold.methods import available

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
PAGES = [
    "docs/analysis.md",
    "docs/evaluation.md",
    "docs/how-to.md",
    "docs/mechanism.md",
    "docs/methods/ffni.md",
    "docs/multifidelity.md",
    "docs/one-answer.md",
    "docs/own-model.md",
    "docs/rare-events.md",
    "docs/records.md",
    "docs/reports.md",
    "docs/structures.md",
    "docs/studies.md",
    "docs/validation.md",
]
LONG = ("docs/analysis.md", "docs/how-to.md")


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.thorough if page in LONG else ()) for page in PAGES],
)
def test_python_code_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    assert blocks, f"{page} shows no Python code"
    monkeypatch.chdir(tmp_path)
    # pages name files of the repository as they are called from its top
    (tmp_path / "validation").symlink_to(ROOT / "validation")
    if "uqfold-results/series" in "".join(blocks):
        with pytest.raises(SystemExit, match="0"):
            main(["compare", "series", "--method", "ffni-spa", "--no-figures", "--quiet"])
    exec(compile("\n".join(blocks), page, "exec"), {"__name__": page})


def test_the_first_comparison_runs_in_twenty_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Five methods on a model of one's own, all within 20 % of the reference; README shows it."""
    monkeypatch.chdir(tmp_path)
    script = ROOT / "docs" / "first_comparison.py"
    code = [line for line in script.read_text(encoding="utf-8").splitlines() if line]
    assert len(code) <= 20
    frame = runpy.run_path(str(script))["frame"]
    assert list(frame["label"]) == frame["label"].unique().tolist()
    assert len(frame) == 5
    assert (frame["error"] < 0.2).all()
    assert "reference_pf" in capsys.readouterr().out
    assert (tmp_path / "first-comparison.png").stat().st_size > 5_000
    (shown,) = BLOCK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    assert script.read_text(encoding="utf-8").endswith(f'"""\n\n{shown}')


def test_table_of_methods_is_that_of_the_registry() -> None:
    text = (ROOT / "docs" / "methods" / "index.md").read_text(encoding="utf-8")
    table = text.split("| method | what it is |")[1].split("\n\n")[0]
    rows = re.findall(r"^\| \[`([a-z-]+)`\]\(\1\.md\) \|", table, re.M)
    # in the registry's order; a new method works before it has a row
    assert rows == [name for name in available() if name in rows]
    assert len(rows) >= 9


def test_links_of_readme_lead_somewhere() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert (ROOT / target).exists(), target


PROGRAM = re.compile(r"(\.venv/bin/)?(uqfold|python3?|pip|pytest|sphinx-build)$")
SCRIPTS = {"pytest": "pytest", "sphinx": "sphinx-build"}
"""Packages of the extras, and the programs of theirs that the page uses."""


def commands(page: str) -> list[list[str]]:
    """Words of every command on a page, in order: those of shell blocks, and those in a text."""
    found = re.findall(r"```sh\n(.*?)```|`([^`\n]+(?:\n[^`\n]+)?)`", page, re.DOTALL)
    lines = [line for block, inline in found for line in (block or inline).strip().splitlines()]
    parts = [part for line in lines for part in line.split("&&")]
    words = [shlex.split(part, comments=True) for part in parts]
    return [one for one in words if len(one) > 1 and PROGRAM.match(one[0])]


def refused(page: str) -> Iterator[str]:
    """Say which commands of a page would not run in a fresh clone, one after the other, and why."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    here, results = {"python3"}, set[str]()
    for words in commands(page):
        program, *arguments = words
        name, shown = Path(program).name, shlex.join(words)
        if program not in here:
            yield f"{shown}: {program} is not found; so far there are {sorted(here)}"
        if arguments == ["-m", "venv", ".venv"]:
            here |= {".venv/bin/python", ".venv/bin/pip"}
        elif name == "pip":
            here |= {f".venv/bin/{script}" for script in project["scripts"]}
            for extra in re.findall(r"[a-z]+", arguments[-1]):
                wanted = {
                    re.split(r"[<>=]", one)[0] for one in project["optional-dependencies"][extra]
                }
                here |= {f".venv/bin/{SCRIPTS[one]}" for one in wanted & set(SCRIPTS)}
        elif arguments[:1] == ["-m"] and f".venv/bin/{arguments[1]}" not in here:
            yield f"{shown}: {arguments[1]} is not installed"
        elif name == "uqfold":
            if said := misunderstood(arguments):
                yield f"{shown}: {said}"
                continue
            if arguments[0] == "compare":
                results.add(f"uqfold-results/{arguments[1]}")
            for folder in (word for word in arguments if "/" in word):
                if folder not in results and not (ROOT / folder).is_dir():
                    yield f"{shown}: nothing has made {folder}"


def misunderstood(arguments: list[str]) -> str:
    """Let the command line take its words apart without doing anything: what it refuses."""
    said = io.StringIO()
    with pytest.raises(SystemExit) as ended, redirect_stdout(said), redirect_stderr(said):
        main([*arguments, "--help"])
    return "" if ended.value.code in (None, 0) else said.getvalue()


def test_commands_of_readme_are_found_and_understood_in_order() -> None:
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(commands(page)) > 9
    assert list(refused(page)) == []


SET_UP = "`python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/uqfold compare series`"


@pytest.mark.parametrize(
    ("command", "why"),
    [
        ("uqfold report uqfold-results/series", "uqfold is not found"),
        (".venv/bin/uqfold report uqfold-results/four-bar", "nothing has made"),
        (".venv/bin/uqfold validate --quickly", "No such option"),
        (".venv/bin/uqfold reports x", "No such command"),
        (".venv/bin/python -m pytest", "pytest is not installed"),
        (".venv/bin/sphinx-build docs docs/_build", "sphinx-build is not found"),
    ],
)
def test_command_that_would_not_run_is_noticed(command: str, why: str) -> None:
    assert list(refused(SET_UP)) == []
    [said] = refused(f"{SET_UP}, then\n\n```sh\n{command}\n```")
    assert why in said
