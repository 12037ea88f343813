"""What an HTML file holds, as a browser without scripts would take it."""

from dataclasses import dataclass, field
from html.parser import HTMLParser
from typing import Any

from uqfold.report import Page

VOID = {"meta", "input", "br", "hr", "img", "link", "base"}


@dataclass
class Element:
    tag: str
    attributes: dict[str, str]
    text: str = ""
    children: list["Element"] = field(default_factory=list)

    def all(self, tag: str) -> list["Element"]:
        """Every element of that name below this one."""
        own = [one for child in self.children for one in child.all(tag)]
        return [*([self] if self.tag == tag else []), *own]

    def walk(self) -> list["Element"]:
        """This element and every one below it."""
        return [self, *(one for child in self.children for one in child.walk())]

    @property
    def words(self) -> str:
        """All text below, in order of appearance, without style and script."""
        return self.text if self.tag not in ("style", "script") else ""


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.root = Element("document", {})
        self.open = [self.root]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        element = Element(tag, {name: value or "" for name, value in attrs})
        self.open[-1].children.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open[-1].children.append(Element(tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open[-1].tag == tag, f"</{tag}> closes <{self.open[-1].tag}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        for element in self.open:
            element.text += data


def read(html: str) -> Element:
    """Parse a document; every element has to be closed in order."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    assert reader.open == [reader.root]
    return reader.root


def cards(page: Page) -> dict[str, dict[str, Any]]:
    """The statements of the summary of a page, by their titles."""
    rows = [block["cards"] for block in page.blocks if block["kind"] == "cards"]
    return {card["title"]: card for row in rows for card in row}
