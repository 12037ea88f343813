"""The scripts that integrate references: their algebra, and the shipped rows."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy import integrate, stats

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import Reference, ReferenceTable, load_references, parse_references

Script = Callable[[str], ModuleType]


def exponential(t, u, rules):
    """A unit with the exponential distribution, whatever the shared variable."""
    return -np.expm1(-t), np.exp(-t), np.exp(-t)


def linear_normal(a: float, b: float) -> Callable:
    """A unit y = a u + b e with standard normal u (shared) and e."""

    def unit(t, u, rules):
        e = stats.norm(a * u, b)
        return e.cdf(t), e.sf(t), e.pdf(t)

    return unit


def mismatches(shipped: ReferenceTable, computed: ReferenceTable) -> list[str]:
    """Return where tables with the same rows differ by more than their own bounds."""
    pairs = [(row, computed.entries[row.criterion]) for row in shipped]
    return [
        str(old.criterion)
        for old, new in pairs
        # a NaN must count as a mismatch, hence "not <="
        if not abs(old.pf - new.pf) <= old.std_error + new.std_error
    ]


def test_range_of_exponential_units_is_known(script: Script) -> None:
    # for n exponential units P(max - min <= tau) = (1 - exp(-tau))^(n - 1), and n = 4
    s = script("order_statistics")
    grid = script("tables").Grid(thresholds=(60.0,), taus=(1.0, 4.0, 16.0), profiles=(1,))
    rules = s.Rules(start=0.0, width=0.5, panel_nodes=8, reach=9.0, shared_step=0.5)
    pf = s.integrate(exponential, grid, rules)[:, 0, 0]
    tau = np.array(grid.taus)
    np.testing.assert_allclose(pf, -np.expm1(3 * np.log1p(-np.exp(-tau))), rtol=1e-12)


def test_threshold_and_tau_against_adaptive_integration(script: Script) -> None:
    s = script("order_statistics")
    a, b, threshold, tau, missions = 0.6, 0.8, 2.0, 2.5, 3
    grid = script("tables").Grid(
        thresholds=(threshold,),
        taus=(None, tau),
        profiles=(missions, Binomial(4, 0.7)),
        units=3,
    )
    rules = s.Rules(start=-14.0, width=0.5, panel_nodes=8, reach=9.0, shared_step=0.25)
    pf = s.integrate(linear_normal(a, b), grid, rules)[:, :, 0]

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

    v, w = np.polynomial.hermite_e.hermegauss(24)
    for i, span in enumerate((math.inf, tau)):
        one = np.array([works(u, span) for u in v])
        systems = [1 - one**missions, 1 - (0.3 + 0.7 * one) ** 4]
        expected = np.stack(systems) @ w / math.sqrt(2 * math.pi)
        np.testing.assert_allclose(pf[i], expected, atol=1e-8)


def test_deep_tails_keep_their_digits(script: Script) -> None:
    s = script("order_statistics")
    thresholds = (4.0, 6.0, 8.0, 10.0)
    grid = script("tables").Grid(thresholds=thresholds, taus=(None, 20.0), profiles=(1,), units=1)
    rules = s.Rules(start=-14.0, width=0.5, panel_nodes=8, reach=12.0, shared_step=0.2)
    pf = s.integrate(linear_normal(0.6, 0.8), grid, rules)[:, 0]
    # one unit: y is standard normal, and tau cannot matter
    np.testing.assert_allclose(pf, np.tile(stats.norm.sf(thresholds), (2, 1)), rtol=1e-9)


def test_rules_refuse_what_is_no_multiple_of_their_panels(script: Script) -> None:
    rules = script("order_statistics").Rules(0.0, 0.5, 4, 9.0, 0.5)
    assert rules.panels(1.5) == 3
    with pytest.raises(ValueError, match=r"1.25 is no multiple of the panel width 0.5"):
        rules.panels(1.25)


def test_a_bound_on_the_last_variable_gives_the_distribution(script: Script) -> None:
    # y = 2 (v + e): given nodes over v, e is at most t / 2 - v
    s = script("order_statistics")
    v, weights = s.standard_normal_rule(9.0, 0.25)
    t = np.array([-3.0, 0.5, 12.0])
    found = s.below_bound(t[:, None] / 2.0 - v, np.full((3, v.size), 0.5), weights)
    exact = stats.norm(scale=2.0 * math.sqrt(2.0))
    for values, expected in zip(found, (exact.cdf(t), exact.sf(t), exact.pdf(t)), strict=True):
        np.testing.assert_allclose(values, expected, rtol=1e-12)


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
        unit, grid, fine = module.unit, module.GRID, module.FINE
        coarse = replace(fine, panel_nodes=4, reach=8.0, shared_step=0.45, individual_step=0.05)
        fine = replace(fine, panel_nodes=5, reach=8.5, shared_step=0.35, individual_step=0.035)
    else:
        module = script("four_bar")
        branch = "crossed" if name == "four_bar_crossed" else "open"
        unit, grid = partial(module.unit, branch), module.GRIDS[branch]
        fine = replace(module.FINE, start=module.START[branch], panel_nodes=4)
        coarse = replace(fine, reach=8.0, shared_step=0.6, individual_step=0.7)
        fine = replace(fine, reach=8.5, shared_step=0.5, individual_step=0.5)
    found = s.references(unit, replace(grid, **SMALLER[name]), coarse, fine)
    text = script("tables").as_text(name, "integration", "", "", found)
    return parse_references(json.loads(text))


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name == "four_bar" else pytest.mark.thorough)
        for name in SMALLER
    ],
)
def test_shipped_rows_come_out_again(script: Script, name: str) -> None:
    computed, shipped = recomputed(script, name), load_references(name)
    rows = [shipped.lookup(row.criterion) for row in computed]
    part = replace(shipped, entries={row.criterion: row for row in rows if row is not None})
    assert len(part) == len(computed) == 36
    assert mismatches(part, computed) == []
    # and the bounds are tight enough for this to mean something
    assert all(row.std_error < 1e-6 * row.pf for row in computed)
    assert all(row.std_error < 1e-6 * row.pf for row in shipped)


def test_a_planted_wrong_row_is_caught() -> None:
    shipped, criterion = load_references("series"), Criterion(4.0, 16.0, 10)
    right = shipped.entries[criterion]
    for wrong in (right.pf * (1 + 1e-5), right.pf * (1 - 1e-5)):
        planted = {**shipped.entries, criterion: replace(right, pf=wrong)}
        found = mismatches(replace(shipped, entries=planted), shipped)
        assert len(found) == 1
        assert str(criterion) in found[0]


def test_file_has_one_row_per_line_and_13_digits(
    script: Script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tables = script("tables")
    monkeypatch.setattr(tables, "SHIPPED", tmp_path)
    rows = [
        Reference(Criterion(0.5475), 1 / 3, 2.341e-7),
        Reference(Criterion(-1.0, 0.04, Binomial(10, 0.7)), 1.23456789e-12, 0.0),
    ]
    tables.write("some_problem", "how", "command", rows)
    text = (tmp_path / "some_problem.json").read_text()
    assert json.loads(text)["problem"] == "some-problem"
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
