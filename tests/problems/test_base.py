"""The problem record: both forms, units and structure, plain limit states, refusals."""

import math
import pickle
from collections.abc import Callable
from copy import copy, deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import openturns as ot
import pytest
from hypothesis import given
from hypothesis import strategies as st

from uqfold import CutSets, KOutOfN, Parallel, Problem, Series, Unit, criteria
from uqfold.inputs import from_data, normal
from uqfold.methods import MonteCarlo
from uqfold.problems import series
from uqfold.problems.base import LIMIT_STATE_THRESHOLD
from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import ReferenceTable


def first_column(x: np.ndarray) -> np.ndarray:
    return x[:, 0]


TWO = {"a": normal(0, 1), "b": normal(1, 2)}


def test_product_form_puts_shared_inputs_first() -> None:
    problem = Problem(first_column, shared={"v": normal(5, 1)}, individual=TWO, units=4)
    assert problem.inputs.names == ("v", "a", "b")
    assert problem.inputs.n_shared == 1
    assert problem.n_units == 4
    assert problem.exchangeable
    assert problem.structure == Series()
    assert problem.name == "first_column"
    assert problem.input_units == ("", "", "")
    assert problem.default_criteria is None
    assert problem.references is None
    assert problem.version is None
    assert problem.low_fidelity is None


def test_joint_form_puts_the_named_inputs_first() -> None:
    joint = ot.JointDistribution([normal(0, 1), normal(5, 1), normal(9, 1)])
    joint.setDescription(["a", "v", "w"])
    problem = Problem(first_column, inputs=joint, shared=["w", "v"])
    assert problem.inputs.names == ("w", "v", "a")
    assert problem.inputs.n_shared == 2
    assert [m.getMean()[0] for m in problem.inputs.marginals] == [9.0, 5.0, 0.0]


@pytest.mark.parametrize("side", ["shared", "individual"])
def test_one_kind_of_inputs_is_enough(side: str) -> None:
    problem = Problem(first_column, **{side: TWO})
    assert problem.inputs.names == ("a", "b")
    assert problem.inputs.n_shared == (2 if side == "shared" else 0)
    assert problem.n_units == 1


def test_names_and_units_of_inputs() -> None:
    problem = Problem(
        first_column,
        shared=normal(0, 1),
        individual=[normal(0, 1), normal(0, 1)],
        names=["speed", "force", "width"],
        input_units=["m/s", "N", "mm"],
        name="p",
        response="time",
        response_unit="s",
    )
    assert problem.inputs.names == ("speed", "force", "width")
    assert problem.input_units == ("m/s", "N", "mm")
    assert (problem.name, problem.response, problem.response_unit) == ("p", "time", "s")
    assert repr(problem) == (
        "Problem('p', JointInputs(shared: speed; individual: force, width), "
        "units=1, structure=Series())"
    )


def test_inputs_that_nobody_named_are_numbered() -> None:
    problem = Problem(first_column, shared=normal(0, 1), individual=normal(0, 1))
    assert problem.inputs.names == ("x1", "x2")


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"individual": TWO, "units": 0},
            ValueError,
            "units = 0: give a list of Unit or a whole number >= 1",
        ),
        ({"individual": TWO, "units": -2}, ValueError, "units = -2"),
        ({"individual": TWO, "units": True}, TypeError, "units = True"),
        ({"individual": TWO, "units": 2.5}, ValueError, r"units = 2\.5"),
        ({"individual": TWO, "units": []}, ValueError, r"units = \[\]: give at least one"),
        ({"individual": TWO, "units": [1, 2]}, TypeError, r"units\[0\] = 1: give a Unit"),
        ({"individual": TWO, "units": "ab"}, TypeError, "units = 'ab'"),
        ({"individual": TWO, "units": None}, TypeError, "units = None"),
        ({}, ValueError, "no inputs: give shared=, individual= or inputs="),
        ({"individual": {}}, ValueError, "an empty list of distributions"),
        ({"individual": 3.0}, TypeError, r"3\.0 is not a distribution"),
        ({"inputs": TWO, "individual": TWO}, ValueError, "either inputs= or individual="),
        ({"inputs": TWO, "shared": ["c"]}, ValueError, "'c' is not one of the inputs"),
        ({"inputs": TWO, "shared": ["a", "a"]}, ValueError, "not 'a' twice"),
        (
            {"inputs": TWO, "shared": "a"},
            TypeError,
            "shared = 'a': give a list; .* shared= is a list of input names",
        ),
        ({"inputs": TWO, "shared": TWO}, TypeError, "shared= is a list of input names"),
        ({"inputs": TWO, "shared": normal(0, 1)}, TypeError, "shared= is a list of input names"),
        (
            {"inputs": TWO, "shared": 1},
            TypeError,
            "shared = 1: give a list; .* shared= is a list of input names",
        ),
        ({"inputs": TWO, "shared": [0]}, TypeError, "shared= is a list of input names"),
        ({"individual": TWO, "names": ["a"]}, ValueError, "1 names for 2 inputs"),
        ({"individual": TWO, "names": ["a", "a"]}, ValueError, "not 'a' twice"),
        (
            {"individual": TWO, "input_units": ["m"]},
            ValueError,
            r"input_units = \('m',\): give one for each of 2 inputs",
        ),
        ({"shared": {"a": normal(0, 1)}, "individual": TWO}, ValueError, "'a' is named twice"),
        (
            {"individual": TWO, "structure": "parallel"},
            TypeError,
            "structure = 'parallel': give Se",
        ),
        ({"individual": TWO, "low_fidelity": 3}, TypeError, "low_fidelity = 3: give a function"),
    ],
)
def test_what_does_not_fit_together_is_refused(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        Problem(first_column, **arguments)


def test_the_model_must_be_callable() -> None:
    with pytest.raises(TypeError, match=r"model = 3\.0: give a function of X"):
        Problem(3.0, individual=TWO)  # type: ignore[arg-type]


@pytest.mark.parametrize("units", [np.int64(3), 3])
def test_number_of_units_is_a_plain_int(units: Any) -> None:
    problem = Problem(first_column, individual=TWO, units=units)
    assert type(problem.units) is int
    assert problem.n_units == 3


def test_units_that_differ() -> None:
    units = [Unit(name="left"), Unit(offset=0.5, name="right")]
    problem = Problem(first_column, individual=TWO, units=units)
    assert problem.n_units == 2
    assert not problem.exchangeable
    assert problem.units == tuple(units)


@pytest.mark.parametrize("structure", [Series(), Parallel(), KOutOfN(3), CutSets([[0, 1], [2]])])
def test_structures_that_fit(structure: Any) -> None:
    problem = Problem(first_column, individual=TWO, units=3, structure=structure)
    assert problem.structure == structure


@pytest.mark.parametrize(
    ("structure", "message"),
    [
        (KOutOfN(4), "cannot hold for a system of 3 units"),
        (CutSets([[0, 3]]), "names unit 3, but the system has 3 units, from 0"),
    ],
)
def test_structures_that_need_more_units_are_refused(structure: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Problem(first_column, individual=TWO, units=3, structure=structure)


def test_a_problem_is_frozen() -> None:
    problem = Problem(first_column, individual=TWO)
    with pytest.raises(AttributeError):
        problem.units = 5  # type: ignore[misc]


def test_default_criteria_and_references_are_carried() -> None:
    grid = criteria([1.0, 2.0])
    table = ReferenceTable("p", "integration", "", "", {})
    problem = Problem(first_column, individual=TWO, default_criteria=grid, references=table)
    assert problem.default_criteria is grid
    assert problem.references == table


# A plain limit state: failure when g <= 0, to the last bit.


def works(g: float) -> bool:
    problem = Problem.from_limit_state(first_column, TWO)
    assert problem.default_criteria is not None
    y = problem.model(np.array([[g, 0.0]]))
    return bool(y[0] <= problem.default_criteria[0].threshold)


SMALLEST = math.nextafter(0.0, 1.0)


@pytest.mark.parametrize("g", [0.0, -0.0, -SMALLEST, -2.2e-308, -1.0, -1e308, -math.inf])
def test_limit_state_fails_at_and_below_zero(g: float) -> None:
    assert not works(g)


@pytest.mark.parametrize("g", [SMALLEST, 2 * SMALLEST, 2.2e-308, 1.0, 1e308, math.inf])
def test_limit_state_works_above_zero(g: float) -> None:
    assert works(g)


@given(st.floats(allow_nan=False))
def test_limit_state_agrees_with_its_definition_everywhere(g: float) -> None:
    assert works(g) == (g > 0.0)


def test_limit_state_at_nan_is_a_failed_run() -> None:
    problem = Problem.from_limit_state(first_column, TWO)
    assert np.isnan(problem.model(np.array([[math.nan, 0.0]]))[0])


def test_limit_state_problem() -> None:
    def margin(x: np.ndarray) -> list[float]:
        return [float(value) for value in x[:, 0]]

    problem = Problem.from_limit_state(margin, TWO)
    assert problem.n_units == 1
    assert problem.inputs.n_shared == 0
    assert problem.name == "margin"
    assert list(problem.default_criteria or ()) == [Criterion(LIMIT_STATE_THRESHOLD)]
    assert math.nextafter(0.0, -1.0) == LIMIT_STATE_THRESHOLD < 0.0
    np.testing.assert_array_equal(problem.model(np.array([[2.0, 0.0]])), [-2.0])
    other = Problem.from_limit_state(margin, TWO, name="other", default_criteria=criteria(-1.0))
    assert other.name == "other"
    assert other.default_criteria == criteria(-1.0)


def test_limit_state_with_an_atom_at_zero_counts_it_as_failed() -> None:
    # g = max(u, 0): P(g <= 0) = 1/2, all of it at g = 0
    problem = Problem.from_limit_state(lambda x: np.maximum(x[:, 0], 0.0), TWO)
    row = MonteCarlo(systems=20_000).estimate(problem, rng=5)[0]
    assert abs(row.pf - 0.5) < 4.5 * row.std_error


def test_limit_state_survives_pickling() -> None:
    problem = Problem.from_limit_state(first_column, TWO)
    model = pickle.loads(pickle.dumps(problem.model))
    np.testing.assert_array_equal(model(np.array([[3.0, 0.0]])), [-3.0])


def test_other_moments_keep_everything_but_references() -> None:
    table = ReferenceTable("first_column", "integration", "", "", {})
    problem = Problem(
        first_column, shared={"v": normal(5, 1)}, individual=TWO, units=4, references=table,
        version="1",
    )  # fmt: skip
    changed = problem.with_moments(means={"v": 6.0}, standard_deviations={"b": 3.0})
    assert changed.inputs.means.tolist() == [6.0, 0.0, 1.0]
    assert changed.inputs.standard_deviations.tolist() == [1.0, 1.0, 3.0]
    assert (changed.units, changed.version, changed.name) == (4, "1", "first_column")
    assert changed.references is None
    assert problem.inputs.means.tolist() == [5.0, 0.0, 1.0]
    assert problem.references == table


def test_a_limit_state_has_one_unit() -> None:
    with pytest.raises(ValueError, match="units = 2: a limit state has one unit"):
        Problem.from_limit_state(first_column, TWO, units=2)


def test_a_problem_with_another_number_of_units() -> None:
    """`dataclasses.replace` was refused; references are those of four units only."""
    problem = series()
    three = replace(problem, units=3)
    assert (three.n_units, three.references, three.version) == (3, None, problem.version)
    assert three.default_criteria == problem.default_criteria
    assert replace(problem, units=4, name="four").references == problem.references


def test_a_problem_with_other_inputs_of_its_own_or_shared() -> None:
    """Refused, as if inputs= were given; and units with inputs of their own, whatever changed."""
    problem = Problem(
        first_column, shared={"V": normal(0, 1)}, individual={"U": normal(0, 1)}, units=2
    )
    own = replace(problem, individual={"a": normal(1, 1), "b": normal(0, 3)})
    assert own.inputs.names == ("V", "a", "b")
    assert own.inputs.means.tolist() == [0.0, 1.0, 0.0]
    shared = replace(own, shared=[normal(5, 2)], units=[Unit(individual={"c": normal(7, 1)})])
    assert (shared.inputs.n_shared, shared.inputs.means.tolist()) == (1, [5.0, 7.0])
    assert replace(shared, structure=Parallel()).inputs.means.tolist() == [5.0, 7.0]
    assert replace(problem, inputs={"x": normal(0, 1)}).inputs.names == ("x",)
    with pytest.raises(ValueError, match=r"input_units = .*: give one for each of 4 inputs"):
        replace(replace(problem, input_units=("m", "s")), individual=ot.Normal(3))


@pytest.mark.parametrize("copied", [copy, deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_keeps_its_references_until_it_asks_something_else(
    copied: Callable[[Problem], Problem],
) -> None:
    """Whatever changes pf leaves them out."""
    problem = copied(series())
    assert replace(problem, name="copy").references is not None
    other = problem.with_moments(means={"X2": 1.3}).inputs
    assert replace(problem, inputs=other).references is None
    assert replace(problem, structure=Parallel()).references is None
    assert replace(problem, model=np.sum).references is None


def test_the_digest_of_a_system_tells_what_is_not_the_model() -> None:
    """The same for the same, in another process too; another for other inputs, units, structure."""
    base = series()
    others = [
        replace(base, units=3),
        replace(base, structure=Parallel()),
        base.with_moments(means={"X2": 1.3}),
        Problem(base.model, inputs=base.inputs.distribution, shared=["X1", "X2"], units=4),
        replace(base, units=[Unit(offset=0.5), Unit(), Unit(), Unit()]),
        *(correlated_pair(r) for r in (0.3, 0.4)),
        # what text does not tell: as many other data, a change beyond the digits that are printed
        *(measured(shift) for shift in (0.0, 0.1)),
        *(base.with_moments(means={"X2": mean}) for mean in (1.23456711, 1.23456722)),
    ]
    digests = [base.system_digest, *(one.system_digest for one in others)]
    assert len(set(digests)) == len(digests)
    assert series().system_digest == replace(base, name="other").system_digest == digests[0]


def measured(shift: float) -> Problem:
    data = np.linspace(0.0, 1.0, 50) ** 2 + 5.0 + shift
    return Problem(np.sum, individual={"x": from_data(data)})


def correlated_pair(r: float) -> Problem:
    marginals = [ot.Normal(), ot.Normal()]
    joint = ot.JointDistribution(marginals, ot.NormalCopula(ot.CorrelationMatrix([[1, r], [r, 1]])))
    return Problem(series().model, inputs=joint)
