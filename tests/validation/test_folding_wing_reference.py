"""The run that simulates the reference of the folding wing: streams, checkpoint, file."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from uqfold.inputs import normal, product_inputs
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import parse_references

Script = Callable[[str], ModuleType]


@dataclass
class Model:
    """A stand-in wing: about the mean and scatter of deployment times, shared and individual."""

    mean: float = 0.5356
    interrupt_after: int | None = None
    calls: list[int] = field(default_factory=list)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        if self.interrupt_after is not None and len(self.calls) >= self.interrupt_after:
            raise KeyboardInterrupt
        self.calls.append(len(x))
        return self.mean + 0.002 * x[:, 0] + 0.0015 * x[:, 1] + 0.0098 * x[:, 2]


INPUTS = product_inputs(
    {"V_q": normal(0, 1), "delta": normal(0, 1)}, {"k_d": normal(0, 1), "b": normal(0, 1)}
)


@pytest.fixture
def small(script: Script) -> Any:
    """A small grid that every block can know something about."""
    return script("mission_estimators").MissionGrid(
        thresholds=(0.54, 0.55), taus=(None, 0.03), profiles=(1, 5, Binomial(4, 0.5))
    )


def test_each_shared_input_is_stratified_and_repeated(script: Script, small: Any) -> None:
    seen = []

    def model(x: np.ndarray) -> np.ndarray:
        seen.append(x.copy())
        return x[:, 0]

    times = script("folding_wing").block_times(model, INPUTS, small, np.random.default_rng(1), 64)
    assert times.shape == (64, 10, 4)
    x = seen[0].reshape(64, 40, 4)
    assert np.ptp(x[:, :, :2], axis=1).max() == 0.0
    assert np.unique(x[:, :, 2:]).size == 64 * 40 * 2
    for column in range(2):
        strata = np.floor(64 * ndtr(x[:, 0, column])).astype(int)
        np.testing.assert_array_equal(np.sort(strata), np.arange(64))


def test_blocks_have_streams_of_their_own(script: Script, small: Any) -> None:
    run = script("folding_wing").simulate
    means = [run(Model(), INPUTS, small, blocks=n, seed=3, draws=8).mean for n in (1, 2)]
    again = run(Model(), INPUTS, small, blocks=2, seed=3, draws=8).mean
    other = run(Model(), INPUTS, small, blocks=2, seed=4, draws=8).mean
    np.testing.assert_array_equal(means[1], again)
    assert not np.array_equal(means[0], means[1])
    assert not np.array_equal(other, again)


def test_mean_and_standard_error_are_those_of_the_blocks(script: Script) -> None:
    estimates = np.random.default_rng(0).random((7, 2, 3, 4))
    sums = script("folding_wing").Accumulation("", np.zeros((2, 3, 4)), np.zeros((2, 3, 4)))
    assert np.isnan(sums.std_error).all()
    for estimate in estimates:
        sums.add(estimate)
    np.testing.assert_allclose(sums.mean, estimates.mean(axis=0), rtol=1e-13)
    expected = estimates.std(axis=0, ddof=1) / np.sqrt(7)
    np.testing.assert_allclose(sums.std_error, expected, rtol=1e-12)


def test_a_continued_run_equals_one_in_a_piece(script: Script, small: Any, tmp_path: Path) -> None:
    run, checkpoint = script("folding_wing").simulate, tmp_path / "sums.npz"
    whole = run(Model(), INPUTS, small, blocks=6, draws=8)
    broken = Model(interrupt_after=1 + 4)  # the probe and four blocks
    with pytest.raises(KeyboardInterrupt):
        run(broken, INPUTS, small, blocks=6, draws=8, checkpoint=checkpoint)
    model = Model()
    resumed = run(model, INPUTS, small, blocks=6, draws=8, checkpoint=checkpoint)
    assert len(model.calls) == 1 + 2
    assert resumed.blocks == 6
    np.testing.assert_array_equal(resumed.mean, whole.mean)
    np.testing.assert_array_equal(resumed.squares, whole.squares)


@pytest.mark.parametrize(
    "change", [{"seed": 8}, {"draws": 16}, {"mean": 0.5357}, {"thresholds": (0.54, 0.56)}]
)
def test_sums_of_other_settings_are_not_continued(
    script: Script, small: Any, tmp_path: Path, change: dict[str, Any]
) -> None:
    module, checkpoint = script("folding_wing"), tmp_path / "sums.npz"

    def run(seed: int = 7, draws: int = 8, mean: float = 0.5356, **grid: Any) -> None:
        module.simulate(
            Model(mean),
            INPUTS,
            module.MissionGrid(**{**vars(small), **grid}),
            blocks=2,
            seed=seed,
            draws=draws,
            checkpoint=checkpoint,
        )

    run()
    run()
    with pytest.raises(ValueError, match="another seed, grid, block size or model"):
        run(**change)


def test_rows_that_are_not_known_are_left_out(script: Script, small: Any) -> None:
    module = script("folding_wing")
    sums = module.Accumulation("", np.full(small.shape, 0.1), np.zeros(small.shape), blocks=10)
    sums.squares[:] = 0.01**2 * 90  # a standard error of 0.01
    sums.mean[0, 0] = [0.0, 0.03]  # no failure seen; 33 %
    sums.mean[1, 2, 1] = 0.034  # 29 %
    rows = module.known_rows(small, sums)
    assert len(rows) == sums.mean.size - 2
    assert {(row.threshold, row.tau, row.missions) for row in rows}.isdisjoint(
        {(0.54, None, 1), (0.55, None, 1)}
    )
    assert rows[-1].pf == 0.034
    assert rows[-1].std_error == pytest.approx(0.01)


def command_line(
    script: Script, monkeypatch: pytest.MonkeyPatch, small: Any, model: Model
) -> Callable[..., int]:
    module = script("folding_wing")
    monkeypatch.setattr(module, "GRID", small)
    monkeypatch.setattr(module, "SHARED_DRAWS", 8)
    problem = SimpleNamespace(model=model, inputs=INPUTS)
    monkeypatch.setattr(module, "folding_wing", lambda: problem)
    return module.main


def test_command_writes_a_reference_file(
    script: Script, small: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    main = command_line(script, monkeypatch, small, Model())
    out = tmp_path / "wing.json"
    options = ["--seed", "11", "--checkpoint", str(tmp_path / "c.npz"), "--out", str(out)]
    assert main(["--blocks", "3", *options]) == 0
    assert main(["--blocks", "20", *options]) == 0
    table = parse_references(json.loads(out.read_text()))
    assert (table.problem, table.kind) == ("folding-wing", "simulation")
    assert f"{20 * 8 * 40} deployments" in table.how
    assert table.command == "python validation/references/folding_wing.py --blocks 20 --seed 11"
    assert table.lookup(Criterion(0.54, 0.03, Binomial(4, 0.5))) is not None
    assert all(row.std_error > 0.0 for row in table)


def test_interrupt_keeps_the_sums_and_says_how_to_go_on(
    script: Script,
    small: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    model = Model(interrupt_after=4)
    main = command_line(script, monkeypatch, small, model)
    options = ["--checkpoint", str(tmp_path / "c.npz"), "--out", str(tmp_path / "wing.json")]
    assert main(["--blocks", "6", *options]) == 130
    message = capsys.readouterr().err
    assert "the same command continues" in message
    assert "block" not in message.splitlines()[0]  # no progress line without a terminal
    assert not (tmp_path / "wing.json").exists()
    model.interrupt_after = None
    assert main(["--blocks", "6", *options]) == 0
    assert (tmp_path / "wing.json").exists()


def test_another_model_is_an_error_not_a_traceback(
    script: Script,
    small: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    options = ["--checkpoint", str(tmp_path / "c.npz"), "--out", str(tmp_path / "wing.json")]
    assert command_line(script, monkeypatch, small, Model())(["--blocks", "2", *options]) == 0
    other = command_line(script, monkeypatch, small, Model(0.6))
    assert other(["--blocks", "2", *options]) == 1
    assert "remove the file to start afresh" in capsys.readouterr().err


def test_one_block_has_no_standard_error(
    script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        script("folding_wing").main(["--blocks", "1"])
    assert "at least 2 blocks" in capsys.readouterr().err


def test_grid_of_the_run_covers_the_default_criteria(script: Script) -> None:
    from uqfold.problems.wing import DEFAULT_TAU, DEFAULT_THRESHOLDS

    grid = script("folding_wing").GRID
    assert set(DEFAULT_THRESHOLDS) <= set(grid.thresholds)
    assert set(DEFAULT_TAU) <= set(grid.taus)
    assert 1 in grid.profiles
