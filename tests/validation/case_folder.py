"""A small case on disk, for tests."""

from pathlib import Path

DECLARED = '''schema = "uqfold-case/1"
topic = "methods"
title = "A case"
claim = """It is
so."""
kind = "exact solution"
compared_with = "the truth"
uncertainty = "none"
source = "mathematics"
seeds = [7]
tolerance = "2, since 2 is enough"
verdict_rule = "the value keeps the limit"

[[fault]]
name = "too large"
what = "a value of 3"
'''

MEASURE = """from uqfold.validation import Finding, Measurement


def measure(work):
    value = 3.0 if work.fault == "too large" else 1.0
    return Measurement([Finding("value", value, 2.0), Finding("seed", work.seeds[0])])
"""


def make_case(
    root: Path, name: str = "a_case", declared: str = DECLARED, measure: str = MEASURE
) -> Path:
    """Write a case below a folder of cases, and return its own."""
    folder = root / name
    folder.mkdir(parents=True)
    (root / "__init__.py").touch()
    (folder / "case.toml").write_text(declared, encoding="utf-8")
    (folder / "measure.py").write_text(measure, encoding="utf-8")
    return folder
