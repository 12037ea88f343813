"""Numbers of a study file: what cannot be one is refused with its place."""

import math
import re
from pathlib import Path

import pytest

from uqfold.comparison.studies.document import Place, StudyError, read_document
from uqfold.comparison.studies.grids import NUMBERS, SEEDS
from uqfold.comparison.studies.keys import COUNT, NUMBER

PLACE = Place("study.toml", {}, ("thresholds",))
SPACED = {"start": 0.5, "stop": 0.6, "count": 3}


@pytest.mark.parametrize("key", ["start", "stop", "step"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400])
def test_spaced_numbers_are_finite(key: str, value: float) -> None:
    """``start = nan`` in a study.toml."""
    content = {"start": 0.5, "stop": 0.6, "step": 0.05, key: value}
    with pytest.raises(StudyError, match=re.escape(f"thresholds.{key}: ")):
        NUMBERS.read(content, PLACE)
    assert NUMBERS.read(SPACED, PLACE) == (0.5, 0.55, 0.6)


@pytest.mark.parametrize("value", [math.nan, 10**400])
def test_what_no_float_holds_is_no_number(value: float) -> None:
    with pytest.raises(StudyError, match="give a number that a float can hold"):
        NUMBER.read(value, PLACE)
    with pytest.raises(StudyError, match="thresholds: "):
        COUNT.read(10**400, PLACE)
    with pytest.raises(StudyError, match="seeds: at most"):
        SEEDS.read(10**12, PLACE)


@pytest.mark.parametrize(
    ("text", "message"),
    [("a = " + "[" * 100_000, "nested too deeply"), ("a = 1" + "0" * 5000, "is no TOML file")],
)
def test_a_file_that_no_parser_takes_is_named(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(StudyError, match=message):
        read_document(tmp_path / "study.toml")
