"""Fault trees in the Open-PSA format, read as structures."""

from __future__ import annotations

import time
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from uqfold import Structure
from uqfold.system.decision_diagram import diagram

PLANT = """<?xml version="1.0"?>
<!DOCTYPE opsa-mef>
<opsa-mef>
  <define-fault-tree name="plant">
    <define-gate name="top"><label>both ways of cooling</label>
      <or><gate name="G1"/><gate name="G2"/><basic-event name="CPU-1"/></or></define-gate>
    <define-gate name="G1"><and><gate name="G3"/><event name="b"/></and></define-gate>
    <define-gate name="G2"><atleast min="2"><gate name="G3"/><event name="c"/>
      <house-event name="H"/><event name="d" type="basic-event"/></atleast></define-gate>
    <define-gate name="G3"><or><basic-event name="a"/><basic-event name="b"/></or></define-gate>
    <define-gate name="spare"><and><event name="a"/><constant value="true"/></and></define-gate>
    <define-house-event name="H"><constant value="false"/></define-house-event>
  </define-fault-tree>
  <model-data><define-basic-event name="a"><float value="0.1"/></define-basic-event></model-data>
</opsa-mef>
"""


def of(tmp_path: Path, formula: str, more: str = "") -> Structure:
    return read(tmp_path, f'<define-gate name="top">{formula}</define-gate>{more}')


def read(tmp_path: Path, gates: str, top: str | None = None) -> Structure:
    file = tmp_path / "tree.xml"
    tree = f'<define-fault-tree name="t">{gates}</define-fault-tree>'
    file.write_text(f"<opsa-mef>{tree}</opsa-mef>", encoding="utf-8")
    return Structure.from_open_psa(file, top)


def test_gates_become_lines_and_failing_becomes_working(tmp_path: Path) -> None:
    (file := tmp_path / "plant.xml").write_text(PLANT, encoding="utf-8")
    structure = Structure.from_open_psa(file, "top")
    assert structure.expression.splitlines() == [
        "G3 = a & b",
        "G1 = G3 | b",
        "G2 = at_least(2, G3, c, d)",
        "G1 & G2 & CPU_1",
    ]
    assert structure.names == ("a", "b", "c", "d", "CPU_1")
    fails = np.array([0.1, 0.2, 0.05, 0.3, 0.01])
    exact = 0.0
    for state in product((False, True), repeat=5):
        a, b, c, d, cpu = state
        if ((a or b) and b) or (a or b) + c + d >= 2 or cpu:
            exact += float(np.prod(np.where(state, fails, 1.0 - fails)))
    found, _ = diagram(structure, structure.names).probabilities(fails, 1.0 - fails)
    assert found == pytest.approx(exact, rel=1e-13)
    assert Structure.from_open_psa(file, "spare").expression == "a"


def test_components_have_names_of_their_own(tmp_path: Path) -> None:
    """A valve in each component is another valve; the bus outside is the same one."""

    def train(name: str) -> str:
        return (
            f'<define-component name="{name}"><define-gate name="fails">'
            '<or><basic-event name="valve"/><basic-event name="bus"/></or></define-gate>'
            '<define-basic-event name="valve"/></define-component>'
        )

    both = '<and><gate name="A.fails"/><gate name="B.fails"/></and>'
    structure = of(tmp_path, both, train("A") + train("B"))
    assert set(structure.names) == {"t_A_valve", "t_B_valve", "bus"}


def test_a_gate_that_a_house_event_makes_needless_is_left_out(tmp_path: Path) -> None:
    """Refused: the part 'G' is named and not used."""
    off = '<define-house-event name="H"><constant value="false"/></define-house-event>'
    gate = '<define-gate name="G"><or><event name="b"/><event name="c"/></or></define-gate>'
    formula = '<or><event name="a"/><and><house-event name="H"/><gate name="G"/></and></or>'
    assert of(tmp_path, formula, gate + off).expression == "a"


def test_a_gate_of_three_thousand_events_is_read(tmp_path: Path) -> None:
    """Signs between so many names were too much for Python."""
    events = "".join(f'<event name="e{i}"/>' for i in range(3_000))
    for kind in ("or", "and"):
        structure = of(tmp_path, f"<{kind}>{events}</{kind}>")
        assert diagram(structure, structure.names).size == 3_002


@pytest.mark.parametrize("gate_first", [True, False])
def test_chains_of_a_thousand_gates(tmp_path: Path, gate_first: bool) -> None:
    """Each names the one before; where it did so first, half a million nodes did not suffice."""
    text = '<define-gate name="g0"><event name="e0"/></define-gate>'
    for i in range(1, 1_000):
        inside = [f'<gate name="g{i - 1}"/>', f'<event name="e{i}"/><event name="e{i // 2}"/>']
        inside = inside if gate_first else inside[::-1]
        kind = ("or", "and")[i % 2]
        text += f'<define-gate name="g{i}"><{kind}>{"".join(inside)}</{kind}></define-gate>'
    begun = time.process_time()
    structure = read(tmp_path, text)
    found = diagram(structure, structure.names)
    assert time.process_time() - begun < 5.0
    fails = np.random.default_rng(8).random((1_000, 50)) < np.linspace(0.1, 0.9, 50)
    system = fails[0]
    for i in range(1, 1_000):
        both = fails[i], fails[i // 2]
        system = system & both[0] & both[1] if i % 2 else system | both[0] | both[1]
    order = [int(name.removeprefix("e")) for name in structure.names]
    answer, _ = found.probabilities(fails[order].astype(float), 1.0 - fails[order])
    assert (answer == system).all()
    assert 0 < answer.sum() < 50


def test_formulas_may_stand_deep_within_each_other(tmp_path: Path) -> None:
    """Three thousand of them were too deep."""
    formula = '<event name="a"/>'
    for i in range(1_500):
        formula = f'<or><and>{formula}<event name="b{i}"/></and><event name="c{i}"/></or>'
    structure = of(tmp_path, formula)
    assert diagram(structure, structure.names).size == 2 + 3_001


def test_a_hundred_gates_with_repeated_events_take_seconds(tmp_path: Path) -> None:
    """Against the same tree evaluated state by state, in random states."""
    rng = np.random.default_rng(4)
    formulas: list[tuple[str, list[str]]] = []
    for i in range(100):
        below = [f"e{j}" for j in rng.integers(max(0, i - 4), i + 5, 3)]
        above = [
            f"g{j}" for j in {i - 1, int(rng.integers(max(0, i - 4), max(1, i)))} if 0 <= j < i
        ]
        formulas.append((str(rng.choice(["and", "or", "atleast"])), sorted({*below, *above})))
    text = ""
    for i, (kind, parts) in enumerate(formulas):
        inside = "".join(
            f'<{"gate" if one[0] == "g" else "basic-event"} name="{one}"/>' for one in parts
        )
        least = ' min="2"' if kind == "atleast" else ""
        text += f'<define-gate name="g{i}"><{kind}{least}>{inside}</{kind}></define-gate>'
    begun = time.process_time()
    structure = read(tmp_path, text, "g99")
    assert len(structure.expression.splitlines()) > 50
    found = diagram(structure, structure.names)
    assert time.process_time() - begun < 5.0
    states = rng.random((len(structure.names), 200)) < 0.5
    fails = dict(zip(structure.names, states, strict=True))
    for i, (kind, parts) in enumerate(formulas):
        count = sum(fails.get(one, np.zeros(200, bool)).astype(int) for one in parts)
        fails[f"g{i}"] = count >= {"and": len(parts), "or": 1, "atleast": 2}[kind]
    answer, _ = found.probabilities(states.astype(float), 1.0 - states)
    assert 0 < answer.sum() < 200
    assert (answer == fails["g99"]).all()


@pytest.mark.parametrize(
    ("gates", "top", "said"),
    [
        ('<define-gate name="g"><not><event name="a"/></not></define-gate>', None, "not monotone"),
        ('<define-gate name="g"><xor><event name="a"/></xor></define-gate>', None, "not monotone"),
        ('<define-gate name="g"><and><gate name="h"/></and></define-gate>', None, "'h' is not def"),
        ('<define-gate name="g"><or><gate name="g"/></or></define-gate>', "g", "within itself"),
        ('<define-gate name="g"><or/></define-gate>', None, "asks for 1 of 0 parts"),
        (
            '<define-gate name="g"><atleast min="3"><event name="a"/></atleast></define-gate>',
            None,
            "asks for 3 of 1",
        ),
        (
            '<define-gate name="g"><or><event name="a-b"/><event name="a_b"/></or></define-gate>',
            None,
            "both read as a_b",
        ),
        ('<define-gate name="g"><constant value="true"/></define-gate>', None, "always fails"),
        (
            '<define-gate name="g"><event name="a"/></define-gate>',
            "h",
            "top = 'h': gate 'h' is not defined",
        ),
        ("", None, "it has none"),
        (
            '<define-gate name="g"><gate name="h"/></define-gate>'
            '<define-gate name="h"><gate name="g"/></define-gate>',
            None,
            "some are used within themselves",
        ),
        # the micro sign and the Greek letter, which Python reads as one
        (
            '<define-gate name="g"><or>'
            '<event name="\u00b5"/><event name="\u03bc"/></or></define-gate>',
            None,
            "both read as \u03bc",
        ),
        ('<define-gate name="g"/>', None, "0 formulas"),
        ('<define-gate name="g"><event/></define-gate>', None, "has no name"),
        (
            '<define-gate name="g"><event name="a"/></define-gate>'
            '<define-gate name="h"><event name="a"/></define-gate>',
            None,
            "2 gates are used by no other",
        ),
    ],
)
def test_what_cannot_be_read_is_refused(
    tmp_path: Path, gates: str, top: str | None, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        read(tmp_path, gates, top)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "1 to"),
        ("<a", "no XML"),
        ("<a/>", "its root is <a>"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><opsa-mef>&b;</opsa-mef>', "defines entities"),
    ],
)
def test_a_file_that_is_no_fault_tree_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (file := tmp_path / "other.xml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=said):
        Structure.from_open_psa(file)


def test_groups_of_common_causes_are_not_passed_over_in_silence(tmp_path: Path) -> None:
    (file := tmp_path / "ccf.xml").write_text(
        PLANT.replace(
            "<model-data>", '<define-CCF-group name="x" model="beta-factor"/><model-data>'
        )
    )
    with pytest.warns(UserWarning, match="not read; give what units share"):
        Structure.from_open_psa(file, "top")
