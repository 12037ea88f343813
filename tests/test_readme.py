"""The Python code of README and docs runs as printed."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from uqfold.methods import available

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
PAGES = [
    "README.md",
    "docs/analysis.md",
    "docs/evaluation.md",
    "docs/mechanism.md",
    "docs/records.md",
    "docs/reports.md",
    "docs/studies.md",
    "docs/validation.md",
]


@pytest.mark.parametrize("page", PAGES)
def test_python_code_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    assert blocks, f"{page} shows no Python code"
    monkeypatch.chdir(tmp_path)
    # pages name files of the repository as they are called from its top
    (tmp_path / "validation").symlink_to(ROOT / "validation")
    if "uqfold-results/series" in "".join(blocks):
        arguments = ["compare", "series", "--method", "ffni-spa", "--no-figures"]
        command = [sys.executable, "-m", "uqfold", *arguments]
        subprocess.run(command, check=True, capture_output=True)
    exec(compile("\n".join(blocks), page, "exec"), {"__name__": page})


def test_table_of_methods_is_that_of_the_registry() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    table = text.split("| method | what it is |")[1].split("\n\n")[0]
    assert re.findall(r"^\| `([a-z-]+)` \|", table, re.MULTILINE) == list(available())


def test_links_of_readme_lead_somewhere() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert (ROOT / target).exists(), target
