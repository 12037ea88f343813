"""Pages as Markdown: escaped, with their charts beside."""

import re
import xml.etree.ElementTree as ET

import pytest

from tests.report.page.test_html import HOSTILE, page
from uqfold.report.page import page_markdown
from uqfold.report.page.blocks import (
    Cell,
    Code,
    Column,
    Formula,
    Page,
    Paragraph,
    Row,
    Section,
    Table,
)

TRAPS = [
    "<img src=x onerror=stolen()>",
    "[click](javascript:stolen())",
    "![x](http://example.org/x.png)",
    "a | b",
    "`code` ``more``",
    "*not* _stressed_ ~~struck~~",
    "$x$",
    "# no heading",
    "line\n# no heading\n\n- no list",
    "&lt;script&gt;",
    "https://example.org and www.example.org and me@example.org",
]


def written(text: str) -> str:
    table = Table("t", (Column("a"), Column("b")), (Row((Cell(text), Cell([Code(text)]))),))
    one = Page("title", "", "lead", (), (Section("s", "section", (Paragraph(text), table)),))
    return page_markdown(one, "report")[""]


@pytest.mark.parametrize("text", TRAPS)
def test_a_text_stays_one_text(text: str) -> None:
    lines = written(text).splitlines()
    assert [line for line in lines if line.startswith("#")] == ["# title", "## section"]
    (row,) = [line for line in lines if line.startswith("|")][2:]
    # two cells, whatever bars the text holds
    assert len(re.findall(r"(?<!\\)\|", row)) == 3
    outside = re.sub(r"(`+).*?\1", "", "\n".join(lines))
    assert not re.search(r"<(?!!-- -->)", outside)
    assert "](" not in re.sub(r"\\.", "", outside)
    assert not re.search(r"(?i)(https?|www)[:.]", outside)


def test_charts_lie_beside_and_follow_the_scheme() -> None:
    texts = page_markdown(page(), "report")
    assert list(texts) == ["", "report-figures/01.svg", "report-figures/02.svg"]
    assert "![" in texts[""]
    assert "(report-figures/01.svg)" in texts[""]
    root = ET.fromstring(texts["report-figures/01.svg"])
    names = {one.tag.rpartition("}")[2] for one in root.iter()}
    assert "script" not in names
    assert root.findtext("{http://www.w3.org/2000/svg}title") == HOSTILE
    style = root.findtext("{http://www.w3.org/2000/svg}style") or ""
    assert "prefers-color-scheme: dark" in style
    assert "stolen" not in style


def test_equations_are_fenced() -> None:
    assert "```math\n\\frac{a}{b}\n```" in page_markdown(_with_formula(r"\frac{a}{b}"), "r")[""]
    assert "```math" not in page_markdown(_with_formula("x $ y"), "r")[""]


def _with_formula(latex: str) -> Page:
    return Page("t", "", "", (), (Section("s", "s", (Formula("lead", latex),)),))
