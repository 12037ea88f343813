"""Structures of units: exact algebra on what units do, given the shared inputs."""

from __future__ import annotations

import math
import time
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr
from scipy.stats import binom

from uqfold import Criterion, CutSets, KOutOfN, Parallel, PathSets, Problem, Series, Structure
from uqfold.inputs import normal
from uqfold.methods import Kriging, OpenTURNSFORM
from uqfold.system.decision_diagram import diagram
from uqfold.system.linearised import linearised_failure
from uqfold.system.structure import SystemUnits
from uqfold.testing.linear_normal import works_as

NAMES = tuple(f"u{i}" for i in range(6))
CUTS = [[0, 1], [2, 3], [1, 4, 2], [0, 3, 5]]


@pytest.mark.parametrize(
    "structure",
    [
        Series(),
        Parallel(),
        KOutOfN(4),
        CutSets(CUTS),
        PathSets(CUTS),
        Structure("at_least(2, u0 & u1, u2 | u3, u4, u0) | u1 and u3 & u5"),
        Structure("""
            both = u0 & u1
            some = at_least(2, both, u2, u3)
            some & u4 | both & u5 | some & u3
        """),
    ],
)
def test_units_that_differ_in_any_structure(structure: Any) -> None:
    """Against the sum over all states; `Parallel` and its like were answered by nothing."""
    fails = np.random.default_rng(7).uniform(1e-6, 0.2, (6, 3)) ** 3
    failure, success = diagram(structure, NAMES).probabilities(fails, 1.0 - fails)
    exact = np.zeros((2, 3))
    for works in product((False, True), repeat=6):
        chance = np.prod(np.where(np.array(works)[:, None], 1.0 - fails, fails), axis=0)
        exact[int(works_as(structure, works))] += chance
        response = diagram(structure, NAMES).response(np.where(works, -1.0, 1.0))
        assert (response < 0.0) == works_as(structure, works)
    assert failure == pytest.approx(exact[0], rel=1e-12, abs=0.0)
    assert success == pytest.approx(exact[1], rel=1e-12, abs=0.0)


def test_both_tails_keep_their_digits() -> None:
    """pf = 1e-12 and 1 - pf = 1e-12 alike: neither is formed from the other."""
    p = np.array([1e-9, 1e-4, 0.3])
    shape = (20, 3)
    found = diagram(KOutOfN(18), tuple(f"u{i}" for i in range(20)))
    few = found.probabilities(np.broadcast_to(p, shape), np.broadcast_to(1.0 - p, shape))
    most = found.probabilities(np.broadcast_to(1.0 - p, shape), np.broadcast_to(p, shape))
    assert few[0] == pytest.approx(binom.sf(2, 20, p), rel=1e-11, abs=0.0)
    assert most[1] == pytest.approx(binom.sf(17, 20, p), rel=1e-11, abs=0.0)
    assert few[0][0] < 1e-23


def test_two_hundred_units_take_no_states() -> None:
    """100 of 200 units that differ: as many nodes as the recursion has, and under a second."""
    fails = np.random.default_rng(3).random((200, 8))
    begun = time.process_time()
    found = diagram(KOutOfN(100), tuple(f"u{i}" for i in range(200)))
    failure, success = found.probabilities(fails, 1.0 - fails)
    assert found.size == 2 + 100 * 101
    assert time.process_time() - begun < 1.0
    assert failure + success == pytest.approx(1.0, rel=1e-12)
    spread = np.sqrt((fails * (1.0 - fails)).sum(axis=0))
    # a sum of many: normal to a few percent, with the correction for whole numbers
    assert failure == pytest.approx(ndtr((fails.sum(axis=0) - 100.5) / spread), rel=0.05)


GROUPS = [range(4 * g, 4 * g + 4) for g in range(5)]
LINKS = ([0, 3], [1, 4], [0, 2, 4], [1, 2, 3])
BRIDGE = Structure(
    "|".join("&".join(f"u{i}" for group in path for i in GROUPS[group]) for path in LINKS)
)
"""A bridge of five groups of four units in series."""


def bridge_failure(p: float) -> float:
    q = (1.0 - p) ** 4
    return 1.0 - (2.0 * q**2 + 2.0 * q**3 - 5.0 * q**4 + 2.0 * q**5)


@pytest.mark.parametrize(
    ("structure", "beta", "failure"),
    [
        (Parallel(), 0.5, lambda p: p**20),
        (KOutOfN(2), 0.5, lambda p: 20.0 * (1.0 - p) * p**19 + p**20),
        (BRIDGE, 2.5, bridge_failure),
    ],
)
def test_equicorrelated_linear_units(structure: Any, beta: float, failure: Any) -> None:
    """Twenty units that fail if sqrt(rho) Z + sqrt(1 - rho) E > beta: to 1e-8 in any structure."""
    problem = Problem(lambda x: x[:, 0], individual=normal(0, 1), units=20, structure=structure)
    rho = 0.4
    begun = time.process_time()
    units = SystemUnits.of(problem)
    pf, reliability = linearised_failure(beta, rho, units)
    assert time.process_time() - begun < 1.0

    def integrand(z: float) -> float:
        p = float(ndtr((math.sqrt(rho) * z - beta) / math.sqrt(1.0 - rho)))
        return float(failure(p)) * math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)

    exact = quad(integrand, -9.0, 9.0, epsabs=1e-13, epsrel=1e-11, limit=200)[0]
    assert pf == pytest.approx(exact, rel=1e-8)
    assert pf + reliability == pytest.approx(1.0, rel=1e-12)


def test_a_long_expression_is_read_and_built_without_recursion() -> None:
    """Two rows of 900 valves beside each other: it went as deep as it was long."""
    rows = (" & ".join(f"u{i}" for i in range(start, start + 900)) for start in (0, 900))
    structure = Structure(" | ".join(rows))
    found = diagram(structure, tuple(f"u{i}" for i in range(1800)))
    assert found.size == 2 + 1800
    p = np.full((1800, 1), 1e-6)
    failure, _ = found.probabilities(p, 1.0 - p)
    assert failure == pytest.approx(math.expm1(900 * math.log1p(-1e-6)) ** 2, rel=1e-10)


def test_how_failure_changes_with_that_of_each_unit() -> None:
    found = diagram(CutSets(CUTS), NAMES)
    fails = np.random.default_rng(1).random((6, 4))
    failure, changes = found.with_derivatives(fails, 1.0 - fails)
    np.testing.assert_allclose(failure, found.probabilities(fails, 1.0 - fails)[0], rtol=1e-14)
    for unit, change in enumerate(changes):
        # the failure of a system is linear in that of each unit
        surely = np.where(np.arange(6)[:, None] == unit, 1.0, fails)
        never = np.where(np.arange(6)[:, None] == unit, 0.0, fails)
        ends = [found.probabilities(one, 1.0 - one)[0] for one in (never, surely)]
        np.testing.assert_allclose(change, ends[1] - ends[0], rtol=1e-12, atol=1e-15)


def test_a_structure_that_needs_too_many_nodes_is_refused(monkeypatch: Any) -> None:
    monkeypatch.setattr("uqfold.system.decision_diagram.MOST_NODES", 1000)
    with pytest.raises(ValueError, match="a decision diagram of more than 1,000 nodes"):
        diagram(KOutOfN(99), tuple(f"u{i}" for i in range(200)))


def test_too_large_a_structure_is_refused_before_any_run() -> None:
    """A surface was fitted first."""
    sets = np.random.default_rng(1).integers(0, 100, (120, 3))
    problem = Problem(
        lambda x: x[:, 0], individual=normal(0, 1), units=100, structure=CutSets(sets.tolist())
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("uqfold.system.decision_diagram.MOST_NODES", 1000)
        row = Kriging().estimate(problem, Criterion(2.0), rng=1)[0]
    assert (row.status, row.n_evals) == ("unsupported", 0)
    assert "more than 1,000 nodes" in row.message


def test_where_units_stand_decides_nothing() -> None:
    """Pairs of units that are far apart: a diagram in the order of units has 2^60 nodes."""
    problem = CutSets([[i, i + 60] for i in range(60)])
    found = diagram(problem, tuple(f"u{i}" for i in range(120)))
    assert found.size == 2 + 120
    p = np.full((120, 1), 1e-5)
    failure, _ = found.probabilities(p, 1.0 - p)
    assert failure == pytest.approx(-math.expm1(60 * math.log1p(-1e-10)), rel=1e-12)


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("a &", "a name is missing at the end"),
        ("a & | b", r"a name is missing before '\|'"),
        ("(a & b", "a bracket is not closed"),
        ("a & b)", r"'\)' is out of place"),
        ("a, b", "',' is out of place"),
        ("not a", "'not' is no unit name"),
        ("~a | b", "'~' is no unit name"),
        ("a + b", r"& or \| is missing before '\+'"),
        ("at_least(a, b)", "at_least takes a number"),
        ("at_least(3, a, b)", r"at_least\(3, ...\) counts 2 parts"),
        ("at_least(9", "at_least takes a number"),
        ("__import__('os')", r"& or \| is missing before '\('"),
        ("pump#1 & valve", "leave out #"),
        ("g = a & b", "its last line must say when the system works"),
        ("g = a\ng = b\ng", "'g' is named again"),
        ("h = a & g\ng = b\ng & h", "'g' is named again, or after its use"),
        ("g = a; h = b; h", "the part 'g' is named and not used"),
        ("a\nb", "'a' names no part"),
    ],
)
def test_what_is_no_structure_is_refused(expression: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Structure(expression)


def test_a_structure_names_units_of_the_problem() -> None:
    def problem(expression: str) -> Problem:
        return Problem(
            lambda x: x[:, 0], individual=normal(0, 1), units=2, structure=Structure(expression)
        )

    assert SystemUnits.of(problem("u1 | u0")).count == 2
    with pytest.raises(ValueError, match="u2 is the name of 0 units; there are u0, u1"):
        problem("u0 | u2")
    with pytest.raises(ValueError, match="'u1' is a part of it and a unit"):
        problem("u1 = u0\nu1 | u0")
    with pytest.raises(TypeError, match=r"structure = .*: give Series"):
        # comparing it with a structure compares its entries
        Problem(lambda x: x[:, 0], individual=normal(0, 1), units=2, structure=np.ones(2))


def test_the_error_of_form_is_that_of_the_structure() -> None:
    """What the surroundings of the design point may change went through a series of the units."""
    problem = Problem(
        lambda x: 0.2 * x[:, 0] + 0.9 * x[:, 1],
        shared={"V": normal(0, 1)},
        individual={"U": normal(0, 1)},
        units=4,
        structure=Parallel(),
    )
    row = OpenTURNSFORM().estimate(problem, Criterion(2.0), rng=1)[0]

    def integrand(v: float) -> float:
        return float(ndtr((0.2 * v - 2.0) / 0.9)) ** 4 * math.exp(-0.5 * v * v)

    exact = quad(integrand, -9.0, 9.0, epsabs=0.0, epsrel=1e-11)[0] / math.sqrt(2.0 * math.pi)
    assert row.pf == pytest.approx(exact, rel=1e-8)
    assert row.status == "converged"
    assert 0.0 < row.std_error < 0.02 * exact
