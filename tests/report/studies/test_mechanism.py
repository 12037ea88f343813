"""The figure kinds of the mechanism: each draws its view, one gives a moving picture."""

import textwrap
from pathlib import Path

import pandas as pd
import pytest
from matplotlib.figure import Figure

from uqfold.comparison.studies.document import StudyError
from uqfold.comparison.studies.loading import load_study
from uqfold.mechanism import WingParameters, motion_table
from uqfold.report.studies.exhibits import write_exhibits
from uqfold.report.studies.registry import figure_kinds, table_kinds

HEAD = """
schema = "uqfold-study/1"
title = "Wing"
question = "How?"
[problems]
[[analysis]]
name = "wing"
kind = "trajectory"
[[figure]]
name = "picture"
table = "wing"
"""


@pytest.fixture(scope="module")
def tables() -> dict[str, pd.DataFrame]:
    return {"wing": pd.DataFrame(motion_table(WingParameters()))}


def drawn(folder: Path, keys: str, tables: dict[str, pd.DataFrame]) -> list[Path]:
    (folder / "study.toml").write_text(HEAD + textwrap.dedent(keys), encoding="utf-8")
    study = load_study(folder, figure_kinds(), table_kinds())
    return write_exhibits(study, tables, folder)[1]


@pytest.mark.parametrize(
    "keys",
    [
        'kind = "mechanism"\ntimes = [0.1, 0.2]',
        *(
            f'kind = "motion"\nview = "{view}"'
            for view in ("crank-angle", "forces", "penetrations", "journals")
        ),
    ],
)
def test_figures_are_written_as_png_and_svg(
    tmp_path: Path, keys: str, tables: dict[str, pd.DataFrame]
) -> None:
    paths = drawn(tmp_path, keys, tables)
    assert [path.name for path in paths] == ["picture.png", "picture.svg"]
    assert paths[0].read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_views_differ(tables: dict[str, pd.DataFrame]) -> None:
    kind = figure_kinds()["motion"]
    labels = set()
    for view in ("crank-angle", "forces", "penetrations", "journals"):
        figure = kind.call({"table": "wing", "view": view}, tables)
        assert isinstance(figure, Figure)
        labels.add(figure.axes[0].get_ylabel())
    assert len(labels) == 4


def test_animation_is_one_svg_that_the_report_shows(
    tmp_path: Path, tables: dict[str, pd.DataFrame]
) -> None:
    (path,) = drawn(tmp_path, 'kind = "animation"\nslowdown = 5', tables)
    assert path.name == "picture.svg"
    text = path.read_text(encoding="utf-8")
    assert "<animate" in text
    assert "5 times slower" in text
    assert figure_kinds()["animation"].picture == "svg"


def test_other_tables_are_refused(tmp_path: Path, tables: dict[str, pd.DataFrame]) -> None:
    keys = 'kind = "motion"\nview = "forces"\n[[figure]]\nname = "x"\nkind = "mechanism"\n'
    with pytest.raises(StudyError, match="has no column 'time'"):
        drawn(tmp_path, keys + 'table = "problems"', tables)
