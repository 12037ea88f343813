"""Study files: what they say, and errors that name line, key and remedy."""

from pathlib import Path

import pytest

from uqfold.comparison.studies import Study, StudyError, load_study
from uqfold.comparison.studies.document import nearest, read_document
from uqfold.methods import FFNIPearson
from uqfold.problems.criterion import Binomial
from uqfold.report.studies import figure_kinds, table_kinds

GOOD = """\
schema = "uqfold-study/1"
title = "A study"
question = "How sure are we?"

[problems.series]
case = "series"

[problems.crossed]
case = "four-bar"
options = { branch = "crossed" }
units = 3

[methods.fine]
method = "ffni-pearson"
settings = { nodes_shared = 5, nodes_individual = [
  7,
  5,
] }

[[run]]
name = "body"
problem = ["series", "crossed"]
methods = ["ffni-spa", "fine"]
thresholds = { start = 0.53, stop = 0.59, step = 0.0025 }
tau = ["none", 16]
missions = [1, { planned = 10, p = 0.7 }]
max_evals = [100, 200]
seeds = 2
quick = { thresholds = 0.53, max_evals = 100 }

[[run]]
name = "tail"
problem = "series"
methods = "mc"
thresholds = { start = 4, stop = 8, count = 3 }

[[figure]]
name = "curves"
kind = "reliability"
table = "body"
where = { missions = "1" }
curves = "tau"
"""


def loaded(folder: Path, text: str, *, quick: bool = False) -> Study:
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return load_study(folder, figure_kinds(), table_kinds(), quick=quick)


def test_a_good_file(tmp_path: Path) -> None:
    study = loaded(tmp_path, GOOD)
    body, tail = study.runs
    assert [one.threshold for one in body.criteria[:3]] == [0.53, 0.5325, 0.535]
    assert body.criteria[24].threshold == 0.59
    assert len(body.criteria) == 25 * 2 * 2
    assert {one.missions for one in body.criteria} == {1, Binomial(10, 0.7)}
    assert {one.tau for one in body.criteria} == {None, 16.0}
    assert (body.budgets, body.seeds) == ((100, 200), (0, 1))
    assert [one.threshold for one in tail.criteria] == [4.0, 6.0, 8.0]
    assert tail.budgets == (None,)
    assert study.methods["fine"] == FFNIPearson(nodes_shared=5, nodes_individual=(7, 5))
    crossed = study.problems["crossed"].build()
    assert (crossed.name, crossed.n_units, crossed.references) == ("four-bar-crossed", 3, None)


def test_the_reduced_form_replaces_keys(tmp_path: Path) -> None:
    body, tail = loaded(tmp_path, GOOD, quick=True).runs
    assert {one.threshold for one in body.criteria} == {0.53}
    assert body.budgets == (100,)
    assert len(tail.criteria) == 3


@pytest.mark.parametrize(
    ("old", "new", "line", "key", "words"),
    [
        ('case = "series"', 'cas = "series"', 6, "problems.series.cas", "did you mean 'case'?"),
        ('case = "series"', 'case = "serie"', 6, "problems.series.case", "mean 'series'?"),
        ('"crossed" }', '"cros" }', 10, "problems.crossed.options", "'open', 'crossed'"),
        ("branch =", "brunch =", 10, "problems.crossed.options.brunch", "'branch'"),
        ('"ffni-pearson"', '"ffni-person"', 14, "methods.fine.method", "'ffni-pearson'?"),
        ("nodes_shared = 5", "node_shared = 5", 15, "methods.fine.settings", "'nodes_shared'"),
        ("nodes_shared = 5", "nodes_shared = 0", 15, "methods.fine.settings", "nodes_shared = 0"),
        ("step = 0.0025", "step = 0.007", 24, "run[1].thresholds.step", "whole number of steps"),
        ("step = 0.0025", "stop = 1.0", 24, "", "no TOML"),
        ('"none", 16', '"non", 16', 25, "run[1].tau[1]", "the text none"),
        ("p = 0.7", "p = 1.7", 26, "run[1].missions[2]", "give a probability in [0, 1]"),
        ("[100, 200]", "[100, 100]", 27, "run[1].max_evals[2]", "occurs twice"),
        ("seeds = 2", "seeds = 0", 28, "run[1].seeds", "whole number >= 1"),
        (
            "quick = { thresholds",
            "quick = { treshold",
            29,
            "run[1].quick.treshold",
            "'thresholds'?",
        ),
        ("quick = { thresholds = 0.53", 'quick = { thresholds = "x"', 29, "run[1].quick", "number"),
        ('name = "tail"', 'name = "body"', 1, "", "'body' occurs twice"),
        ('name = "tail"', 'name = "inputs"', 32, "run[2].name", "every study has"),
        ('name = "tail"', 'name = "../tail"', 32, "run[2].name", "become files"),
        ('methods = "mc"', 'methods = "mcc"', 34, "run[2].methods", "'mc'"),
        ('methods = "mc"', "", 31, "run[2]", "the key methods is missing"),
        ("stop = 8, count = 3", "stop = 8", 35, "run[2].thresholds", "either step or count"),
        ('"reliability"', '"reliabilty"', 39, "figure[1].kind", "mean 'reliability'?"),
        ('table = "body"', 'table = "boddy"', 40, "figure[1].table", "mean 'body'?"),
        ('table = "body"', 'table = "inputs"', 40, "figure[1].table", "no column"),
        ("{ missions =", "{ mission =", 41, "figure[1].where.mission", "mean 'missions'?"),
        ('curves = "tau"', 'curves = "taus"', 42, "figure[1].curves", "mean 'tau'?"),
        ('schema = "uqfold-study/1"', 'schema = "uqfold-study/9"', 1, "schema", "uqfold-study/1"),
    ],
)
def test_errors_name_line_key_and_remedy(
    tmp_path: Path, old: str, new: str, line: int, key: str, words: str
) -> None:
    assert GOOD.count(old) == 1
    with pytest.raises(StudyError) as raised:
        loaded(tmp_path, GOOD.replace(old, new))
    message = str(raised.value)
    assert f"line {line}" in message
    assert key in message
    assert words in message


def test_a_study_without_work_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="nothing to do"):
        loaded(tmp_path, GOOD[: GOOD.index("[[run]]")])


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"study\.toml cannot be read"):
        load_study(tmp_path, {}, {})


def test_a_users_file_is_not_imported(tmp_path: Path) -> None:
    text = GOOD.replace('case = "series"', 'function = "mine:problem"', 1)
    with pytest.raises(StudyError, match=r"line 6.* there is no mine\.py"):
        loaded(tmp_path, text)
    (tmp_path / "mine.py").write_text("raise AssertionError('imported')")
    assert not loaded(tmp_path, text).problems["series"].is_ours
    with pytest.raises(StudyError, match="give module:function"):
        loaded(tmp_path, text.replace("mine:problem", "../mine:problem"))


def test_lines_of_nested_tables(tmp_path: Path) -> None:
    path = tmp_path / "some.toml"
    path.write_text('a = """\n[x]\n"""\n[[b]]\n[b.c]\nd = 1\n[[b]]\n[[b.e]]\n[[b.e]]\nf.g = 1\n')
    _, place = read_document(path)
    assert place.at("b").at(0).at("c").at("d").line == 6
    assert place.at("b").at(1).line == 7
    assert place.at("b").at(1).at("e").at(1).at("f").at("g").line == 10
    assert place.at("a").line == 1
    assert place.at("b").at(0).at("c").at("d").shown == "b[1].c.d"


def test_nearest_word() -> None:
    assert nearest("tau", ["taus", "missions"]) == "did you mean 'taus'? known: missions, taus"
    assert nearest("x", []) == "known: none"
