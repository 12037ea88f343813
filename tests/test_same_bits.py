"""Results are promised to the last bit on the same processor only.

Another one adds in another order, or has other elementary functions.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PROMISE = re.compile(r"to the last bit|bit for bit|same bits|bit-identical|bitwise", re.IGNORECASE)
KEPT = re.compile(
    r"written|reads? back|same inputs|these inputs|numbers are kept|two results agree"
    r"|that give the same response"
)
"""Numbers that are stored, read or compared: nobody computes them anew."""


def texts() -> Iterator[tuple[str, str]]:
    """Where a text stands and the text: README, pages of the documentation, public docstrings."""
    for page in [
        ROOT / "README.md",
        *sorted(DOCS.glob("*.md")),
        *sorted(DOCS.glob("methods/*.md")),
    ]:
        yield page.name, page.read_text(encoding="utf-8")
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for path in sorted((ROOT / "uqfold").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            name = getattr(node, "name", "module")
            if isinstance(node, documented) and not name.startswith("_"):
                place = f"{path.relative_to(ROOT)}: {name}"
                yield place, ast.get_docstring(node) or ""


def unbounded(text: str) -> list[str]:
    """Sentences that promise the same bits of what is computed, whatever the processor."""
    sentences = re.split(r"(?<=[.:])\s+(?=[A-Z`*])|\n\s*\n", text)
    plain = (" ".join(sentence.split()) for sentence in sentences)
    return [
        one
        for one in plain
        if PROMISE.search(one) and "same processor" not in one and not KEPT.search(one)
    ]


def test_the_last_bit_is_promised_on_the_same_processor_only() -> None:
    found = {place: promises for place, text in texts() if (promises := unbounded(text))}
    assert found == {}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("The same seed gives the same\nnumbers, to the last bit, with or without a store.", 1),
        ("On the same processor the same seed gives the same numbers to the last bit.", 0),
        ("It is fast.\n\nBoth loops give the same bits. Each on the same processor.", 1),
        ("The numbers are the written ones to the last bit.", 0),
    ],
)
def test_the_check_of_promises_can_fail(text: str, found: int) -> None:
    assert len(unbounded(text)) == found
