"""Problems stated in a TOML file."""

import pickle
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import uqfold
from uqfold.cli import main
from uqfold.comparison import named_problem
from uqfold.evaluation import ServedProblem
from uqfold.problems.criterion import LIMIT_STATE_THRESHOLD

MODEL = """
def stress(x):
    return x[:, 0] / x[:, 1]

def margin(x):
    return 5.0 - x[0] / x[1]

nothing = 3
"""
SOLVER = """
load, area = (float(line.split()[1]) for line in open("in.txt"))
print("stress:", load / area)
"""
FILE = """
model = "stated_model.py:stress"
response = "stress"
response_unit = "MPa"

[inputs.area]
distribution = "lognormal"
mean = 3.0
std = 0.1
unit = "mm2"

[inputs.load]
distribution = "normal"
mean = 10.0
std = 1.5
shared = true

[criteria]
threshold = [4.0, 5.0]
missions = [1, { planned = 10, p = 0.7 }]

[[references]]
threshold = 5.0
pf = 0.0005
std_error = 0.00001
"""


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stated_model.py").write_text(MODEL)
    (tmp_path / "solver.py").write_text(SOLVER)
    (tmp_path / "in.template").write_text("load {{load}}\narea {{area}}\n")
    yield
    sys.modules.pop("stated_model", None)


def stated(text: str = FILE) -> uqfold.Problem:
    Path("bar.toml").write_text(text, encoding="utf-8")
    return named_problem("bar.toml").problem()


def test_a_file_states_what_python_would() -> None:
    problem = stated("units = 2\nstructure = 'parallel'\n" + FILE)
    assert problem.name == "bar"
    assert problem.inputs.names == ("load", "area")
    assert problem.inputs.shared_names == ("load",)
    assert problem.input_units == ("", "mm2")
    assert problem.inputs.means.tolist() == pytest.approx([10.0, 3.0])
    assert problem.inputs.standard_deviations.tolist() == pytest.approx([1.5, 0.1])
    assert (problem.n_units, problem.structure) == (2, uqfold.Parallel())
    known = uqfold.criteria([4.0, 5.0], missions=[1, uqfold.Binomial(10, 0.7)])
    assert problem.default_criteria == known
    assert problem.references is not None
    assert [one.pf for one in problem.references] == [0.0005]
    x = np.array([[8.0, 2.0]])
    assert problem.model(x).tolist() == [4.0]
    assert pickle.loads(pickle.dumps(problem.model))(x).tolist() == [4.0]


def test_references_without_a_threshold_answer_the_criteria_in_turn() -> None:
    text = FILE.replace("[4.0, 5.0]", "5.0").replace("missions = [1, {", "# [{")
    known = "[[references]]\nthreshold = 5.0\n"
    problem = stated(text.replace(known, "[[references]]\n"))
    assert problem.references is not None
    assert [(one.pf, one.std_error) for one in problem.references] == [(0.0005, 0.00001)]
    with pytest.raises(ValueError, match=r"references.*give the threshold that it answers"):
        stated(text.replace(known, "[[references]]\nmissions = 1\n"))


def test_paths_are_relative_to_the_file_and_a_mark_of_utf_8_is_none_of_it(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "stated_model.py").rename(tmp_path / "sub" / "stated_model.py")
    (tmp_path / "sub" / "bar.toml").write_text(FILE, encoding="utf-8-sig")
    assert named_problem("sub/bar.toml").problem().model(np.ones((1, 2))).tolist() == [1.0]


INPUTS = FILE[FILE.index("[inputs.area]") : FILE.index("[criteria]")]


def test_a_limit_state_of_one_sample_and_correlation() -> None:
    model = 'model = { function = "stated_model.py:margin", per_sample = true, limit_state = true }'
    pairs = 'correlation = [{ between = ["load", "area"], spearman = 0.5 }]'
    problem = stated(f"{model}\n{pairs}\n{INPUTS.replace('shared = true', '')}")
    assert problem.default_criteria == uqfold.criteria(LIMIT_STATE_THRESHOLD)
    assert problem.model(np.array([[10.0, 2.0]])).tolist() == [0.0]
    assert not problem.inputs.independent
    u = problem.inputs.to_standard_normal(np.array([[3.1, 10.0]]))[0]
    assert u[1] == pytest.approx(-u[0] * 0.5176 / np.sqrt(1.0 - 0.5176**2), rel=1e-3)


def test_a_program_is_a_model(tmp_path: Path) -> None:
    command = f"command = [{sys.executable!r}, 'solver.py']"
    more = "templates = { 'in.txt' = 'in.template' }, output = { pattern = 'stress: (.*)' }"
    problem = stated(f"model = {{ {command}, {more}, timeout = 60 }}\n{INPUTS}")
    assert problem.model(np.array([[8.0, 2.0]])).tolist() == [4.0]


def test_a_served_model_is_a_model() -> None:
    with ServedProblem(stated()) as served:
        text = f"model = {{ url = {served.url!r}, name = 'bar' }}\nunits = [{{name = 'a'}}, {{}}]\n"
        remote = stated(text + "structure = 'a | u1'\n" + INPUTS)
        assert remote.kinds.models[0](np.array([[8.0, 2.0]])).tolist() == [4.0]
    assert remote.structure == uqfold.Structure("a | u1")


@pytest.mark.parametrize(
    ("table", "mean"),
    [
        ("distribution = 'discrete'\nvalues = [1, 3]\nprobabilities = [0.5, 0.5]", 2.0),
        ("distribution = 'poisson'\nmean = 3", 3.0),
        ("distribution = 'truncated'\nhigh = 0\nof = {distribution='normal', mean=0, std=1}", -0.8),
        ("distribution = 'censored'\nlow = 0\nof = {distribution='normal', mean=0, std=1}", 0.4),
        ("distribution = 'from_data'\nfile = 'measured.txt'\nfamily = 'normal'", 2.0),
        ("distribution = 'gumbel'\nmean = 2\nstd = 0.5", 2.0),
        ("distribution = 'gumbel'\nlocation = 0\nscale = 1", 0.5772),
        ("distribution = 'weibull'\nmean = 2\nstd = 0.5", 2.0),
        ("distribution = 'weibull'\nscale = 1\nshape = 1", 1.0),
        ("distribution = 'Gamma'\nmean = 2\nstd = 0.5", 2.0),
        ("distribution = 'gamma'\nshape = 2\nscale = 3", 6.0),
        ("distribution = 'beta'\nmean = 2\nstd = 0.5\nlow = 0\nhigh = 5", 2.0),
        ("distribution = 'lognormal'\nmean_log = 0\nstd_log = 1", 1.6487),
        ("distribution = 'exponential'\nmean = 2", 2.0),
        ("distribution = 'triangular'\nlow = 0\nmode = 1\nhigh = 2", 1.0),
        ("distribution = 'uniform'\nlow = 0\nhigh = 2", 1.0),
        ("distribution = 'logistic'\nmean = 2\nstd = 0.5", 2.0),
    ],
)
def test_distributions_by_name_have_their_parameters(table: str, mean: float) -> None:
    Path("measured.txt").write_text(" ".join(map(str, 2.0 + 0.1 * np.linspace(-1, 1, 12))))
    problem = stated(f"model = 'stated_model.py:stress'\n[inputs.a]\n{table}\n")
    assert problem.inputs.means[0] == pytest.approx(mean, abs=0.003)
    if "std = 0.5" in table:
        assert problem.inputs.standard_deviations[0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("model = ", "bar.toml: Invalid value"),
        ("[inputs.a]\ndistribution = 'normal'", "bar.toml: the field model is missing"),
        ("inptus = {}\nmodel = 'm'", "inptus is not a field here: do you mean 'inputs'?"),
        (FILE.replace("threshold =", "treshold ="), "criteria.treshold is not a field here: do"),
        (FILE.replace("[4.0, 5.0]", "'5'"), "criteria.threshold"),
        (FILE.replace("[4.0, 5.0]", "[]"), "criteria: threshold = []: give at least one value"),
        (FILE.replace("p = 0.7", "p = 7"), "criteria: p = 7"),
        (FILE.replace("mean = 3.0", "mean = '3'"), "inputs.area: mean = '3': give a finite number"),
        (
            FILE.replace("std = 0.1", "sd = 0.1"),
            "inputs.area: 'sd' is no parameter of lognormal: d",
        ),
        (FILE.replace("std = 0.1", ""), "inputs.area: lognormal lacks its parameter 'std'"),
        (FILE.replace("std = 0.1", "std = -1"), "inputs.area: std = -1"),
        (FILE.replace("std = 0.1", "std = nan"), "inputs.area: std = nan"),
        (FILE.replace("mean = 3.0", "mean = -3.0"), "inputs.area: there is no lognormal distr"),
        (FILE.replace('"normal"', '"norml"'), "inputs.load: distribution = 'norml': did you mean"),
        (FILE.replace("shared = true", "shared = 1"), "inputs.load.shared = 1: give true or false"),
        (FILE.replace('"mm2"', "2"), "inputs.area: unit = 2: give text"),
        (FILE.replace("pf = 0.0005", "pf = 7"), "references"),
        (FILE.replace("pf = 0.0005", ""), "references"),
        ("references = 'nowhere'\n" + FILE[: FILE.index("[[ref")], "nowhere: No such file"),
        (
            FILE.replace("py:stress", "py:nothing"),
            "model: function = 'stated_model.py:nothing': it",
        ),
        (FILE.replace("py:stress", "py:none"), "has no function 'none'"),
        (
            FILE.replace("stated_model", "other"),
            "model: name = 'other.py:stress': there is no file",
        ),
        (FILE.replace("stated_model.py:stress", "os.system"), "give FILE.py:FUNCTION"),
        ("units = 0\n" + FILE, "units = 0"),
        ("units = 2\nstructure = 'serial'\n" + FILE, "structure = 'serial': did you mean 'series'"),
        (
            "units = 2\nstructure = {k_out_of_n = 3}\n" + FILE,
            "it cannot hold for a system of 2 units",
        ),
        ("units = 2\nstructure = {k = 3}\n" + FILE, "structure"),
        ("structure = {fault_tree = 'no.xml'}\n" + FILE, "no.xml: No such file"),
        (
            "correlation = [{between = ['load', 'are'], normal = 0.5}]\n" + FILE,
            "did you mean 'area'",
        ),
        ("correlation = [{between = ['load', 'area'], normal = 1.5}]\n" + FILE, "normal = 1.5"),
        ("correlation = [{between = ['load', 'area']}]\n" + FILE, "and normal or spearman"),
        (f"model = {{ limit_state = true }}\n{INPUTS}", "give one of function, command, url"),
        (f"model = {{ command = ['a'], output = {{}} }}\n{INPUTS}", "model: output = {}: give pat"),
        (f"model = {{ url = 'http://127.0.0.1:1', name = 'a' }}\n{INPUTS}", "does not answer"),
        ("name = 2020-01-01\n" + FILE, "name: Input should be a valid string"),
        ("x = " + "[" * 5000, "bar.toml: it is nested too deeply"),
        ("model = 'a.py:b'\ninputs = {}", "inputs = {}: give a table [inputs.NAME]"),
    ],
)
def test_what_is_wrong_is_told_by_file_and_place(text: str, said: str) -> None:
    with pytest.raises((ValueError, TypeError)) as refused:
        stated(text)
    assert str(refused.value).startswith("bar.toml: ")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_commands_take_a_file(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    stated()
    frame = uqfold.benchmark("openturns-form", "bar.toml", 1)
    assert frame["problem"].tolist() == ["bar"] * 4
    assert frame["reference_pf"].tolist()[1] == 0.0005
    monkeypatch.setattr(ServedProblem, "wait", lambda self: None)
    with pytest.raises(SystemExit, match="0"):
        main(["serve", "bar.toml", "--port", "0"])
    assert capsys.readouterr().out.startswith("bar (load, area) at http://127.0.0.1:")
    with pytest.raises(SystemExit, match="2"):
        main(["compare", "nowhere.toml"])
    assert "there is no file nowhere.toml" in capsys.readouterr().err
