"""The catalogue: every limit state has a source, a reference that is found again, and a kind."""

import re
import runpy
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from uqfold.problems import Problem, catalogue
from uqfold.problems.catalogue import limit_states
from uqfold.problems.criterion import LIMIT_STATE_THRESHOLD, Criterion

ROOT = Path(__file__).resolve().parents[2]
NAMES = list(catalogue.titles())
AGAIN = [
    pytest.param(name, marks=pytest.mark.slow) if catalogue.entry(name).dear else name
    for name in NAMES
]
PROBLEMS: dict[str, Problem] = {}


def problem(name: str) -> Problem:
    if name not in PROBLEMS:
        PROBLEMS[name] = catalogue.problem(name)
    return PROBLEMS[name]


THIN = {"genz-corner", "paraboloid-shell", "resonance", "rosenbrock-valley"}
"""Their domains of failure are too thin to be met by draws from a wider space."""


@pytest.mark.parametrize("name", AGAIN)
def test_the_reference_is_found_again(name: str) -> None:
    one = catalogue.entry(name)
    pf, error = one.reference()
    assert 0.0 <= error <= 1e-6 * pf
    assert pf == pytest.approx(one.pf, rel=1e-10, abs=error + one.error)


@pytest.mark.thorough
def test_simulation_agrees_with_references() -> None:
    """Of few inputs, which draws from a wider space fill."""
    simulated = [name for name in NAMES if name not in THIN and problem(name).inputs.dimension <= 6]
    assert len(simulated) > 10
    for name in simulated:
        agrees_with_simulation(name)


def agrees_with_simulation(name: str) -> None:
    """Draws spread over a wider normal space, weighted; nothing of the derivation takes part."""
    one, inputs = catalogue.entry(name), problem(name).inputs
    d = inputs.dimension
    spread = 2.0 if one.pf < 1e-3 else 1.0 + 2.0 / d
    u = spread * np.random.default_rng(7).standard_normal((20_000, d))
    weight = spread**d * np.exp(-0.5 * (u * u).sum(axis=1) * (1.0 - spread**-2))
    fails = one.limit_state(inputs.from_standard_normal(u)) <= 0.0
    assert fails.sum() >= 40, name
    found = weight * fails
    error = 4.0 * found.std() / np.sqrt(found.size) + one.error
    assert abs(found.mean() - one.pf) <= error, name


@pytest.mark.parametrize("name", NAMES)
def test_rows_stand_for_themselves(name: str) -> None:
    one, built = catalogue.entry(name), problem(name)
    assert built.name == name
    assert built.n_units == 1
    u = 1.5 * np.random.default_rng(3).standard_normal((40, built.inputs.dimension))
    x = built.inputs.from_standard_normal(u)
    before = x.copy()
    g = one.limit_state(x)
    np.testing.assert_array_equal(x, before)
    assert g.shape == (40,)
    assert g.dtype == np.float64
    assert np.isfinite(g).all()
    alone = [one.limit_state(x[i : i + 1])[0] for i in range(40)]
    np.testing.assert_allclose(g, alone, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(built.model(x), -g)


@pytest.mark.parametrize("name", NAMES)
def test_what_an_entry_says_fits_together(name: str) -> None:
    one, built = catalogue.entry(name), problem(name)
    assert set(one.kinds) <= catalogue.KINDS.keys()
    assert ("high dimension" in one.kinds) == (built.inputs.dimension >= 20)
    assert ("rare" in one.kinds) == (one.pf < 2e-6)
    assert ("frequent" in one.kinds) == (one.pf > 0.05)
    assert one.units.keys() <= set(built.inputs.names)
    assert re.search(r"\b(19|20)\d\d\b", one.source)
    assert len(one.how) > 10
    assert 0.0 < one.error < 0.02 * one.pf
    assert built.references is not None
    kept = built.references.lookup(Criterion(LIMIT_STATE_THRESHOLD))
    assert kept is not None
    assert (kept.pf, kept.std_error) == (one.pf, one.error)


def test_there_are_three_of_every_kind() -> None:
    count = Counter(kind for name in NAMES for kind in catalogue.entry(name).kinds)
    assert {kind for kind in catalogue.KINDS if count[kind] < 3} == set()


def test_titles_tell_one_from_the_other() -> None:
    titles = catalogue.titles()
    assert len(set(titles.values())) == len(titles) >= 30
    assert all(10 < len(title) < 98 for title in titles.values())


def test_published_values_are_judged_by_their_last_digit() -> None:
    one = catalogue.entry("rp55")
    assert one.wrong() == {"Reliability problems repository": pytest.approx(0.36 / one.pf - 1.0)}
    # 0.0313 is our 0.03132 to its digits
    assert catalogue.entry("rp53").wrong() == {}
    assert catalogue.entry("rp111").wrong() == {"otbenchmark": pytest.approx(-0.048, abs=1e-3)}


def test_an_unknown_name_is_refused_with_the_choices() -> None:
    with pytest.raises(ValueError, match=r"name = 'zz': .*choose from .*'rp22'"):
        catalogue.problem("zz")
    assert limit_states.__doc__


ODD = {("four-branch", 2.185961e-3), ("rp22", 4.2692e-3)}
"""What was reported as simulation, but is no whole number of failures."""


def test_reported_simulations_agree_with_the_references() -> None:
    """Billions of runs by others, and whole numbers of failures among them."""
    table = catalogue.literature()
    assert list(table.columns) == ["problem", "method", "runs", "pf", "cov", "source"]
    assert not table.duplicated().any()
    assert table[["problem", "method", "pf", "source"]].notna().all(axis=None)
    assert table.problem.isin(NAMES).all()
    assert (table.runs.dropna() >= 1).all()
    simulated = table[table.method == "Monte Carlo"]
    assert len(simulated) > 30
    for row in simulated.itertuples():
        pf = catalogue.entry(row.problem).pf
        deviation = np.sqrt(pf * (1.0 - pf) / row.runs)
        assert abs(row.pf - pf) < 3.0 * deviation, row
        if (row.problem, row.pf) in ODD:
            continue
        failures = row.pf * row.runs
        assert abs(failures - round(failures)) < max(1e-3, 1e-6 * failures), row
        if row.cov > 0.0:
            assert row.cov == pytest.approx(deviation / pf, rel=0.06), row


def test_the_page_tells_the_catalogue() -> None:
    page = runpy.run_path(str(ROOT / "docs" / "catalogue.py"))
    assert page["main"](["--check"]) == 0, "run python docs/catalogue.py"
