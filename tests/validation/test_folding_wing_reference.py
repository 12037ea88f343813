"""The run that simulates the reference of the folding wing: draws, streams, store, file."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import norm

from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.inputs import normal
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import load_references, parse_references
from uqfold.testing.counting import RowCount

pytestmark = pytest.mark.thorough
Script = Callable[[str], ModuleType]
DRAWS = 8


@dataclass(frozen=True)
class Model:
    """A stand-in wing: about the mean and scatter of deployment times, shared and individual."""

    mean: float = 0.5356
    interrupt_after: int | None = field(default=None, compare=False)
    calls: list[int] = field(default_factory=list, compare=False)
    count: RowCount = field(default_factory=RowCount, compare=False)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        if self.interrupt_after is not None and len(self.calls) >= self.interrupt_after:
            raise KeyboardInterrupt
        if self.count.add(x):
            self.calls.append(len(x))
        return self.mean + 0.002 * x[:, 0] + 0.0015 * x[:, 1] + 0.0098 * x[:, 2]


def problem(model: Callable[[np.ndarray], np.ndarray]) -> Problem:
    return Problem(
        model,
        shared={"V_q": normal(0, 1), "delta": normal(0, 1)},
        individual={"k_d": normal(0, 1), "b": normal(0, 1)},
        units=4,
        low_fidelity=Model(),
        name="stand-in",
        version="1",
    )


@pytest.fixture
def small(script: Script) -> Any:
    """A small grid that every block can know something about."""
    return script("tables").Grid(
        thresholds=(0.54, 0.55), taus=(None, 0.03), profiles=(1, 5, Binomial(4, 0.5))
    )


@pytest.fixture
def run(script: Script, small: Any) -> Callable[..., Any]:
    return partial(script("folding_wing").simulate, grid=small, draws=DRAWS)


def test_probabilities_of_strata_are_exact_in_both_tails(script: Script) -> None:
    found = script("folding_wing").probabilities((-7.0, -1.0, 2.0, 8.0))
    expected = [norm.cdf(-7), norm.cdf(-1) - norm.cdf(-7), norm.cdf(2) - norm.cdf(-1)]
    expected += [norm.sf(2) - norm.sf(8), norm.sf(8)]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_draws_of_strata_are_normal_within_them(script: Script) -> None:
    edges = (-5.0, -1.0, 2.0, 6.0)
    x = script("folding_wing").block_inputs(
        problem(Model()).inputs, np.array([1.0, 0.0]), edges, np.random.default_rng(3), 64, 64
    )
    z = x[:, 2].reshape(-1, 5)
    for column, low, high in zip(z.T, (-np.inf, *edges), (*edges, np.inf), strict=True):
        assert ((low < column) & (column <= high)).all()
        # distribution function within the stratum: uniform, in the nearer tail
        sign = -1.0 if low >= 0.0 else 1.0
        p = (ndtr(sign * column) - ndtr(sign * low)) / (ndtr(sign * high) - ndtr(sign * low))
        assert abs(p.mean() - 0.5) < 5 * np.sqrt(1 / 12 / 4096)
        assert abs(np.var(p) - 1 / 12) < 5 * np.sqrt(1 / 180 / 4096)


def test_the_direction_is_the_gradient_of_the_individual_inputs(script: Script) -> None:
    inputs = problem(Model()).inputs
    found = script("folding_wing").steepest_direction(
        lambda x: 5.0 * x[:, 0] + 3.0 * x[:, 2] - 4.0 * x[:, 3], inputs
    )
    np.testing.assert_allclose(found, [0.6, -0.8], rtol=1e-9)


def test_shared_inputs_are_repeated_and_strata_run_fastest(script: Script) -> None:
    direction = np.array([0.6, -0.8])
    x = (
        script("folding_wing")
        .block_inputs(
            problem(Model()).inputs, direction, (-1.0, 1.5), np.random.default_rng(1), 64, 40
        )
        .reshape(64, 40, 3, 4)
    )
    assert np.ptp(x[..., :2], axis=(1, 2)).max() == 0.0
    # a scrambled Sobol sequence of 64 points has one in each of 64 strata, in every coordinate
    for column in range(2):
        cells = np.floor(64 * ndtr(x[:, 0, 0, column])).astype(int)
        np.testing.assert_array_equal(np.sort(cells), np.arange(64))
    along, across = x[..., 2:] @ direction, x[..., 2:] @ np.array([0.8, 0.6])
    assert (along[..., 0] <= -1.0).all()
    assert ((along[..., 1] > -1.0) & (along[..., 1] <= 1.5)).all()
    assert (along[..., 2] > 1.5).all()
    assert abs(across.mean()) < 5 / np.sqrt(across.size)
    assert abs(across.std() - 1.0) < 5 / np.sqrt(2 * across.size)


def test_blocks_have_streams_of_their_own(run: Callable[..., Any]) -> None:
    one, two = (run(problem(Model()), blocks=n, seed=3) for n in (1, 2))
    np.testing.assert_array_equal(two[:1], one)
    assert not np.array_equal(two[0], two[1])
    assert not np.array_equal(run(problem(Model()), blocks=2, seed=4), two)


def test_a_continued_run_equals_one_in_a_piece(run: Callable[..., Any], tmp_path: Path) -> None:
    whole = run(problem(Model()), blocks=6)
    store = Evaluator(failed_runs="raise", store=tmp_path / "runs.db")
    with pytest.raises(KeyboardInterrupt):
        run(problem(Model(interrupt_after=5)), blocks=6, evaluator=store)
    model = Model()
    resumed = run(problem(model), blocks=6, evaluator=store)
    batches = -(-DRAWS * 20 * 15 // 4096)
    assert 0 < len(model.calls) < 6 * batches
    assert len(resumed) == 6
    np.testing.assert_array_equal(resumed, whole)


def test_a_failed_run_has_no_place_in_a_reference(run: Callable[..., Any]) -> None:
    def model(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 2] > 5.0, np.nan, 0.5356)

    with pytest.raises(FailedRunError):
        run(problem(model), blocks=2)


def test_rows_that_are_not_known_are_left_out(script: Script, small: Any) -> None:
    estimates = np.array([np.full(small.shape, 0.1 + d) for d in (-0.01, 0.01)])  # error 0.01
    estimates[:, 0, 0, 0] = 0.0  # no failure seen
    estimates[:, 0, 0, 1] -= 0.07  # 33 %
    estimates[:, 1, 2, 1] -= 0.066  # 29 %
    rows = script("folding_wing").known(small, estimates)
    assert len(rows) == estimates[0].size - 2
    assert {row.criterion for row in rows}.isdisjoint({Criterion(0.54), Criterion(0.55)})
    assert rows[-1].pf == pytest.approx(0.034)
    assert rows[-1].std_error == pytest.approx(0.01)


@pytest.fixture
def command_line(
    script: Script, monkeypatch: pytest.MonkeyPatch, small: Any, tmp_path: Path
) -> Callable[[Model], Callable[..., None]]:
    """The command with a small grid and another model, which writes into `tmp_path`."""
    module = script("folding_wing")

    def with_model(model: Model) -> Callable[..., None]:
        monkeypatch.setattr(module, "GRID", small)
        monkeypatch.setattr(module, "SHARED_DRAWS", DRAWS)
        monkeypatch.setattr(module, "STORE", tmp_path / "new" / "c.db")
        monkeypatch.setattr(script("tables"), "SHIPPED", tmp_path)
        monkeypatch.setattr(module, "folding_wing", lambda: problem(model))
        monkeypatch.setattr(module, "simulate", partial(module.simulate, draws=DRAWS))
        return module.main

    return with_model


def test_command_writes_a_reference_file(command_line: Any, tmp_path: Path) -> None:
    main = command_line(Model())
    main(["--blocks", "3", "--seed", "11"])
    main(["--blocks", "5", "--seed", "11"])
    table = parse_references(json.loads((tmp_path / "folding_wing.json").read_text()))
    assert (table.problem, table.kind) == ("folding-wing", "simulation")
    assert f"{5 * DRAWS * 20 * 15} deployments" in table.how
    assert table.command == "python validation/references/folding_wing.py --blocks 5 --seed 11"
    assert table.lookup(Criterion(0.54, 0.03, Binomial(4, 0.5))) is not None
    assert all(row.std_error > 0.0 for row in table)


def test_the_same_command_goes_on_after_an_interrupt(command_line: Any, tmp_path: Path) -> None:
    model = Model(interrupt_after=4)
    main = command_line(model)
    with pytest.raises(KeyboardInterrupt):
        main(["--blocks", "6"])
    assert not (tmp_path / "folding_wing.json").exists()
    object.__setattr__(model, "interrupt_after", None)
    main(["--blocks", "6"])
    assert (tmp_path / "folding_wing.json").exists()


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


def test_the_shipped_table_is_as_accurate_as_promised(script: Script) -> None:
    table = load_references("folding_wing")
    grid = script("folding_wing").GRID
    ranges = {1e-3: 0.006, 1e-4: 0.01, 1e-6: 0.02}
    for criterion, row in table.entries.items():
        allowed = next((share for pf, share in ranges.items() if row.pf >= pf), 0.3)
        assert row.std_error <= allowed * row.pf, criterion
    known = [
        (threshold, tau, missions)
        for threshold in grid.thresholds
        for tau in grid.taus
        for missions in (1, 2, 5, 10)
    ]
    assert all(table.lookup(Criterion(*one)) is not None for one in known)
    assert min(row.pf for row in table) < 1e-8
