"""The report on a comparison, from records, frames and folders."""

import io
import json
import math
import re
import subprocess
import sys
from copy import deepcopy
from pathlib import Path
from typing import Any

import openturns as ot
import pandas as pd
import pytest
from rich.console import Console

import uqfold
from tests.comparison.fakes import GRID, METHODS, Told, toy_frame
from tests.report.page.reading import Element, read
from uqfold.comparison import RecordsError, write_records
from uqfold.problems.criterion import Binomial, criteria
from uqfold.report import ComparisonTable, report_page, write_report

HOSTILE = "</script><script>stolen()</script><img src=x onerror=stolen()>"


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    return toy_frame()


@pytest.fixture(scope="module")
def small(frame: pd.DataFrame) -> pd.DataFrame:
    return frame[frame["tau"].isna() & (frame["missions"] == "1") & (frame["threshold"] == 12.0)]


@pytest.fixture(scope="module")
def root(frame: pd.DataFrame) -> Element:
    return read(html_of(frame))


def html_of(source: Any) -> str:
    return report_page(source).html()


def section(root: Element, anchor: str) -> Element:
    (found,) = [one for one in root.all("section") if one.attributes.get("id") == anchor]
    return found


def cells(root: Element, anchor: str) -> list[list[str]]:
    body = section(root, anchor).all("tbody")[0]
    return [[cell.text.strip() for cell in row.children] for row in body.all("tr")]


def test_every_row_of_the_records_is_in_the_table(frame: pd.DataFrame, root: Element) -> None:
    rows = cells(root, "all-answers")
    assert len(rows) == len(frame)
    for shown, row in zip(rows, frame.to_dict("records"), strict=True):
        assert shown[0] == row["label"]
        assert float(shown[1]) == row["threshold"]
        assert (shown[4] == "-") == math.isnan(row["pf"])
        assert row["status"].replace("_", " ") in shown


def test_what_methods_say_is_said_once(root: Element) -> None:
    said = [row[-1] for row in cells(root, "remarks")]
    assert said.count("ArithmeticError: a pole [at zero]") == 1
    assert said.count("told not to answer tau") == 1


def test_the_figure_holds_every_answer(frame: pd.DataFrame, root: Element) -> None:
    groups = [one for one in section(root, "curves").all("g") if "data-gid" in one.attributes]
    titles = {
        id(t): t.text for group in groups for use in group.all("use") for t in use.all("title")
    }
    assert len(titles) == frame["pf"].notna().sum() + len(GRID)
    for threshold in frame["threshold"]:
        assert any(text.startswith(f"T = {threshold:g} mm, ") for text in titles.values())


def test_the_methods_section_says_what_was_run(root: Element) -> None:
    text = " ".join(section(root, "methods").text.split())
    assert "toy: 3 units, all of which must work" in text
    assert "Normal(mu = 0, sigma = 1)" in text
    assert "binomial(3, 0.7)" in text
    assert "5,000 evaluations" in text
    assert "Quadrature." in text
    assert "Knows the answer, and errs as told." in text
    assert "Somebody. How to answer as told. 2020." in text
    assert "Eq. (37)" in text
    assert "synchronized" in text
    assert len(section(root, "methods").all("math")) >= 5
    again = " ".join(section(root, "reproduction").text.split())
    assert "uqfold compare toy" in again
    assert f"uqfold {uqfold.__version__}" in again


def test_two_lines_of_python_make_a_report(tmp_path: Path) -> None:
    methods, one = ["ffni-spa", "ffni-pearson"], uqfold.criteria(4.0)
    frame = uqfold.compare(uqfold.problems.series(), methods, one)
    (path,) = uqfold.report.write_report(frame, tmp_path / "deep" / "report.html")
    root = read(path.read_text(encoding="utf-8"))
    assert "nodes_individual" in section(root, "methods").text
    references = [item.text for item in section(root, "references").all("li")]
    assert references[1].startswith("Lugannani")
    assert "References 1, 2, 3." in " ".join(section(root, "method-1").text.split())
    # what both methods cite is listed once
    assert len(references) == len(set(references)) == 5
    assert "References 1, 4, 5." in " ".join(section(root, "method-2").text.split())


def test_folder_and_frame_give_one_report(small: pd.DataFrame, tmp_path: Path) -> None:
    write_records(small, tmp_path)
    pages = [report_page(one) for one in (tmp_path, tmp_path / "comparison.json", small)]
    first, *others = [page.markdown() for page in pages]
    assert others == [first, first]
    assert pages[0].html() == pages[2].html()


def test_a_frame_without_its_header_still_gives_a_report(small: pd.DataFrame) -> None:
    bare = small.copy()
    bare.attrs.clear()
    root = read(html_of(bare))
    assert "not recorded" in section(root, "methods").text
    assert len(cells(root, "all-answers")) == len(small)


def spoiled(value: Any) -> Any:
    """Put markup into every text of a JSON document that may hold any text."""
    if isinstance(value, dict):
        kept = ("schema", "missions", "status", "error_kind", "label")
        return {k: v if k in kept else spoiled(v) for k, v in value.items()}
    if isinstance(value, list):
        return [spoiled(one) for one in value]
    return f"{value}{HOSTILE}" if isinstance(value, str) and value not in ("inf", "-inf") else value


def test_records_full_of_markup_give_a_report_full_of_text(
    small: pd.DataFrame, tmp_path: Path
) -> None:
    _, path = write_records(small, tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    columns = document["columns"]
    # whoever makes up a record can leave its digest out
    del document["sha256"]
    document = spoiled(document)
    document["columns"] = columns
    for entry in [*document["methods"], *document["rows"]]:
        entry["label"] += HOSTILE
    path.write_text(json.dumps(document), encoding="utf-8")
    root = read(html_of(path))
    assert root.text.count(HOSTILE) > 50
    assert len(root.all("script")) == 1
    assert root.all("img") == []
    (report, *_) = write_report(path, tmp_path / "report.md")
    # within code Markdown knows no markup
    outside = re.sub(r"(?s)(`+).*?\1", "", report.read_text(encoding="utf-8"))
    assert "stolen" in outside
    assert "<script" not in outside


def test_nothing_that_records_name_is_imported_and_no_window_is_involved(
    small: pd.DataFrame, tmp_path: Path
) -> None:
    named = small.assign(method="antigravity")
    header = deepcopy(small.attrs["uqfold-comparison"])
    for entry in header["methods"]:
        entry |= {"method": "antigravity", "settings": "this.that(import='antigravity')"}
    named.attrs["uqfold-comparison"] = header
    write_records(named, tmp_path)
    code = (
        "import sys, uqfold.report\n"
        f"uqfold.report.write_report({str(tmp_path)!r}, {str(tmp_path / 'r.html')!r})\n"
        "print([m for m in sys.modules if m in ('antigravity', 'this', 'numba', 'openturns',\n"
        "       'matplotlib.pyplot')\n"
        "       or m.startswith('uqfold.methods.openturns')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("grid", "methods"),
    [
        (criteria(12.0), {"exact": Told(), "broken": METHODS["broken"]}),
        (criteria(12.0, missions=[1, Binomial(3, 0.7)]), {"sampled": METHODS["sampled"]}),
        (criteria([11.0, 12.0]), {"broken": METHODS["broken"]}),
        (criteria([-math.inf, 12.0, math.inf], tau=[None, 0.0]), {"broken": METHODS["broken"]}),
        (criteria([12.0, 13.0]), {f"told-{i}": Told(bias=0.1 * i) for i in range(8)}),
    ],
    ids=["one threshold", "one method", "no answer", "infinite thresholds", "eight methods"],
)  # fmt: skip
@pytest.mark.parametrize("referenced", [True, pytest.param(False, marks=pytest.mark.thorough)])
def test_reports_of_unusual_comparisons(grid: Any, methods: Any, referenced: bool) -> None:
    finite = all(math.isfinite(one.threshold) for one in grid)
    frame = toy_frame(grid, methods, referenced=referenced and finite)
    root = read(html_of(frame))
    assert len(cells(root, "all-answers")) == len(frame)
    assert not re.search(r"(?<![\w-])nan(?!\w)", root.all("main")[0].text)


def test_an_interrupted_comparison_says_what_is_missing(small: pd.DataFrame) -> None:
    part = small[small["label"].isin(["exact", "biased"])]
    part.attrs["uqfold-comparison"] = {
        **small.attrs["uqfold-comparison"], "finished": ["exact", "biased"]
    }  # fmt: skip
    assert "Interrupted: no rows of sampled, broken." in report_page(part).markdown()


def test_what_is_no_record_is_refused(tmp_path: Path) -> None:
    (tmp_path / "comparison.json").write_text("{}", encoding="utf-8")
    with pytest.raises(RecordsError, match="not a readable record"):
        report_page(tmp_path)
    with pytest.raises(ValueError, match=r"choose from '\.html', '\.md'"):
        write_report(toy_frame(), tmp_path / "report.pdf")


def test_more_rows_than_a_page_can_show_are_refused(frame: pd.DataFrame) -> None:
    """A frame of 1e5 rows took minutes, and made a page of 180 MB."""
    with pytest.raises(ValueError, match=r"has 20,000 rows, a report shows 10,000 at most: select"):
        report_page(frame.iloc[[0] * 20_000])


def test_one_answer_is_and_several_are(small: pd.DataFrame) -> None:
    """One doubtful answer "is doubtful", two "are"."""
    one, two = small.copy(), small.copy()
    one["status"] = two["status"] = "converged"
    one.iloc[0, one.columns.get_loc("status")] = "doubtful"
    two.iloc[:2, two.columns.get_loc("status")] = "doubtful"
    assert f"1 of {len(small)} is doubtful" in report_page(one).markdown()
    assert f"2 of {len(small)} are doubtful" in report_page(two).markdown()


def test_a_limit_state_of_ones_own_shows_pf_first_and_is_one_criterion() -> None:
    """It was "T = -4.94066e-324" of a "response: response", with pf far below the first screen."""
    problem = uqfold.Problem.from_limit_state(lambda x: 2.0 - x[:, 0], ot.Normal(2))
    frame = uqfold.compare(problem, ["mc", "openturns-form"], max_evals=2000)
    page = report_page(frame)
    text = page.markdown()
    first_screen = text[: text.index("## ")]
    pf = frame["pf"].iloc[1]
    assert f"How likely is failure? **pf = {pf:.4f}**" in first_screen
    assert f"| {pf:.5f} |" in first_screen
    assert "criteria" not in first_screen
    table = io.StringIO()
    Console(file=table, width=80).print(ComparisonTable(frame))
    for said in (text, table.getvalue()):
        assert "e-324" not in said
        assert "10⁻³²⁴" not in said
        assert "response: response" not in said
    assert "g &lt;= 0" in text
    assert table.getvalue().startswith("limit state: seed 0, at most 2,000")
    assert "\ng <= 0, 1 mission   no reference\n" in table.getvalue()


def test_several_criteria_without_a_reference_show_the_range_of_pf() -> None:
    frame = toy_frame(methods={"biased": Told(bias=0.2), "exact": Told()}, referenced=False)
    text = report_page(frame).markdown()
    assert "How likely is failure? **pf = " in text
    assert " to " in text[text.index("**pf = ") :].split("**")[1]
