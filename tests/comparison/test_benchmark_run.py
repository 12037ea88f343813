"""Methods x problems x seeds: rows as methods give them, kept as they end, and gone on with."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import uqfold
from tests.comparison.fakes import Sampled, Told, toy_problem
from uqfold.comparison import RecordsError, read_benchmark
from uqfold.comparison.benchmark_rows import QUESTION
from uqfold.evaluation.deadline import limit_told
from uqfold.methods import MonteCarlo
from uqfold.problems.criterion import criteria

ONE, TWO = criteria(12.0), criteria([11.0, 12.0])
METHODS = {"told": Told(n=20), "sampled": Sampled(n=50)}


def asked(path: Path | None = None, **changes: Any) -> tuple[Any, list[int]]:
    """Return the frame of a small benchmark, and how many answers there were at each report."""
    told = list[int]()
    given: dict[str, Any] = {"methods": METHODS, "problems": toy_problem(ONE), "seeds": 2} | changes
    frame = uqfold.benchmark(**given, path=path, progress=lambda done, _: told.append(done))
    return frame, told


def test_rows_are_what_methods_answer_and_a_seed_that_changes_nothing_is_asked_once() -> None:
    frame, _ = asked(problems=[replace(toy_problem(TWO), name="a"), toy_problem(ONE)], max_evals=60)
    assert frame.groupby(["label", "seed"]).size().to_dict() == {
        ("sampled", 0): 3, ("sampled", 1): 3, ("told", 0): 3,
    }  # fmt: skip
    own = frame[(frame["problem"] == "toy") & (frame["seed"] == 1)].iloc[0]
    row = METHODS["sampled"].estimate(toy_problem(ONE), max_evals=60, rng=1)[0]
    assert (row.pf, row.ci_high, row.n_evals) == (own["pf"], own["ci_high"], own["n_evals"])
    assert asked(max_evals=40)[0]["status"].tolist() == ["unchecked", "failed", "failed"]
    assert set(frame["max_evals"]) == {60.0}
    assert set(frame["inputs"]) == {toy_problem().inputs.dimension}
    assert "covered" in repr(frame)


def test_an_interval_covers_the_reference_or_does_not() -> None:
    """Issue: per row pf, error against the reference, stated error, covered, runs, time, status."""
    frame, _ = asked(seeds=40)
    sampled = frame[frame["label"] == "sampled"]
    inside = (
        sampled["ci_low"] - 2.0 * sampled["reference_std_error"] <= sampled["reference_pf"]
    ) & (sampled["reference_pf"] <= sampled["ci_high"] + 2.0 * sampled["reference_std_error"])
    assert sampled["covered"].tolist() == inside.astype(float).tolist()
    assert set(sampled["covered"]) == {0.0, 1.0}
    assert frame.loc[frame["label"] == "told", "covered"].isna().all()


def test_the_same_call_asks_nothing_again_and_gives_the_same(tmp_path: Path) -> None:
    first, told = asked(tmp_path / "rows.jsonl", command="uqfold benchmark")
    assert told == [0, 1, 2, 3]
    again, told = asked(tmp_path / "rows.jsonl")
    assert told == [3]
    assert again.equals(first)
    assert (
        read_benchmark(tmp_path)
        .sort_values(QUESTION)
        .equals(
            first.sort_values(QUESTION).set_axis(
                read_benchmark(tmp_path).sort_values(QUESTION).index
            )
        )
    )
    assert set(again["command"]) == {"uqfold benchmark"}


@pytest.mark.parametrize("torn", ["", '{"problem": "toy", "la', "garbage\n"])
def test_ctrl_c_loses_nothing_and_the_same_call_goes_on(tmp_path: Path, torn: str) -> None:
    def interrupt(done: int, _: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    file = tmp_path / "results" / "rows.jsonl"
    given: dict[str, Any] = {"methods": METHODS, "problems": toy_problem(ONE), "seeds": 2}
    with pytest.raises(KeyboardInterrupt):
        uqfold.benchmark(**given, path=file, progress=interrupt)
    with file.open("a", encoding="utf-8") as stream:
        stream.write(torn)
    frame, told = asked(file)
    assert told == [2, 3]
    assert len(read_benchmark(file)) == len(frame) == 3


def test_rows_of_other_code_settings_or_problems_are_made_again(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    asked(file, problems=toy_problem(TWO))
    assert asked(file)[1] == [0, 1, 2, 3]  # one criterion is another problem
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    lines[-1]["code"] = "of an earlier day"
    file.write_text("".join(f"{json.dumps(line)}\n" for line in lines), encoding="utf-8")
    assert asked(file)[1] == [2, 3]
    assert asked(file)[1] == [3]
    assert asked(file, methods=METHODS | {"told": Told(n=30)})[1] == [2, 3]
    assert asked(file, max_evals=7_000)[1] == [0, 1, 2, 3]
    assert asked(file, problems=toy_problem(criteria(11.0)))[1] == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("inputs", 10**30, "inputs = 10+: give a whole number >= 1, smaller than 2\\*\\*63"),
        ("inputs", "3", "inputs: Input should be a valid integer, not '3'"),
        ("pf", 7.0, r"pf = 7.0: give a probability in \[0, 1\]"),
        ("pf", None, "pf = nan: it does not go with the status 'unchecked'"),
        ("pf", 0.5, "it is above pf = 0.5|it is not 1 - pf|pf = 0.5: it is above pf_high"),
        ("reliability", 0.1, "reliability = 0.1: it is not 1 - pf"),
        ("std_error", -1.0, "std_error = -1.0: give a number >= 0"),
        ("n_evals", -5, "n_evals = -5: give a whole number from 0"),
        ("n_failed", 10**6, "n_failed = 1000000: give a whole number <= "),
        ("seconds", "inf", "seconds = inf: give a number >= 0 that is finite"),
        ("seed", -1, "seed = -1: give a whole number >= 0"),
        ("status", "sure", "status = 'sure': choose from"),
        ("missions", "7.5", "missions = '7.5'"),
        ("missions", "01", "missions = '01': the profile is 1"),
        ("tau", -1.0, "tau = -1.0"),
        ("max_evals", 0.0, "max_evals = 0.0"),
        ("error", 0.5, "error = 0.5: that of pf against reference_pf is"),
        ("covered", True, "covered = True: it goes with an interval and a reference"),
        ("threshold", None, "threshold = nan"),
        ("colour", 1, "colour is not a field here"),
    ],
)
def test_what_no_method_could_have_given_is_told_and_asked_again(
    tmp_path: Path, name: str, value: object, said: str
) -> None:
    """Of two rows one is damaged; of one row nothing is left."""
    file = tmp_path / "rows.jsonl"
    given: dict[str, Any] = {"methods": {"told": Told(n=20)}, "problems": toy_problem(TWO)}
    asked(file, **given)
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    lines[1][name] = value
    file.write_text("".join(f"{json.dumps(line)}\n" for line in lines), encoding="utf-8")
    with pytest.warns(UserWarning, match=f"1 of 2 lines hold no possible answer.*line 2: ({said})"):
        assert asked(file, **given)[1] == [0, 1]
    file.write_text(f"{json.dumps(lines[1])}\n", encoding="utf-8")
    with pytest.raises(RecordsError, match=f"holds no rows of a benchmark .line 1: ({said})"):
        read_benchmark(file)


def test_what_a_limit_of_time_ended_is_asked_again_with_more_time(tmp_path: Path) -> None:
    file, given = tmp_path / "rows.jsonl", {"methods": {"mc": MonteCarlo()}, "seeds": 1}
    cut = asked(file, **given, max_evals=10**7, max_seconds=0.001)[0]
    assert limit_told(cut["message"][0]) == 0.001
    assert asked(file, **given, max_evals=10**7, max_seconds=0.001)[1] == [1]
    assert asked(file, **given, max_evals=10**7, max_seconds=0.002)[1] == [0, 1]
    assert asked(file, **given, max_evals=10**7, max_seconds=0.001)[1] == [1]


def test_workers_give_the_numbers_of_one() -> None:
    given: dict[str, Any] = {"methods": {"mc": MonteCarlo()}, "problems": "rp8", "max_evals": 500}
    with ThreadPoolExecutor(2) as executor:
        shared, told = asked(**given, workers=executor)
    assert told == [0, 1, 2]
    alone, _ = asked(**given)
    left_out = ["seconds", "date"]
    assert shared.drop(columns=left_out).equals(alone.drop(columns=left_out))


@pytest.mark.slow
def test_processes_give_the_numbers_of_one(tmp_path: Path) -> None:
    given: dict[str, Any] = {"methods": ["mc", "openturns-mc"], "problems": ["rp8", "rp22"]}
    shared, _ = asked(tmp_path / "rows.jsonl", **given, workers=2)
    alone, _ = asked(**given)
    left_out = ["seconds", "date"]
    assert shared.drop(columns=left_out).equals(alone.drop(columns=left_out))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"problems": ["rp222"]}, "problems = 'rp222': did you mean 'rp22'"),
        ({"problems": ["rp22", "rp22"]}, "none of a name twice"),
        ({"problems": []}, r"problems = \[\]: give one at least"),
        ({"problems": toy_problem(ONE, referenced=False)}, "'toy' has no known answer"),
        ({"methods": ["mcc"]}, "did you mean 'mc'"),
        ({"seeds": 0}, "seeds = 0"),
        ({"seeds": [1, 1]}, "give different ones"),
        ({"workers": 0}, "workers = 0"),
    ],
)
def test_wrong_words_are_refused_before_any_work(change: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        asked(**change)


def test_a_file_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine\n", encoding="utf-8")
    with pytest.raises(RecordsError, match=r"mine\.txt holds no rows of a benchmark"):
        asked(tmp_path / "mine.txt")
    assert (tmp_path / "mine.txt").read_text(encoding="utf-8") == "mine\n"


def test_methods_and_problems_of_ones_own_come_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "of_mine.py").write_text(
        "from uqfold.methods import MonteCarlo\n"
        "from uqfold.problems import catalogue\n"
        "def methods():\n    return {'few': MonteCarlo(), 'many': MonteCarlo()}\n"
        "def problem():\n    return catalogue.problem('rp8')\n",
        encoding="utf-8",
    )
    file = tmp_path / "of_mine.py"
    frame, _ = asked(methods=["openturns-mc", f"{file}:methods"], problems=f"{file}:problem",
                     seeds=1, max_evals=200)  # fmt: skip
    assert list(frame["label"]) == ["openturns-mc", "few", "many"]
    assert set(frame["problem"]) == {"of_mine-problem"}
    with pytest.raises(ValueError, match="a dict of label -> method, but it returns Problem"):
        asked(methods=f"{file}:problem")
