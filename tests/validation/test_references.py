"""The scripts that integrate references: their algebra, the shipped rows, and --check."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy import integrate, stats

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import ReferenceTable, load_references, parse_references

Script = Callable[[str], ModuleType]


class Exponential:
    """A unit with the exponential distribution, whatever the shared variable."""

    def distribution(self, t, u, resolution):
        return -np.expm1(-t), np.exp(-t), np.exp(-t)


class LinearNormal:
    """A unit y = a u + b e with standard normal u (shared) and e."""

    def __init__(self, a: float, b: float) -> None:
        self.a, self.b = a, b

    def distribution(self, t, u, resolution):
        e = stats.norm(self.a * u, self.b)
        return e.cdf(t), e.sf(t), e.pdf(t)


def test_range_of_exponential_units_is_known(script: Script) -> None:
    # for n exponential units P(max - min <= tau) = (1 - exp(-tau))^(n - 1), and n = 4
    s = script("order_statistics")
    grid = s.Grid(
        start=0.0, width=0.5, thresholds=(60.0,), taus=(1.0, 4.0, 16.0), profiles=(1,), n_units=4
    )
    resolution = s.Resolution(reach=9.0, shared_step=0.5, individual_step=1.0, panel_nodes=8)
    pf = s.integrate(Exponential(), grid, resolution)[:, 0, 0]
    tau = np.array(grid.taus)
    np.testing.assert_allclose(pf, -np.expm1(3 * np.log1p(-np.exp(-tau))), rtol=1e-12)


def test_threshold_and_tau_against_adaptive_integration(script: Script) -> None:
    s = script("order_statistics")
    a, b, threshold, tau, missions = 0.6, 0.8, 2.0, 2.5, 3
    grid = s.Grid(
        start=-14.0,
        width=0.5,
        thresholds=(threshold,),
        taus=(None, tau),
        profiles=(missions, Binomial(4, 0.7)),
        n_units=3,
    )
    resolution = s.Resolution(reach=9.0, shared_step=0.25, individual_step=1.0, panel_nodes=8)
    pf = s.integrate(LinearNormal(a, b), grid, resolution)[:, :, 0]

    def works(u: float, tau: float) -> float:
        # from the smallest response, unlike the script
        e = stats.norm(a * u, b)
        value, _ = integrate.quad(
            lambda t: 3 * e.pdf(t) * (e.cdf(min(t + tau, threshold)) - e.cdf(t)) ** 2,
            a * u - 9,
            threshold,
            points=[threshold - tau] if math.isfinite(tau) else None,
            epsabs=1e-10,
        )
        return value

    def over_shared(system: Callable[[float], float]) -> float:
        v, w = np.polynomial.hermite_e.hermegauss(24)
        return float(sum(w * [system(u) for u in v]) / math.sqrt(2 * math.pi))

    for i, span in enumerate((math.inf, tau)):
        fixed = over_shared(lambda u, span=span: 1 - works(u, span) ** missions)
        binomial = over_shared(lambda u, span=span: 1 - (0.3 + 0.7 * works(u, span)) ** 4)
        np.testing.assert_allclose(pf[i], [fixed, binomial], atol=1e-8)


def test_deep_tails_keep_their_digits(script: Script) -> None:
    s = script("order_statistics")
    thresholds = (4.0, 6.0, 8.0, 10.0)
    grid = s.Grid(
        start=-14.0,
        width=0.5,
        thresholds=thresholds,
        taus=(None, 20.0),
        profiles=(1,),
        n_units=1,
    )
    resolution = s.Resolution(reach=12.0, shared_step=0.2, individual_step=1.0, panel_nodes=8)
    pf = s.integrate(LinearNormal(0.6, 0.8), grid, resolution)[:, 0]
    # one unit: y is standard normal, and tau cannot matter
    np.testing.assert_allclose(pf, np.tile(stats.norm.sf(thresholds), (2, 1)), rtol=1e-9)


def test_grid_refuses_what_is_no_multiple_of_its_panels(script: Script) -> None:
    s = script("order_statistics")
    grid = s.Grid(start=0.0, width=0.5, thresholds=(1.25,), taus=(None,), profiles=(1,), n_units=2)
    with pytest.raises(ValueError, match=r"1.25 is no multiple of the panel width 0.5"):
        _ = grid.edges


PROFILES = (1, 10, Binomial(10, 0.7))

SMALLER = {
    "series": {
        "thresholds": (-8.0, 0.0, 4.0, 9.0),
        "taus": (None, 8.0, 16.0),
        "profiles": PROFILES,
    },
    "four_bar": {
        "thresholds": (98.0, 101.0, 103.0, 106.0),
        "taus": (None, 2.0, 5.0),
        "profiles": PROFILES,
    },
    "four_bar_crossed": {
        "thresholds": (-144.0, -140.0, -138.0, -135.0),
        "taus": (None, 2.0, 5.0),
        "profiles": PROFILES,
    },
}


def recomputed(script: Script, name: str) -> ReferenceTable:
    """A few rows at resolutions of their own, quicker than those of the shipped file."""
    s = script("order_statistics")
    if name == "series":
        module = script("series")
        unit, grid = module.SeriesUnit(), module.GRID
        resolutions = (
            s.Resolution(reach=8.0, shared_step=0.45, individual_step=0.05, panel_nodes=4),
            s.Resolution(reach=8.5, shared_step=0.35, individual_step=0.035, panel_nodes=5),
        )
    else:
        module = script("four_bar")
        branch = "crossed" if name == "four_bar_crossed" else "open"
        unit, grid = module.FourBarUnit(branch), module.GRIDS[branch]
        resolutions = (
            s.Resolution(reach=8.0, shared_step=0.6, individual_step=0.7, panel_nodes=4),
            s.Resolution(reach=8.5, shared_step=0.5, individual_step=0.5, panel_nodes=4),
        )
    rows = s.rows(unit, replace(grid, **SMALLER[name]), *resolutions)
    text = script("tables").as_text(name, "integration", "", "", rows)
    return parse_references(json.loads(text))


@pytest.mark.parametrize("name", list(SMALLER))
def test_shipped_rows_come_out_again(script: Script, name: str) -> None:
    computed, shipped = recomputed(script, name), load_references(name)
    rows = [shipped.lookup(row.criterion) for row in computed]
    part = replace(shipped, entries={row.criterion: row for row in rows if row is not None})
    assert len(part) == len(computed) == 36
    assert script("tables").mismatches(part, computed) == []
    # and the bounds are tight enough for this to mean something
    assert all(row.std_error < 1e-6 * row.pf for row in computed)
    assert all(row.std_error < 1e-6 * row.pf for row in shipped)


def test_a_planted_wrong_row_is_caught(script: Script) -> None:
    computed = recomputed(script, "series")
    criterion = Criterion(4.0, 16.0, 10)
    right = computed.entries[criterion]
    for wrong in (right.pf * (1 + 1e-5), right.pf * (1 - 1e-5)):
        planted = {**computed.entries, criterion: replace(right, pf=wrong)}
        found = script("tables").mismatches(replace(computed, entries=planted), computed)
        assert len(found) == 1
        assert str(criterion) in found[0]


def test_check_passes_on_equal_and_fails_on_different_files(
    script: Script, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tables = script("tables")
    rows = [tables.Row(1.0, None, 1, 0.25, 1e-9), tables.Row(2.0, 0.5, Binomial(4, 0.5), 1e-9, 0.0)]

    def command(table: list, *arguments: str) -> int:
        text = tables.as_text("a", "integration", "how", "command", table)
        return tables.integration_command(
            "", [("a.json", lambda: text)], ["--out", str(tmp_path), *arguments]
        )

    assert command(rows, "--check") == 1
    assert "missing" in capsys.readouterr().err
    assert command(rows) == 0
    before = (tmp_path / "a.json").read_bytes()
    assert command(rows, "--check") == 0
    assert command([replace(rows[0], pf=0.25 + 1.5e-9), rows[1]], "--check") == 0
    assert command([replace(rows[0], pf=0.25 + 3e-9), rows[1]], "--check") == 1
    assert "shipped 0.25, computed 0.250000003" in capsys.readouterr().err
    assert command(rows[:1], "--check") == 1
    assert command([*rows, tables.Row(3.0, None, 1, 0.1, 0.0)], "--check") == 1
    assert (tmp_path / "a.json").read_bytes() == before


def test_file_has_one_row_per_line_and_13_digits(script: Script) -> None:
    tables = script("tables")
    rows = [
        tables.Row(0.5475, None, 1, 1 / 3, 2.341e-7),
        tables.Row(-1.0, 0.04, Binomial(10, 0.7), 1.23456789e-12, 0.0),
    ]
    text = tables.as_text("p", "integration", "how", "command", rows)
    assert text.splitlines()[-4:-2] == [
        '  {"threshold": 0.5475, "tau": null, "missions": 1, '
        '"pf": 0.3333333333333, "std_error": 2.4e-07},',
        '  {"threshold": -1.0, "tau": 0.04, "missions": {"planned": 10, "p": 0.7}, '
        '"pf": 1.23456789e-12, "std_error": 0.0}',
    ]
    assert [row.criterion for row in parse_references(json.loads(text))] == [
        Criterion(0.5475),
        Criterion(-1.0, 0.04, Binomial(10, 0.7)),
    ]


@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.301e-7, 2.4e-7), (9.91e-3, 0.01), (1.0, 1.0), (0.25, 0.25), (0.0, 0.0), (3e-20, 3e-20)],
)
def test_errors_are_rounded_up(script: Script, value: float, expected: float) -> None:
    assert script("tables").rounded_up(value) == pytest.approx(expected, rel=1e-12)


def test_an_interrupted_write_leaves_the_former_file(
    script: Script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tables = script("tables")
    path = tmp_path / "a.json"
    tables.write(path, "former")

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("uqfold.writing.os.replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        tables.write(path, "new")
    assert path.read_text() == "former"
