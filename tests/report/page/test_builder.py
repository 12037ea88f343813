"""The page builder: what is told comes out whole, escaped and in order, in both formats."""

import math
import re
from pathlib import Path

import pandas as pd
import pytest
from matplotlib.figure import Figure

from tests.report.page.reading import read
from uqfold.plots.style import figure_settings
from uqfold.plots.telling import gid, tell
from uqfold.report import Page, literal
from uqfold.report.page.cells import number_text, value_text
from uqfold.report.page.markup import html, inline_html

HOSTILE = (
    "</title></style></script><script>stolen()</script>\"'><img src=x onerror=stolen()>{{7*7}}"
)


def figure(text: str = "pf") -> Figure:
    with figure_settings():
        drawn = Figure(figsize=(5.0, 3.0), layout="constrained")
        axes = drawn.subplots()
        (line,) = axes.plot([1.0, 2.0, 3.0], [1e-3, math.nan, 0.1], "o-", color="#0072B2")
        tell(line, gid(method=text), [f"{text} at 1", "a gap", f"{text} at 3"])
        axes.set(yscale="log", xlabel="T (s)", ylabel=text, title=text)
    return drawn


def page(text: str = HOSTILE) -> Page:
    """A page with every kind of block, all texts the same."""
    made = Page(text, literal(text), kind=text, imprint=literal(text))
    made.card(text, literal(text), literal(text), tone="good")
    made.section(text, label=text, tone="bad")
    made.text(f"{literal(text)}\n\n- **{literal(text)}**\n- `code`")
    made.text(text, small=True)
    frame = pd.DataFrame({text: [text, "other"], "pf": [1.5e-4, math.nan], "n": [40_000, 7]})
    made.table(frame, text, literal(text), belongs=[gid(method=text), ""])
    made.figure(figure(text), text, literal(text))
    made.section(text, level=2)
    made.facts({text: literal(text)})
    made.equation(rf"\text{{{text}}}", literal(text), text)
    with made.details(text):
        made.code(text)
    return made


def test_what_a_text_holds_stays_text_in_html() -> None:
    root = read(page().html())
    found = [one for one in root.walk() if one.tag in ("script", "style", "img", "iframe")]
    assert sorted(one.tag for one in found) == ["script", "style"]
    assert root.text.count(HOSTILE) > 15
    assert "49" not in root.text
    attributes = [name for one in root.walk() for name in one.attributes]
    assert not [name for name in attributes if name.startswith("on") or name == "style"]


def test_what_a_text_holds_stays_text_in_markdown() -> None:
    text = page().markdown()
    outside = re.sub(r"(?s)(`+).*?\1", "", text)
    assert "stolen" in outside
    assert "<script" not in outside
    assert "<img" not in outside


def test_the_blocks_come_in_order_in_both_formats() -> None:
    made = Page("Title")
    for i in range(3):
        made.section(f"Part {i}")
        made.text(f"Said {i}.")
    made.section("Inner", level=2)
    for text in (made.html(), made.markdown()):
        at = [text.index(f"{what} {i}") for i in range(3) for what in ("Part", "Said")]
        # contents come before everything in HTML
        assert at[1::2] == sorted(at[1::2])
    inner = next(one for one in read(made.html()).all("section")
                 if one.attributes.get("id") == "part-2")  # fmt: skip
    assert [one.text for one in inner.all("h3")] == ["Inner"]
    assert "### Inner" in made.markdown()


def test_a_figure_lies_beside_markdown_and_inside_html(tmp_path: Path) -> None:
    made = Page("Title")
    made.figure(figure(), "Curves of pf")
    report, picture = made.write(tmp_path / "deep" / "report.md")
    assert picture == tmp_path / "deep" / "figures" / "curves-of-pf.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert "(figures/curves-of-pf.png)" in report.read_text(encoding="utf-8")
    (file,) = made.write(tmp_path / "report.html")
    root = read(file.read_text(encoding="utf-8"))
    (svg,) = [one for one in root.all("svg") if one.attributes.get("class") == "chart"]
    assert "Curves of pf" in svg.attributes["aria-label"]
    assert "pf over T (s)" in svg.attributes["aria-label"]
    (group,) = [one for one in svg.all("g") if "data-gid" in one.attributes]
    assert group.attributes["data-gid"] == "method=pf"
    # the gap is not drawn, and the texts stay with their points
    assert [one.all("title")[0].text for one in group.all("use")] == ["pf at 1", "pf at 3"]
    values = next(one for one in root.all("details") if one.attributes.get("class") == "values")
    assert len(values.all("tr")) == 3


def test_a_figure_comes_out_of_a_page_as_it_was() -> None:
    drawn, made = figure(), Page("Title")
    made.figure(drawn, "Curves")
    assert made.html() == made.html()
    assert [line.get_gid() for line in drawn.axes[0].lines] == ["method=pf"]


def test_two_figures_share_no_identifier() -> None:
    made = Page("Title")
    for _ in range(2):
        made.figure(figure().axes[0], "Curves")
    root = read(made.html())
    names = [one.attributes["id"] for one in root.walk() if "id" in one.attributes]
    assert len(names) == len(set(names))
    used = {one.attributes["href"][1:] for one in root.all("use")}
    assert used
    assert used <= set(names)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0123456, "0.01235"),
        (1.23456e-7, "1.235 × 10⁻⁷"),
        (-2.5e-5, "−2.5 × 10⁻⁵"),
        (40_000, "40,000"),
        (250.0, "250"),
        (1e300, "1 × 10³⁰⁰"),
        (1.0 - 2.0e-9, "1 − 2 × 10⁻⁹"),
        (1.0, "1"),
        (math.inf, "inf"),
        (math.nan, ""),
        (None, ""),
        (True, "yes"),
        ("mc", "mc"),
    ],
)  # fmt: skip
def test_values_of_tables(value: object, shown: str) -> None:
    assert value_text(value) == shown


def test_digits_are_rounded_not_cut() -> None:
    assert number_text(0.0099996, 4) == "0.01"
    assert number_text(9.9996e-6, 4) == "1 × 10⁻⁵"


@pytest.mark.parametrize(
    "target", ["javascript:stolen()", "data:text/html,x", "//example.org", "JaVaScRiPt:x"]
)
def test_links_lead_only_where_nothing_runs(target: str) -> None:
    assert "<a" not in inline_html(f"[click]({target})")
    assert inline_html("[click](#there)") == '<a href="#there">click</a>'


@pytest.mark.parametrize(
    "text",
    [
        "*a* `b` [c](d)", "a * b", "``x``", "\\*", "[1]", "2**3**4", "- a", "1. a", "---", "# a",
        "_a_", "<b>a</b>", "&lt;", "![a](b)", "~~a~~", "http://a.b",
    ],
)  # fmt: skip
def test_literal_text_is_only_text(text: str) -> None:
    (paragraph,) = read(html(literal(text))).children
    assert paragraph.tag == "p"
    assert paragraph.children == []
    assert paragraph.text == text


def test_a_text_is_markdown_in_both_formats() -> None:
    """Texts had a little language of their own, which was read twice."""
    made = Page("Title")
    made.text("1. one\n   - *inner*\n2. `<b>` <b>two</b>\n\n> quoted")
    root = read(made.html()).all("main")[0]
    assert [one.tag for one in root.all("ol")[0].all("ul")[0].walk()] == ["ul", "li", "em"]
    assert root.all("blockquote")[0].text.strip() == "quoted"
    assert root.all("b") == []
    assert "2. `<b>` &lt;b>two&lt;/b>" in made.markdown()


def test_a_bar_ends_no_cell_of_markdown() -> None:
    made = Page("Title")
    made.facts({"a|b": "`c|d`", "e": literal("f|g")})
    assert made.markdown().splitlines()[-2:] == [r"| a\|b | `c\|d` |", r"| e | f\|g |"]


def test_what_is_no_frame_or_figure_is_refused() -> None:
    made = Page("Title")
    with pytest.raises(TypeError, match=r"frame = .*: give a pandas DataFrame"):
        made.table([[1]], "t")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="figure = 3: give a Figure or Axes"):
        made.figure(3, "t")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="give one name for each of 2 rows"):
        made.table(pd.DataFrame({"a": [1, 2]}), "t", belongs=["method=a"])
    with pytest.raises(ValueError, match=r"suffix of path = '\.pdf': choose from"):
        made.write("report.pdf")
