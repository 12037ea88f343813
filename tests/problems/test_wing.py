"""The folding wing: Tables 6, 8, 9 and 10, units, changed inputs, refusals."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from uqfold.evaluation.identity import model_identity
from uqfold.mechanism import WingParameters, deployment_times, ideal_deployment_times
from uqfold.methods.factorial_design import factorial_design
from uqfold.problems import Problem, deployment_time, folding_wing, folding_wing_random_lengths
from uqfold.problems.deployment_time import INPUT_UNITS
from uqfold.problems.wing import TABLE_6, TABLE_10
from uqfold.provenance import source_digest

# as printed: number -> (input, value); 1 to 10 are means, 11 to 20 standard deviations
TABLE_8 = {
    1: ("V_q", 100), 2: ("V_q", 180), 3: ("delta", 30), 4: ("delta", -30), 5: ("b", 6),
    6: ("b", 8), 7: ("k_d", 600), 8: ("k_d", 500), 9: ("C_r", 2), 10: ("C_r", 1),
}  # fmt: skip
TABLE_9 = {
    11: ("V_q", 1), 12: ("V_q", 20), 13: ("delta", 1), 14: ("delta", 20), 15: ("b", 0.01),
    16: ("b", 0.5), 17: ("k_d", 1), 18: ("k_d", 30), 19: ("C_r", 0.005), 20: ("C_r", 0.2),
}  # fmt: skip


def moments(problem: Problem) -> dict[str, tuple[float, float]]:
    return {
        name: (marginal.getMean()[0], marginal.getStandardDeviation()[0])
        for name, marginal in zip(problem.inputs.names, problem.inputs.marginals, strict=True)
    }


def test_inputs_are_those_of_the_tables() -> None:
    assert moments(folding_wing()) == TABLE_6
    assert moments(folding_wing_random_lengths()) == TABLE_10
    for problem in (folding_wing(), folding_wing_random_lengths()):
        assert problem.inputs.shared_names == ("V_q", "delta")
        assert problem.input_units == tuple(INPUT_UNITS[name] for name in problem.inputs.names)
        assert (problem.n_units, problem.response_unit) == (4, "s")


def test_full_rule_of_example_6_has_the_papers_size() -> None:
    assert len(factorial_design(folding_wing_random_lengths().inputs, 3, 5).x) == 28_125
    assert len(factorial_design(folding_wing().inputs, 3, 5).x) == 1_125


def test_one_moment_changes_and_the_others_stay() -> None:
    for number, (name, value) in (TABLE_8 | TABLE_9).items():
        mean, deviation = TABLE_6[name]
        changed = (value, deviation) if number <= 10 else (mean, value)
        moment = "means" if number <= 10 else "standard_deviations"
        arguments = {moment: {name: value}}
        assert moments(folding_wing(**arguments)) == {**TABLE_6, name: changed}


@pytest.mark.parametrize("build", [folding_wing, folding_wing_random_lengths])
def test_a_changed_table_keeps_the_model_and_drops_what_belongs_to_the_printed_one(
    build: Callable[..., Problem],
) -> None:
    printed, changed = build(), build(means={"C_r": 1.0}, standard_deviations={"V_q": 1})
    assert printed.default_criteria is not None
    assert changed.default_criteria is None
    assert changed.references is None
    # one model, so that a store shares its runs
    assert (changed.name, changed.version, changed.model) == (
        printed.name,
        printed.version,
        printed.model,
    )


def test_other_code_has_another_version_so_that_no_store_serves_both(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One provenance: it says which deployment times in a store are those of this mechanism."""
    now, other_wing = folding_wing(), folding_wing(WingParameters(C_r=0.0016))
    assert now.version == folding_wing().version == folding_wing_random_lengths().version
    assert other_wing.version != now.version
    code = deployment_time._code()
    assert code[0] == source_digest(deployment_time)
    monkeypatch.setattr(deployment_time, "_code", lambda: ({**code[0], "x": "0"}, code[1]))
    changed = folding_wing()
    assert changed.version != now.version
    assert model_identity(changed) != model_identity(now)


def test_values_of_table_6_given_again_are_example_3() -> None:
    again = folding_wing(means={"V_q": np.float64(140.0)}, standard_deviations={"b": 0.25})
    assert again.references == folding_wing().references
    assert again.references is not None
    assert folding_wing_random_lengths().references is None


def test_model_takes_the_units_of_the_tables() -> None:
    x = np.array([[200.0, -25.0, 1100.0, 6.0, 1.5, 1502.0, 1297.0]])
    arguments = {
        "V_q": 200.0, "delta": math.radians(-25.0), "k_d": 1100.0, "b": 0.006, "C_r": 0.0015,
        "l_1": 1.502, "l_2": 1.297,
    }  # fmt: skip
    problem = folding_wing_random_lengths()
    assert problem.low_fidelity is not None
    full, ideal = problem.model(x), problem.low_fidelity(x)
    wing = WingParameters()
    np.testing.assert_allclose(full, deployment_times(wing, **arguments), rtol=0, atol=1e-9)
    np.testing.assert_allclose(ideal, ideal_deployment_times(wing, **arguments), rtol=0, atol=1e-12)
    # the lengths matter, and each in its own way
    swapped = problem.model(x[:, [0, 1, 2, 3, 4, 6, 5]])
    assert abs(swapped[0] - full[0]) > 1e-3 or not np.isfinite(swapped[0])


def test_example_6_at_the_means_has_the_known_time() -> None:
    x = np.array([[mean for mean, _ in TABLE_10.values()]])
    assert folding_wing_random_lengths().model(x)[0] == pytest.approx(0.35551, abs=5e-5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"means": {"v_q": 1.0}},
            "means = .*: no input is named 'v_q', only V_q, delta, k_d, b, C_r",
        ),
        ({"means": {"l_1": 1500.0}}, "no input is named 'l_1'"),
        ({"means": {"delta": math.nan}}, r"means\['delta'\] = nan: give a finite number"),
        ({"standard_deviations": {"k_d": 0.0}}, r"\['k_d'\] = 0.0: give a positive number"),
        (
            {"standard_deviations": {"k_d": math.inf}},
            r"\['k_d'\] = inf: give a positive number that is finite",
        ),
        ({"means": {"C_r": 10.0}}, "means of its inputs: C_r = 0.01 m leaves no journal"),
        ({"means": {"V_q": -1.0}}, "means of its inputs: V_q = -1.0: give a value"),
    ],
)
def test_impossible_changes_are_refused(
    arguments: dict[str, dict[str, float]], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        folding_wing(**arguments)


@pytest.mark.parametrize("value", ["7", True, None])
def test_a_value_that_is_no_number_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match=rf"means\['b'\] = {value!r}: give a finite number$"):
        folding_wing(means={"b": value})  # type: ignore[dict-item]


def test_lengths_that_do_not_assemble_are_refused() -> None:
    with pytest.raises(
        ValueError, match="no wing can be built at the means of its inputs: x_lock = "
    ):
        folding_wing_random_lengths(means={"l_1": 4000.0})
