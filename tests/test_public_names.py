"""What packages hand out: every name works, is written once, and is known to type checkers."""

import os
from importlib import import_module
from pathlib import Path

import pytest

import uqfold
from uqfold.lazy import GONE, MOVED

ROOT = Path(__file__).parents[1]
PACKAGES = [
    "uqfold", "uqfold.analysis", "uqfold.comparison", "uqfold.evaluation", "uqfold.inputs",
    "uqfold.mechanism", "uqfold.methods", "uqfold.plots", "uqfold.problems", "uqfold.report",
    "uqfold.system", "uqfold.testing", "uqfold.validation",
]  # fmt: skip


@pytest.mark.parametrize("name", PACKAGES)
def test_a_package_hands_out_its_names_and_nothing_else(name: str) -> None:
    """``__all__`` and ``dir`` hold what people need; every name works, and is written once."""
    package = import_module(name)
    assert dir(package) == sorted(package.__all__) == sorted(set(package.__all__))
    for one in package.__all__:
        assert not one.startswith("_")
        assert getattr(package, one) is not None
    assert package.__doc__
    text = Path(str(package.__file__)).read_text(encoding="utf-8")
    assert [one for one in package.__all__ if f'"{one}"' in text] == []
    with pytest.raises(AttributeError, match="no attribute 'Krigin'"):
        package.Krigin  # noqa: B018


def test_the_rooms_that_messages_name_are_reachable() -> None:
    rooms = {"analysis", "comparison", "evaluation", "methods", "plots", "problems", "validation"}
    assert rooms <= set(uqfold.__all__)
    assert uqfold.evaluation.Processes
    assert {path.parent.name for path in ROOT.glob("uqfold/*/__init__.pyi")} == {
        name.removeprefix("uqfold.") for name in PACKAGES[1:]
    }


FORMER = {
    "analysis": "Design InputParameter NoSurfaceError PfDerivative PfDerivatives Scan SobolIndex "
    "SobolIndices Verification chaos_sobol design_input design_threshold design_thresholds "
    "pick_freeze score_derivatives surface_derivatives verify verify_all",
    "comparison": "Case ComparisonPlan MethodRun Records RecordsError RunHeader available_cases "
    "compare named_case plan_comparison read_records records_from_frame run_comparison "
    "write_records",
    "evaluation": "BudgetExceededError Column Dask EngineError EvaluationSession Evaluator "
    "ExecutorError ExternalCode FailedRunError Futures InProcess Processes Regex RunningEstimate "
    "Store StoreError TimeLimitError per_sample",
    "evidence": "Axis CaseRecord Column Figure Finding Measurement PlantedFault RecordError Series "
    "StoredResult Table Verdict read_case_record read_case_records verdict_of write_case_record",
    "inputs": "JointInputs joint_inputs normal product_inputs",
    "mechanism": "DEFAULT_TOLERANCE BaumgarteTrajectory ContactLaw TangentialVelocity Trajectory "
    "WingParameters baumgarte_trajectory deployment_times ideal_deployment_times motion_table "
    "trajectory",
    "methods": "ActiveKriging AskTellSession ConditionalMonteCarlo CriterionResult Estimate "
    "FFNIPearson FFNISaddlepoint Kriging MonteCarlo OpenTURNSFORM OpenTURNSMonteCarlo "
    "PolynomialChaos ReliabilityMethod ReliabilityResult SequentialMethod Solution Task available "
    "build",
    "plots": "benchmark reliability",
    "problems.wing": "CONDITIONS",
    "problems": "Problem Reference ReferenceTable Unit folding_wing folding_wing_random_lengths "
    "four_bar four_branch series",
    "report": "ComparisonTable error_against_evaluations reliability_curves report_page "
    "write_figures write_report",
    "testing": "CHECKS ContractError LinearNormalSystem check_method",
}
"""Public names of version 0.1.0, and those that went since, by package."""


@pytest.mark.parametrize("room", FORMER)
def test_a_public_name_of_the_former_release_works_or_says_what_to_use(room: str) -> None:
    """`uqfold.report.reliability_curves`, among others, went without a warning."""
    package = import_module(f"uqfold.{room}")
    for name in FORMER[room].split():
        known = f"{package.__name__}.{name}"
        if name in getattr(package, "__all__", ()):
            assert getattr(package, name) is not None
        elif known in MOVED:
            home, _, name_there = MOVED[known].rpartition(".")
            with pytest.warns(DeprecationWarning, match=f"{known} is {MOVED[known]} now") as said:
                assert getattr(package, name) is getattr(import_module(home), name_there)
            assert said[0].filename == __file__
            assert name not in dir(package)
        else:
            with pytest.raises(AttributeError, match=rf"{name!r}: .* now"):
                getattr(package, name)
    listed = {f"uqfold.{one}.{name}" for one, names in FORMER.items() for name in names.split()}
    assert MOVED.keys() | GONE.keys() <= listed


def test_a_from_import_of_a_former_name_warns_once_and_says_what_to_use() -> None:
    """It asks twice: `from uqfold.evidence import Finding` warned for both."""
    with pytest.warns(DeprecationWarning, match=r"uqfold\.validation\.Finding now") as told:
        from uqfold.evidence import Finding
    assert Finding is uqfold.validation.Finding
    assert [one.filename for one in told] == [__file__]
    with pytest.raises(ImportError, match=r"a uqfold\.validation\.Points now"):
        from uqfold.evidence import Axis  # noqa: F401


def test_a_type_checker_sees_a_misspelt_method(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``uqfold.methods.Krigin()`` passed mypy."""
    mypy = pytest.importorskip("mypy.api")
    # what is handed out is in the stubs alone, which are read in a second
    for stub in ROOT.glob("uqfold/**/__init__.pyi"):
        copy = tmp_path / stub.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(stub.read_bytes())
    # and in this folder the whole package would be
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "script.py"
    uses = "methods.Kriging", "methods.Krigin", "problems.series", "problems.serie"
    script.write_text("\n".join(["import uqfold", *(f"uqfold.{use}" for use in uses)]))
    options = "--config-file=", "--ignore-missing-imports", "--no-site-packages"
    found, _, _ = mypy.run([*options, f"--cache-dir={os.devnull}", str(script)])
    assert [line for line in found.splitlines() if 'has no attribute "Krigin"' in line], found
    assert [line for line in found.splitlines() if 'has no attribute "serie"' in line], found
    assert found.count("error:") == 2, found
