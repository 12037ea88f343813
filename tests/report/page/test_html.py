"""Pages as HTML: self-contained, escaped, complete without a script."""

import base64
import hashlib
import math
import re
from itertools import pairwise

import pytest

from tests.report.page.reading import Element, read
from uqfold.report.page import page_html
from uqfold.report.page.blocks import (
    Card,
    Cards,
    Cell,
    Code,
    Column,
    Controls,
    Details,
    Facts,
    Figure,
    Formula,
    Items,
    Link,
    Listing,
    Number,
    Page,
    Paragraph,
    Row,
    Section,
    Strong,
    Table,
    View,
)
from uqfold.report.page.chart import Axis, Chart, Key, Point, Series, Strip

HOSTILE = (
    "</title></style></script><script>stolen()</script>\"'><img src=x onerror=stolen()>{{7*7}}"
)
KEY = Key(f"method {HOSTILE}", HOSTILE, "#0072B2", "o")


def chart(text: str = HOSTILE) -> Chart:
    points = tuple(Point(float(i), 10.0**-i, 0.5 * 10.0**-i, 2.0 * 10.0**-i, text) for i in (1, 2))
    return Chart(text, Axis(text), Axis(text, "log"), (Series(KEY, points),), keys=(text,))


def page(text: str = HOSTILE) -> Page:
    """A page with every kind of block, all texts the same."""
    table = Table(
        text,
        (Column(text, choices=True), Column(text, numeric=True), Column(text)),
        (
            Row((Cell(text, key=KEY), Cell([Number("1.5e-4")], 1.5e-4), Cell(text)), keys=(text,)),
            Row((Cell([Link(text, "there")]), Cell("-", math.nan), Cell([Code(text)]))),
            Row(
                (
                    Cell(text, strip=Strip(KEY, (0.1, math.inf), 0.2, (1e-3, 1.0))),
                    Cell("2", 2.0, "good"),
                    Cell(text),
                )
            ),
        ),
    )
    figure = Figure(text, (View(text, (chart(text),)), View("other", (chart(text),))), (KEY,))
    blocks = (
        Paragraph([text, Code(text), Strong(text, "bad"), Link(text, "there"), Number(text)]),
        Items((text,), numbered=True),
        table,
        Facts(((text, text),)),
        figure,
        Controls(((text, (KEY,)),)),
        Formula(text, rf"\text{{{text}}}", text),
        Listing(text),
        Details(text, (Paragraph(text, small=True),)),
        Section("inner", text, (Paragraph(text),), text, "good"),
    )
    return Page(text, text, text, (Cards((Card(text, text, (text,)),)),),
                (Section("there", text, blocks),), text)  # fmt: skip


@pytest.fixture(scope="module")
def document() -> str:
    return page_html(page())


@pytest.fixture(scope="module")
def root(document: str) -> Element:
    return read(document)


def elements(root: Element) -> list[Element]:
    return [root, *(one for child in root.children for one in elements(child))]


def test_what_a_text_holds_stays_text(root: Element) -> None:
    found = elements(root)
    assert root.text.count(HOSTILE) > 20
    assert [one.tag for one in found].count("script") == 1
    assert [one.tag for one in found].count("style") == 1
    assert not [one for one in found if one.tag in ("img", "iframe", "object", "link", "base")]
    assert not [name for one in found for name in one.attributes if name.startswith("on")]
    assert "49" not in root.text
    (script,), (style,) = root.all("script"), root.all("style")
    assert "stolen" not in script.text + style.text


def test_links_stay_in_the_page(root: Element) -> None:
    targets = [one.attributes["href"] for one in elements(root) if "href" in one.attributes]
    assert targets
    assert all(target.startswith("#") for target in targets)
    names = {one.attributes["id"] for one in elements(root) if "id" in one.attributes}
    assert {target[1:] for target in targets} <= names


def test_identifiers_are_unique(root: Element) -> None:
    names = [one.attributes["id"] for one in elements(root) if "id" in one.attributes]
    assert len(names) == len(set(names))


def test_nothing_is_loaded_and_only_what_is_hashed_runs(document: str, root: Element) -> None:
    policy = next(
        one.attributes["content"]
        for one in root.all("meta")
        if one.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    for tag in ("script", "style"):
        (own,) = re.findall(rf"<{tag}>(.*?)</{tag}>", document, flags=re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(own.encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in policy
        # a style attribute would be refused by the policy
    assert not [one for one in elements(root) if "style" in one.attributes]
    addresses = set(re.findall(r"(?i)\b(?:https?|ftp|data|file):[^\s\"'<>)]*", document))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1998/Math/MathML"}
    assert not re.search(r"@import|url\((?!#)", document)


def test_it_can_be_read_without_seeing(root: Element) -> None:
    assert [len(root.all(tag)) for tag in ("main", "nav", "footer", "h1")] == [1, 1, 1, 1]
    assert root.all("html")[0].attributes["lang"] == "en"
    levels = [int(one.tag[1]) for one in elements(root) if re.fullmatch("h[1-6]", one.tag)]
    assert all(after - before <= 1 for before, after in pairwise(levels))
    for table in root.all("table"):
        assert table.all("caption")[0].text
        head, body = table.all("thead")[0], table.all("tbody")[0]
        assert all(cell.attributes["scope"] == "col" for cell in head.all("th"))
        assert all(row.all("th")[0].attributes["scope"] == "row" for row in body.all("tr"))
    for svg in root.all("svg"):
        hidden = svg.attributes.get("aria-hidden") == "true"
        assert hidden or (svg.attributes["role"] == "img" and svg.attributes["aria-label"])
    assert [one for one in elements(root) if one.attributes.get("aria-live") == "polite"]


def test_every_chart_has_its_numbers_as_a_table(root: Element) -> None:
    for figure in root.all("figure"):
        values = next(one for one in figure.all("details") if one.attributes["class"] == "values")
        assert "0.01" in values.text
        assert len(values.all("tr")) == 3


def test_numbers_are_typeset_and_can_be_sorted(root: Element) -> None:
    cells = root.all("table")[0].all("td")
    first, second, *_ = (one for one in cells if "number" in one.attributes.get("class", ""))
    assert first.text.strip() == "1.5 × 10−4"
    assert first.all("sup")[0].text == "−4"
    assert float(first.attributes["data-sort"]) == 1.5e-4
    assert second.attributes["data-sort"] == ""


def test_what_no_document_may_hold_is_replaced() -> None:
    text = page_html(page("a\x00b\ud800c\x1bd"))
    text.encode("utf-8")
    assert not re.search("[\x00-\x08\x0b\x0c\x0e-\x1f]", text)
    assert "a\ufffdb\ufffdc\ufffdd" in text


def test_the_same_page_gives_the_same_file(document: str) -> None:
    assert page_html(page()) == document
