"""The cases of validation/mechanism: a quick form of each holds, and a planted fault breaks it."""

import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from importlib import import_module
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "validation" / "mechanism"
Case = Callable[[str], ModuleType]


@pytest.fixture(scope="module")
def case() -> Iterator[Case]:
    """Import scripts by file name, as they import each other when they are run."""
    names = {path.stem for path in FOLDER.glob("*.py")}
    sys.path.insert(0, str(FOLDER))
    try:
        yield import_module
    finally:
        sys.path.remove(str(FOLDER))
        for name in names:
            sys.modules.pop(name, None)


def verdict(case, findings):
    return case("claims").verdict_of(findings)


def with_onset_velocity_2_percent_off(wing):
    """The wing whose damping is that of an onset velocity 2 % too large."""
    return wing.replace(C_e=math.sqrt(1 - (1 - wing.C_e**2) / 1.02))


def with_wrong_friction_sign(wing):
    """A record that WingParameters would refuse."""
    return SimpleNamespace(**asdict(wing) | {"C_f": -wing.C_f})


def test_verdicts(case):
    finding = case("claims").Finding
    kept, broken = finding("a", 1.0, 2.0), finding("a", 3.0, 2.0)
    quoted, unknown = finding("a", 3.0), finding("a", remark="figures only")
    assert [f.verdict for f in (kept, broken, quoted, unknown)] == [
        "holds",
        "does not hold",
        None,
        "cannot be judged",
    ]
    assert finding("a", math.nan, 2.0).verdict == "does not hold"
    assert finding("a", 1.0, 2.0, at_least=True).verdict == "does not hold"
    assert verdict(case, [kept, quoted, unknown]) == "holds"
    assert verdict(case, [kept, broken]) == "does not hold"
    assert verdict(case, [quoted, unknown]) == "cannot be judged"


def test_a_report_says_what_was_measured(case, tmp_path, capsys):
    claims = case("claims")
    claim = claims.Claim("a_case", "It is so.", "another", "1 s", "python a_case.py")
    assert claims.report(claim, [claims.Finding("time", 3.0, 2.0, "s")], tmp_path) == 1
    assert "time: 3 s (at most 2 s) - does not hold" in capsys.readouterr().out
    content = json.loads((tmp_path / "a_case.json").read_text(encoding="utf-8"))
    assert (content["verdict"], content["findings"][0]["value"]) == ("does not hold", 3.0)


def test_parameter_sets_cover_the_tables(case):
    sets = case("parameter_sets")
    wings = sets.parameter_sets()
    assert len(wings) >= 40
    six = [wing for name, wing in wings.items() if name.startswith("table 6 corner")]
    for name, (mean, sigma) in sets.TABLE_6.items():
        levels = {round((getattr(wing, name) - mean) / sigma, 9) for wing in six}
        assert levels == {-3.0, 3.0}
    ten = [wing for name, wing in wings.items() if name.startswith("table 10 corner")]
    for table, corners in ((sets.TABLE_6, six), (sets.TABLE_10, ten)):
        signs = np.array(
            [[np.sign(getattr(w, n) - mean) for n, (mean, _) in table.items()] for w in corners]
        )
        # every pair of variables takes all its combinations equally often
        np.testing.assert_array_equal(signs.T @ signs, len(corners) * np.eye(len(table)))


# --- against SciPy


def test_stored_scipy_times_are_those_of_the_integration(case):
    against, sets = case("against_scipy"), case("parameter_sets").parameter_sets()
    stored = against.stored_times()
    assert stored.keys() == sets.keys()
    name = "table 10"
    again = case("independent").deployment_time(sets[name])
    assert again == pytest.approx(stored[name][0], abs=1e-8)


def test_times_of_scipy(case):
    against, sets = case("against_scipy"), case("parameter_sets").parameter_sets()
    expected = against.stored_times()
    rows = against.compare(sets, expected)
    assert len(rows) >= 40
    assert sum(row["chaotic"] == "no" for row in rows) > 0.8 * len(rows)
    assert verdict(case, against.judge(rows)) == "holds"


def test_scipy_sees_a_wrong_onset_velocity(case):
    against, sets = case("against_scipy"), case("parameter_sets").parameter_sets()

    def times(wing, shifts):
        return against.uqfold_times(with_onset_velocity_2_percent_off(wing), shifts)

    rows = against.compare(sets, against.stored_times(), times)
    assert verdict(case, against.judge(rows)) == "does not hold"


@pytest.mark.slow
def test_scipy_sees_a_wrong_sign_of_friction(case):
    against, sets = case("against_scipy"), case("parameter_sets").parameter_sets()
    name = "table 10, material"
    wrong = case("independent").deployment_time(with_wrong_friction_sign(sets[name]))
    rows = against.compare({name: sets[name]}, {name: [wrong]})
    assert verdict(case, against.judge(rows)) == "does not hold"


# --- against exudyn


def test_times_of_exudyn(case):
    against, sets = case("against_exudyn"), case("parameter_sets").parameter_sets()
    rows = against.compare(sets, against.stored_times())
    assert {row["set"] for row in rows} == set(against.SETS)
    assert verdict(case, against.judge(rows)) == "holds"

    def time(wing):
        return against.uqfold_time(with_onset_velocity_2_percent_off(wing))

    rows = against.compare(sets, against.stored_times(), time)
    assert verdict(case, against.judge(rows)) == "does not hold"


@pytest.mark.slow
def test_stored_exudyn_times_are_those_of_exudyn(case):
    pytest.importorskip("exudyn")
    against, sets = case("against_exudyn"), case("parameter_sets").parameter_sets()
    name = "table 10"
    again = against.exudyn_times(sets[name], [4 * against.STEPS[-1]])[0]
    assert again == pytest.approx(against.stored_times()[name][-1], abs=against.AGREEMENT)


# --- against the paper's own form, and the ideal model


@pytest.mark.slow
def test_baumgarte_form(case):
    form = case("baumgarte_form")
    names = form.SETS[:3]
    assert verdict(case, form.judge(form.compare(names))) == "holds"

    def time(wing):
        return form.uqfold_time(with_onset_velocity_2_percent_off(wing))

    assert verdict(case, form.judge(form.compare(names, time))) == "does not hold"

    def drifting(wing, alpha, beta):
        m = form.motion(wing, alpha, beta)
        return replace(m, position_drift=m.position_drift + 1e-8)

    assert verdict(case, form.judge(form.compare(names, move=drifting))) == "does not hold"


def test_ideal_partner(case):
    partner = case("ideal_partner")
    found = partner.follow()
    assert found["correlation"] > 0.999
    assert verdict(case, partner.judge(partner.compare(), found)) == "holds"

    def time(wing):
        return partner.ideal_time(wing.replace(c=wing.c * (1 + 1e-6)))

    assert verdict(case, partner.judge(partner.compare(time), found)) == "does not hold"


# --- accuracy


def test_accuracy(case):
    accuracy = case("accuracy")
    assert verdict(case, accuracy.judge(accuracy.measure(draws=400))) == "holds"


@pytest.mark.parametrize(
    "fault",
    [
        lambda time: lambda *a, tolerance, **x: time(*a, tolerance=100 * tolerance, **x),
        lambda time: lambda *a, **x: time(*a, **x) + 1e-5,
    ],
    ids=["coarse", "biased"],
)
def test_accuracy_sees_coarse_or_biased_times(case, fault):
    accuracy = case("accuracy")
    rows = accuracy.measure(draws=400, times=fault(accuracy.deployment_times))
    assert verdict(case, accuracy.judge(rows)) == "does not hold"


# --- order of convergence


@pytest.mark.slow
def test_order_of_convergence(case):
    order = case("convergence_order")
    smooth = order.smooth_errors()
    impacts = order.impact_errors()
    assert verdict(case, order.judge([*smooth, *impacts])) == "holds"

    def of_order_2(w, state, h):
        # the positions of a step of Taylor's formula to second order
        end = order.one_step(w, state, h)
        rates = zip(state.q, state.v, state.a, strict=True)
        return end._replace(q=tuple(x + h * (v + 0.5 * h * a) for x, v, a in rates))

    rows = [*order.smooth_errors(of_order_2), *impacts]
    assert verdict(case, order.judge(rows)) == "does not hold"

    def event_missed(wing, tolerance):
        # an onset found only to the length of a step leaves an error of first order
        m = order.motion(wing, tolerance)
        late = m.coordinates + 1e-2 / len(m.time)
        return replace(m, coordinates=late)

    rows = [*smooth, *order.impact_errors(event_missed)]
    assert verdict(case, order.judge(rows)) == "does not hold"


# --- energy


def some_wings(case):
    sets = case("parameter_sets").parameter_sets()
    return {name: sets[name] for name in ("table 6", "table 10", "table 10 corner -+--+-+")}


def audited(case, move=None):
    energy = case("energy_audit")
    wings = energy.both_velocities(some_wings(case))
    rows = [energy.audit(wing, move or energy.motion) for wing in wings.values()]
    return energy.judge(rows)


def test_energy_audit(case):
    assert verdict(case, audited(case)) == "holds"


@pytest.mark.parametrize(
    "fault",
    [
        lambda m: replace(m, friction_loss=-m.friction_loss),
        lambda m: replace(m, contact_loss=-m.contact_loss),
        lambda m: replace(m, contact_loss=0.99 * m.contact_loss),
        lambda m: replace(m, work_drag=0.99 * m.work_drag),
        lambda m: replace(m, elastic_energy=0.0 * m.elastic_energy),
    ],
    ids=["friction's sign", "damping's sign", "1 % of damping", "1 % of drag", "no elasticity"],
)
def test_the_audit_sees_energy_from_nowhere(case, fault):
    motion = case("energy_audit").motion
    assert verdict(case, audited(case, lambda wing: fault(motion(wing)))) == "does not hold"


# --- limits


@pytest.fixture(scope="module")
def limit_rows(case):
    limits = case("limits")
    return {
        "clearance": limits.small_clearances(),
        "lossless": limits.lossless(),
        "momentum": limits.momentum(),
        "impacts": limits.impacts(),
    }


def judged(case, rows, **planted):
    return case("limits").judge([row for part in (rows | planted).values() for row in part])


def test_limits(case, limit_rows):
    assert verdict(case, judged(case, limit_rows)) == "holds"


def test_limits_see_a_clearance_that_does_not_vanish(case, limit_rows):
    limits = case("limits")

    def time(wing, C_r):
        return limits.wing_time(wing, C_r + 1e-4)

    planted = judged(case, limit_rows, clearance=limits.small_clearances(time))
    assert verdict(case, planted) == "does not hold"


def test_limits_see_a_loss(case, limit_rows):
    limits = case("limits")

    def leaking(wing):
        return limits.motion(wing.replace(C_e=0.999))

    planted = judged(case, limit_rows, lossless=limits.lossless(leaking))
    assert verdict(case, planted) == "does not hold"


def test_limits_see_an_unbalanced_impulse(case, limit_rows):
    limits = case("limits")

    def unbalanced(wing):
        # the rod keeps 0.1 % of the speed that an impact gave it
        m = limits.motion(wing)
        velocities = m.velocities.copy()
        velocities[:, 1] *= 1.001
        return replace(m, velocities=velocities)

    planted = judged(case, limit_rows, momentum=limits.momentum(unbalanced))
    assert verdict(case, planted) == "does not hold"


def test_limits_see_a_wrong_onset_velocity(case, limit_rows):
    limits = case("limits")

    def ratio(C_e):
        return limits.returned(math.sqrt(1 - (1 - C_e**2) / 1.02))

    planted = judged(case, limit_rows, impacts=limits.impacts(ratio))
    assert verdict(case, planted) == "does not hold"


# --- slider-crank


@pytest.mark.slow
def test_slider_crank(case):
    crank = case("slider_crank")
    assert verdict(case, crank.judge(crank.measure())) == "holds"
    # contacts that feed energy in keep even the smallest clearances rattling
    assert verdict(case, crank.judge(crank.measure(hysteresis=-0.3))) == "does not hold"


def test_stored_slider_crank_is_judged_as_reported(case):
    crank, claims = case("slider_crank"), case("claims")
    rows = [
        {key: float(value) for key, value in row.items()}
        for row in claims.read_rows(FOLDER / "slider_crank.csv")
    ]
    findings = crank.judge(rows)
    assert verdict(case, findings) == "holds"
    assert "cannot be judged" in {finding.verdict for finding in findings}


# --- table and pictures


def test_the_page_has_the_table_of_the_results(case):
    assert case("results_table").main(["--check"]) == 0


def test_the_table_shows_a_broken_claim(case):
    table = case("results_table")
    cases = table.results()
    cases[0]["verdict"] = "does not hold"
    text = table.PAGE.read_text(encoding="utf-8")
    assert table.page_with(text, table.table(cases)) != text


def test_pictures_are_drawn(case, tmp_path):
    pictures = case("pictures")
    assert pictures.main(["--out", str(tmp_path)]) == 0
    for name in [*pictures.PICTURES, pictures.ANIMATION]:
        assert (tmp_path / name).stat().st_size > 10_000
        assert (pictures.IMAGES / name).exists()
