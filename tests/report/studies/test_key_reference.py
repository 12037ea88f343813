"""The documentation shows the keys that the program reads."""

from pathlib import Path

from uqfold.report.studies.key_reference import BEGIN, END, key_reference

PAGE = Path(__file__).parents[3] / "docs" / "studies.md"


def test_docs_hold_the_present_reference() -> None:
    text = PAGE.read_text(encoding="utf-8")
    held = text[text.index(BEGIN) : text.index(END) + len(END)] + "\n"
    assert held == key_reference(), "run `uqfold study keys` and paste it"
