"""Reports of studies and of the validation, as pages; and the paper, cited wherever it is named.

Reports lie outside this folder, beside what made them. They are copied in as a build begins, and
links to them are led there as pages are read.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

COPIES = "made"
PAPER = "paper"
_NAMED = re.compile(r"\b[Tt]he paper\b")
_TO_REPORT = re.compile(r"\]\((?:\.\./)+((?:studies|validation)/[\w/-]*report\.md)")
_ANCHOR = re.compile(r'<a id="([\w-]+)"></a>')
_TO_PAGE = re.compile(r"\]\((?:\.\./)+docs/")


def setup(app: Any) -> dict[str, bool]:
    """Copy reports before pages are sought, and change pages as they are read."""
    app.connect("config-inited", lambda app, _: copied(Path(app.srcdir)))
    app.connect("source-read", _changed)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def copied(docs: Path) -> None:
    """Copy all reports with their figures."""
    shutil.rmtree(docs / COPIES, ignore_errors=True)
    for report in [*docs.parent.glob("studies/*/report.md"), docs.parent / "validation/report.md"]:
        place = docs / COPIES / report.parent.relative_to(docs.parent)
        place.mkdir(parents=True)
        text = _ANCHOR.sub(r"(\1)=", report.read_text(encoding="utf-8"))
        (place / report.name).write_text(f"---\norphan: true\n---\n\n{text}", encoding="utf-8")
        if (report.parent / "figures").is_dir():
            shutil.copytree(report.parent / "figures", place / "figures")


def _changed(app: Any, docname: str, source: list[str]) -> None:
    up = "../" * docname.count("/")
    text = _TO_REPORT.sub(rf"]({up}{COPIES}/\1", source[0])
    text = _TO_PAGE.sub(f"]({up}", text)
    if docname != PAPER and _NAMED.search(text):
        text += f"\n\n---\n\n*[The paper]({up}{PAPER}.md)*: {cited(Path(app.srcdir))}\n"
    source[0] = text


def cited(docs: Path) -> str:
    """Return how the paper is cited: the quoted lines of its page."""
    lines = (docs / f"{PAPER}.md").read_text(encoding="utf-8").splitlines()
    return " ".join(line.removeprefix("> ") for line in lines if line.startswith("> "))
