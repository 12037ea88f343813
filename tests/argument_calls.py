"""Good arguments for every public constructor, function and method, for `test_arguments`.

`calls` says how each of them is called; `WITHOUT_ARGUMENT_CHECKS` names those that only the package
itself calls, and why.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import openturns as ot
import pandas as pd

import uqfold
from tests.validation.records import full_record
from uqfold import (
    analysis,
    comparison,
    evaluation,
    inputs,
    mechanism,
    methods,
    plots,
    problems,
    report,
    system,
    testing,
    validation,
)
from uqfold.validation.record import write_case_record

WRONG: dict[str, Any] = {
    "true": True,
    "text": "5",
    "bytes": b"5",
    "none": None,
    "nan": math.nan,
    "infinity": math.inf,
    "minus infinity": -math.inf,
    "minus one": -1,
    "zero": 0,
    "fraction": 5.5,
    "huge": 10**400,
    "complex": 5j,
    "object": object(),
    "empty list": [],
    "nested list": [["5"]],
    "list of None": [None],
    "dict": {1: 2},
    "set": {5.5},
    "duration": np.timedelta64(5, "ns"),
    "class": dict,
}
ALL = frozenset(WRONG)


@dataclass(frozen=True)
class Kind:
    """What one parameter takes.

    Attributes
    ----------
    good
        A good value.
    same
        The same value in another type, which has to give the same answer.
    takes
        Which of the wrong values are good here.
    untried
        Which of them are good here, but cost too much to try.
    """

    good: Any
    same: Any = None
    takes: frozenset[str] = frozenset()
    untried: frozenset[str] = frozenset()

    def also(self, *names: str) -> Kind:
        assert set(names) <= ALL
        return replace(self, takes=self.takes | set(names))

    def except_for(self, *names: str) -> Kind:
        assert set(names) <= ALL
        return replace(self, untried=frozenset(names))


def count(value: int = 5) -> Kind:
    return Kind(value, np.int64(value))


def number(value: float = 0.5) -> Kind:
    return Kind(value, np.float64(value), frozenset({"fraction"}))


def any_number(value: float = 0.5) -> Kind:
    return number(value).also("minus one", "zero")


def flag(value: bool = True) -> Kind:
    return Kind(value, np.bool_(value), frozenset({"true"}))


def text(value: str = "some") -> Kind:
    return Kind(value, np.str_(value), frozenset({"text"}))


def choice(value: str) -> Kind:
    return Kind(value, np.str_(value))


def thing(value: Any) -> Kind:
    return Kind(value)


def anything(value: Any) -> Kind:
    return Kind(value, None, ALL)


def optional(kind: Kind) -> Kind:
    return kind.also("none")


def numbers(value: list[Any]) -> Kind:
    return Kind(value, np.array(value))


@dataclass(frozen=True)
class Call:
    """How something is called: a function of its parameters, and their kinds."""

    function: Callable[..., Any]
    kinds: dict[str, Kind]


def response(x: Any) -> Any:
    """Response of two inputs."""
    return x[:, 0] + x[:, 1]


def limit_state(x: Any) -> Any:
    """Limit state of one input."""
    return 3.0 - x[:, 0]


def read_output(folder: Path) -> float:
    """Read no output."""
    return math.nan


X = [[0.0, 1.0]]
POOL = ThreadPoolExecutor(1)


def nothing(*_: Any) -> None:
    """Listen to no progress."""


WITHOUT_ARGUMENT_CHECKS = {
    # answers: only the package builds them
    "analysis.Design", "analysis.InputParameter", "analysis.PfDerivative", "analysis.PfDerivatives",
    "analysis.PairedDifference", "analysis.PairedDifferences", "analysis.Scan",
    "analysis.SobolIndex", "analysis.SobolIndices", "analysis.Verification",
    "evaluation.RunningEstimate", "inputs.JointInputs",
    "mechanism.Trajectory", "methods.CriterionResult",
    "methods.Task", "ReliabilityResult", "validation.CaseRecord", "validation.Work",
    # the package's own side of store, executors and sessions
    "evaluation.EvaluationSession",
    "analysis.Scan.of",
    "evaluation.EvaluationSession.report", "evaluation.EvaluationSession.stream",
    "evaluation.EvaluationSession.expect", "evaluation.EvaluationSession.share",
    "evaluation.EvaluationSession.admit", "evaluation.EvaluationSession.label",
    "evaluation.Processes.discard", "evaluation.Store.get",
    "evaluation.Store.put", "Evaluator.open", "Evaluator.session", "Evaluator.session_of_told",
    "methods.AskTellSession", "methods.AskTellSession.replay",
    "methods.FullFactorial.grids", "methods.SparseGrid.grids", "methods.DimensionReduction.grids",
    "methods.Estimate.without_answer", "methods.Task.generator",
    "methods.Task.summed_up", "testing.LinearNormalSystem.partner",
    "testing.LinearNormalSystem.response",
    "validation.Work.parts", "validation.Work.pick", "validation.Work.progress",
    "validation.record_schema", "comparison.record_schema",
    # records without fields: their verbs are in the table
    "ReliabilityMethod", "methods.SequentialMethod",
    # a scheduler is needed: tests/evaluation/test_dask.py; one line and an exit code: tests/cli
    "evaluation.Dask", "cli.main",
    # a server is needed: tests/evaluation/test_um_bridge.py
    "evaluation.UMBridgeModel", "evaluation.ServedProblem",
}  # fmt: skip
"""Names that only the package itself calls, and those tested elsewhere."""


def calls(folder: Path) -> dict[str, Call]:
    """Return how every public name is called; files are read from and written to a folder."""
    normal = inputs.normal(0.0, 1.0)
    criterion = uqfold.Criterion(3.0)
    criteria = uqfold.criteria([3.0])
    problem = uqfold.Problem(
        response,
        shared={"a": normal},
        individual={"b": normal},
        units=2,
        default_criteria=criteria,
    )
    pair = uqfold.Problem(
        lambda x: x.sum(axis=1),
        shared={"a": normal},
        individual={"b": normal, "c": normal},
        default_criteria=criteria,
    )
    alone = uqfold.Problem(
        lambda x: x[:, 0], individual={"b": normal}, units=2, default_criteria=criteria
    )
    joint = problem.inputs
    *_, compared = comparison.run_comparison(problem, ["ffni-spa"], criteria)
    comparison.write_records(compared, folder)
    cheap = methods.FFNIPearson()
    known = {"reference_pf": 0.1, "reference_std_error": 0.0, "error": 0.01}
    frame = compared.assign(**known)
    answered = uqfold.benchmark("ffni-spa", "rp22", seeds=1, path=folder / "rows.jsonl")
    of_benchmark = {"frame": thing(answered)}
    design = analysis.design_threshold(problem, 0.1, (0.0, 9.0), method=cheap, points=9)
    designs = analysis.designs_to_frame([design], cheap, max_evals=1000)
    designs = designs.assign(label="mc", problem="some")
    slope = {"label": "mc", "input": "a", "moment": "mean", "threshold": 1.0}
    slopes = pd.DataFrame([slope | {"per_std": 1.0, "per_std_error": 0.1}])
    index = {"label": "mc", "input": "a", "order": "main", "index": 0.5}
    indices = pd.DataFrame([index | {"ci_low": 0.4, "ci_high": 0.6}])
    weights = {"birnbaum": 0.5, "birnbaum_independent": 0.4}
    weighed = pd.DataFrame([{"unit": "a", "threshold": 1.0, "missions": "1"} | weights])
    curve_options = {
        "curves": optional(choice("missions")),
        "differences": optional(thing(None)),
    }
    axes, page = plots.error_against_evaluations(frame), report.Page("some")
    drawn_into = plots.error_against_evaluations(frame)
    wing = mechanism.WingParameters(t_max=0.01)
    finding = validation.Finding("error", 0.5, 1.0)
    table = validation.Table("T", ("series", "x", "y"), (("a", 1.0, 2.0),))
    points = validation.Points("P", "x", "y", table)
    claim = validation.Claim("key", "It is so.", "Section 1", "always")
    gate = '<define-gate name="top"><event name="pump"/></define-gate>'
    (tree := folder / "tree.xml").write_text(
        f'<opsa-mef><define-fault-tree name="t">{gate}</define-fault-tree></opsa-mef>'
    )
    case_path = write_case_record(full_record(), folder / "cases" / "a_case.json")
    cases = case_path.parent
    session = methods.Kriging(runs=6).start(problem, criterion, rng=1)
    saved = folder / "session.json"
    session.save(saved)
    event = system.SystemEvent(problem, criterion)
    reference = problems.Reference(criterion, 0.1, 0.01)
    references = problems.ReferenceTable("p", "simulation", "so", "x", {criterion: reference})
    store = folder / "store.db"

    at = thing(problem)
    asked = thing(criteria).also("zero", "minus one", "fraction", "infinity", "minus infinity")
    of = {"problem": at, "criteria": optional(asked)}
    run = {
        "max_evals": optional(count(1_000)),
        "rng": optional(count(1)).also("zero"),
        "evaluator": optional(thing(uqfold.Evaluator())),
    }
    of_event = {"u": numbers([[0.0, 1.0, 2.0]])}
    on_event = {**of_event, "evaluate": thing(response)}
    method = thing(cheap).except_for("none")
    surface = thing(methods.PolynomialChaos(runs=10, max_degree=1)).except_for("none")
    some_methods = thing(["ffni-spa"]).except_for("none")
    anywhere = number(3.0).also("minus one", "zero", "infinity", "minus infinity")
    tau = optional(number(2.0).also("zero", "infinity"))
    between = numbers([0.0, 9.0])
    file = Kind(str(folder), Path(folder), frozenset({"text"}))
    moments = optional(thing({"b": 1.5}))
    wing_moments = optional(thing({"b": 7.5}))
    nodes = Kind(3, np.int64(3), frozenset({"empty list"}))
    estimate = {
        "pf": number(0.1).also("minus one", "zero", "nan", "infinity", "minus infinity"),
        **{name: optional(number(0.1).also("minus one", "zero", "nan", "infinity",
           "minus infinity")) for name in ("reliability", "pf_low", "pf_high")},
        **{name: number(0.1).also("minus one", "zero", "nan", "infinity", "minus infinity")
           for name in ("std_error", "ci_low", "ci_high")},
        "ci_kind": text(), "error_kind": text("sampling"), "status": text("converged"),
        "message": text(), "n_evals_row": optional(count()).also("zero"),
    }  # fmt: skip
    finding_kinds = {
        "what": text(),
        **{name: optional(any_number().also("nan", "infinity", "minus infinity"))
           for name in ("value", "limit")},
        "unit": text(), "at_least": flag(),
        "uncertainty": optional(number().also("zero", "infinity", "nan")), "remark": text(),
        "claim": text(),
    }  # fmt: skip
    return {
        "Binomial": Call(
            uqfold.Binomial,
            {"planned": count(), "p": Kind(0.5, np.float64(0.5), frozenset({"zero"}))},
        ),
        "Criteria": Call(uqfold.Criteria, {"criteria": thing([criterion])}),
        "Criterion": Call(
            uqfold.Criterion, {"threshold": anywhere, "tau": tau, "missions": count()}
        ),
        "CutSets": Call(uqfold.CutSets, {"sets": numbers([[0, 1]])}),
        "Evaluator": Call(
            uqfold.Evaluator,
            {
                "failed_runs": choice("bound"),
                "batch_rows": optional(count()),
                "progress": optional(thing(nothing)),
                "watch": optional(thing(nothing)),
                "store": optional(Kind(str(store), store, frozenset({"text"}))),
                "executor": optional(thing(evaluation.InProcess())),
                "max_seconds": optional(number()),
                "seconds_per_run": optional(number()),
                "samples": count().also("true"),
            },
        ),
        "KOutOfN": Call(uqfold.KOutOfN, {"k": count()}),
        "Parallel": Call(uqfold.Parallel, {}),
        "PathSets": Call(uqfold.PathSets, {"sets": numbers([[0, 1]])}),
        "Structure": Call(uqfold.Structure, {"expression": text("a")}),
        "Structure.from_open_psa": Call(
            uqfold.Structure.from_open_psa,
            {"path": thing(tree).also("text"), "top": optional(thing("top"))},
        ),
        "Series": Call(uqfold.Series, {}),
        "Problem": Call(
            uqfold.Problem,
            {
                "model": optional(thing(response)),
                "inputs": anything(None),
                "shared": optional(thing({"a": normal})),
                "individual": optional(thing({"b": normal})),
                "units": count(3),
                "structure": optional(thing(uqfold.Series())),
                "low_fidelity": optional(thing(response)),
                "gradient": optional(thing(response)),
                "version": optional(text()),
                "name": optional(text()),
                "response": text(),
                "response_unit": text(),
                "input_units": optional(thing(["m", "s"]).also("empty list")),
                "names": optional(thing(["c", "d"])),
                "default_criteria": optional(thing(criteria)),
                "references": optional(thing(references)).also("zero"),
            },
        ),
        "Problem.from_limit_state": Call(
            uqfold.Problem.from_limit_state, {"g": thing(limit_state), "inputs": thing([normal])}
        ),
        "Problem.from_openturns": Call(
            uqfold.Problem.from_openturns,
            {
                "event": thing(
                    ot.ThresholdEvent(
                        ot.CompositeRandomVector(
                            ot.SymbolicFunction(["x"], ["x"]), ot.RandomVector(ot.Normal())
                        ),
                        ot.Greater(),
                        1.0,
                    )
                )
            },
        ),
        "Problem.with_moments": Call(
            problem.with_moments, {"means": moments, "standard_deviations": moments}
        ),
        "ReliabilityResult.to_openturns": Call(
            methods.MonteCarlo(systems=50).estimate(problem, criteria, rng=0).to_openturns,
            {"event": optional(thing(None))},
        ),
        "ReliabilityMethod.estimate": Call(cheap.estimate, {**of, **run}),
        "ReliabilityMethod.supports": Call(
            cheap.supports, {"problem": at, "criterion": thing(criterion)}
        ),
        "Unit": Call(
            uqfold.Unit,
            {
                "model": optional(thing(response)),
                "individual": anything(None),
                "offset": any_number(),
                "name": text(),
                "low_fidelity": optional(thing(response)),
            },
        ),
        "compare": Call(
            uqfold.compare,
            {
                "problem": at,
                "methods": some_methods,
                "criteria": of["criteria"],
                **run,
                "reference": optional(thing(0.1)).also("zero"),
                "progress": optional(thing(nothing)),
            },
        ),
        "estimate": Call(
            uqfold.estimate,
            {"problem": at, "criteria": of["criteria"], "target": number(), **run},
        ),
        "criteria": Call(
            uqfold.criteria,
            {
                "threshold": anywhere.also("set"),
                "tau": tau.also("set", "list of None"),
                "missions": count(),
            },
        ),
        "analysis.Scan.interval": Call(design.scan.interval, {"value": any_number()}),
        "analysis.chaos_sobol": Call(
            analysis.chaos_sobol, {"problem": at, "method": surface, **run}
        ),
        "analysis.conditional_sobol": Call(
            analysis.conditional_sobol,
            {"problem": at, "samples": count(4), "repetitions": count(3), **run},
        ),
        "analysis.design_input": Call(
            analysis.design_input,
            {
                "problem": at,
                "criterion": thing(criterion),
                "target_pf": Kind(0.1, np.float64(0.1)),
                "input": choice("b"),
                "between": between,
                "moment": choice("mean"),
                "seek": choice("smallest"),
                "method": method,
                "points": optional(count()),
                **run,
            },
        ),
        "analysis.design_threshold": Call(
            analysis.design_threshold,
            {
                "problem": at,
                "target_pf": Kind(0.1, np.float64(0.1)),
                "between": between,
                "tau": tau,
                "missions": count(),
                "method": method,
                "points": count(9),
                **run,
            },
        ),
        "analysis.design_thresholds": Call(
            analysis.design_thresholds,
            {
                "problem": at,
                "target_pf": Kind(0.1, np.float64(0.1)),
                "between": between,
                "profiles": thing([(None, 1)]),
                "method": method,
                "points": count(9),
                **run,
            },
        ),
        "analysis.paired_differences": Call(
            analysis.paired_differences,
            {
                "first": thing(pair),
                "second": thing(pair.with_moments(standard_deviations={"c": 2.0})),
                "criteria": optional(asked),
                "draws": count(4),
                **run,
            },
        ),
        "analysis.pick_freeze": Call(
            analysis.pick_freeze,
            {"problem": at, "samples": count(4), "repetitions": count(3), **run},
        ),
        "analysis.score_derivatives": Call(
            analysis.score_derivatives,
            {**of, "systems": count(), "inputs": optional(thing(["b"])), **run},
        ),
        "analysis.surface_derivatives": Call(
            analysis.surface_derivatives,
            {
                **of,
                "problem": thing(alone),
                "method": surface,
                "inputs": optional(thing(["b"])),
                **run,
            },
        ),
        "analysis.verify": Call(
            analysis.verify,
            {"design": thing(design), "method": method, "value": optional(any_number()), **run},
        ),
        "analysis.verify_all": Call(
            analysis.verify_all,
            {"places": thing([(design, 2.0)]).also("empty list"), "method": method, **run},
        ),
        "analysis.designs_to_frame": Call(
            analysis.designs_to_frame,
            {"designs": thing([design]).also("empty list"), "verify_by": optional(method), **run},
        ),
        "analysis.importance_of_units": Call(
            analysis.importance_of_units,
            {**of, "problem": thing(alone), "method": surface, **run},
        ),
        "analysis.joint_failures": Call(
            analysis.joint_failures,
            {**of, "problem": thing(alone), "method": surface, **run},
        ),
        "analysis.independence": Call(
            analysis.independence,
            {
                "problem": at,
                "units": thing([1, 2]),
                "criteria": of["criteria"],
                "method": optional(thing(methods.FFNISaddlepoint())),
                "draws": optional(count(20)),
                "per_draw": count(16),
                "rng": run["rng"],
                "evaluator": run["evaluator"],
            },
        ),
        "comparison.NamedProblem": Call(
            comparison.NamedProblem,
            {
                "name": text(),
                "description": text(),
                "problem": thing(problems.series),
                "max_evals": count(),
            },
        ),
        "comparison.available_problems": Call(comparison.available_problems, {}),
        "benchmark": Call(
            uqfold.benchmark,
            {
                "methods": thing("ffni-spa").except_for("none"),
                "problems": thing("rp22").except_for("none"),
                "seeds": count(1),
                "max_evals": run["max_evals"],
                "path": optional(file),
                "workers": count(1),
                "max_seconds": optional(number()),
                "progress": optional(thing(nothing)),
                "command": text(),
            },
        ),
        "comparison.league_table": Call(comparison.league_table, of_benchmark),
        "comparison.problem_scores": Call(comparison.problem_scores, of_benchmark),
        "comparison.solving_costs": Call(comparison.solving_costs, of_benchmark),
        "comparison.read_benchmark": Call(comparison.read_benchmark, {"path": file}),
        "comparison.checked_frame": Call(comparison.checked_frame, {"frame": thing(frame)}),
        "comparison.comparison_header": Call(comparison.comparison_header, {"frame": thing(frame)}),
        "comparison.criteria_of": Call(
            comparison.criteria_of, {"header": thing(comparison.comparison_header(frame))}
        ),
        "comparison.named_problem": Call(comparison.named_problem, {"name": choice("series")}),
        "comparison.read_records": Call(comparison.read_records, {"path": file}),
        "comparison.run_comparison": Call(
            lambda **given: list(comparison.run_comparison(**given)),
            {
                "problem": at,
                "methods": some_methods,
                "criteria": of["criteria"],
                **run,
                "reference": optional(thing(0.1)).also("zero"),
                "progress": optional(thing(nothing)),
                "command": text(),
            },
        ),
        "comparison.write_records": Call(
            comparison.write_records, {"frame": thing(frame), "folder": file}
        ),
        "evaluation.Column": Call(
            evaluation.Column,
            {
                "file": text(),
                "column": count().also("zero", "minus one"),
                "row": count().also("zero", "minus one"),
                "delimiter": optional(text(",")),
            },
        ),
        "evaluation.EvaluationSession.evaluate": Call(
            uqfold.Evaluator().open(problem, None).evaluate, {"x": numbers(X)}
        ),
        "evaluation.EvaluationSession.gradients": Call(
            replace(
                uqfold.Evaluator().open(problem, None), slopes=(lambda x: np.zeros(x.shape),)
            ).gradients,
            {"x": numbers(X), "kind": Kind(0, np.int64(0), frozenset({"zero"}))},
        ),
        "evaluation.ExternalCode": Call(
            evaluation.ExternalCode,
            {
                "command": thing(["code", "{{a}}"]),
                "names": thing(["a"]),
                "output": thing(read_output),
                "templates": thing({}),
                "timeout": optional(number()),
                "parallel": count(),
                "folder": optional(file),
                "keep": choice("failed"),
            },
        ),
        "evaluation.Futures": Call(
            evaluation.Futures, {"executor": thing(POOL), "workers": optional(count())}
        ),
        "evaluation.InProcess": Call(evaluation.InProcess, {}),
        "evaluation.Processes": Call(
            evaluation.Processes, {"workers": optional(count()), "retries": count().also("zero")}
        ),
        "evaluation.Regex": Call(
            evaluation.Regex, {"pattern": Kind("(.*)", np.str_("(.*)")), "file": text()}
        ),
        "evaluation.Store": Call(
            evaluation.Store, {"path": Kind(str(store), store, frozenset({"text"}))}
        ),
        "evaluation.per_sample": Call(evaluation.per_sample, {"function": thing(limit_state)}),
        "validation.Claim": Call(
            validation.Claim,
            {
                "key": text(),
                "statement": text(),
                "source": text(),
                "rule": text(),
                "identity": flag(),
            },
        ),
        "validation.Finding": Call(validation.Finding, finding_kinds),
        "validation.Measurement": Call(
            validation.Measurement,
            {
                "findings": thing((finding,)).also("empty list"),
                "tables": thing((table,)).also("empty list"),
                "points": thing((points,)).also("empty list"),
                "claims": thing((claim,)).also("empty list"),
            },
        ),
        "validation.Points": Call(
            validation.Points,
            {
                "title": text(),
                "x": text(),
                "y": text(),
                "table": thing(table),
                "log": choice("xy"),
                "limits": optional(thing({"a": 1.0})),
            },
        ),
        "validation.Table": Call(
            validation.Table,
            {
                "title": text(),
                "columns": thing(("a",)),
                "rows": thing(((1.0,),)).also("empty list", "nested list", "list of None"),
            },
        ),
        "validation.Table.of": Call(
            validation.Table.of, {"title": text(), "rows": thing([{"a": 1.0}])}
        ),
        "validation.read_case_record": Call(
            validation.read_case_record,
            {"path": Kind(str(case_path), case_path, frozenset({"text"}))},
        ),
        "validation.read_case_records": Call(
            validation.read_case_records, {"folder": Kind(str(cases), cases, frozenset({"text"}))}
        ),
        "validation.verdict_of": Call(
            validation.verdict_of, {"findings": thing([finding]).also("empty list")}
        ),
        "inputs.JointInputs.in_order": Call(
            joint.in_order, {"order": numbers([1, 0]).also("empty list")}
        ),
        "inputs.JointInputs.log_density": Call(joint.log_density, {"x": numbers(X)}),
        "inputs.JointInputs.from_standard_normal": Call(
            joint.from_standard_normal, {"u": numbers(X)}
        ),
        "inputs.JointInputs.to_standard_normal": Call(joint.to_standard_normal, {"x": numbers(X)}),
        "inputs.JointInputs.with_moments": Call(
            joint.with_moments, {"means": moments, "standard_deviations": moments}
        ),
        "inputs.JointInputs.sample": Call(
            lambda rng, size: joint.sample(rng, size) is None,
            {"rng": thing(np.random.default_rng(1)), "size": count().also("zero")},
        ),
        "inputs.JointInputs.gauss_rule": Call(
            joint.gauss_rule, {"column": count(1).also("zero"), "n": count()}
        ),
        "inputs.from_data": Call(
            inputs.from_data,
            {
                "data": numbers(np.linspace(1.0, 2.0, 20).tolist()),
                "family": optional(choice("normal")),
                "bounds": thing((-math.inf, math.inf)),
            },
        ),
        "inputs.joint_inputs": Call(
            inputs.joint_inputs,
            {
                "inputs": thing({"a": normal, "b": normal}),
                "shared": thing(["a"]).also("empty list"),
                "names": optional(thing(["a", "b"])),
            },
        ),
        "inputs.bernoulli": Call(inputs.bernoulli, {"p": number()}),
        "inputs.poisson": Call(inputs.poisson, {"mean": number()}),
        "inputs.discrete": Call(
            inputs.discrete,
            {"values": numbers([0.0, 1.0]), "probabilities": numbers([0.4, 0.6])},
        ),
        "inputs.censored": Call(
            inputs.censored,
            {
                "distribution": thing(normal),
                "low": any_number(0.0).also("minus infinity"),
                "high": any_number(3.0).also("infinity"),
            },
        ),
        "inputs.normal": Call(inputs.normal, {"mean": any_number(), "std": number()}),
        "inputs.product_inputs": Call(
            inputs.product_inputs,
            {
                "shared": optional(thing([normal])),
                "individual": optional(thing([normal])),
                "names": optional(thing(["a", "b"])),
            },
        ),
        "mechanism.WingParameters": Call(
            mechanism.WingParameters,
            {"k_d": any_number(550.0), "contact_law": choice("gonthier"), "t_max": number(0.5)},
        ),
        "mechanism.WingParameters.replace": Call(wing.replace, {"C_e": Kind(0.5, np.float64(0.5))}),
        "mechanism.deployment_times": Call(
            mechanism.deployment_times,
            {
                "parameters": thing(wing),
                "tolerance": Kind(1e-6, np.float64(1e-6)),
                "threads": optional(count(1)),
                "V_q": numbers([140.0]).also(
                    "none",
                    "nan",
                    "infinity",
                    "minus infinity",
                    "minus one",
                    "zero",
                    "fraction",
                    "empty list",
                ),
            },
        ),
        "mechanism.ideal_deployment_times": Call(
            mechanism.ideal_deployment_times,
            {"parameters": thing(wing), "tolerance": Kind(1e-6, np.float64(1e-6))},
        ),
        "mechanism.motion_table": Call(
            mechanism.motion_table,
            {"parameters": thing(wing), "tolerance": Kind(1e-6, np.float64(1e-6))},
        ),
        "mechanism.trajectory": Call(
            mechanism.trajectory,
            {"parameters": thing(wing), "tolerance": Kind(1e-6, np.float64(1e-6))},
        ),
        "methods.ActiveKriging": Call(
            methods.ActiveKriging,
            {
                "runs": optional(count()),
                "target_cov": number(),
                "initial": optional(count()),
                "batch": count(),
                "explore": optional(count(1).also("zero")),
                "learning": choice("variance"),
                "kernel": choice("best"),
                "noise": optional(number().also("zero")),
                "tolerance": Kind(0.01, np.float64(0.01)),
                "controls": count(),
            },
        ),
        "system.SystemEvent": Call(
            system.SystemEvent, {"problem": at, "criterion": thing(criterion)}
        ),
        "system.SystemEvent.missions": Call(event.missions, of_event),
        "system.SystemEvent.evals": Call(event.evals, of_event),
        "system.SystemEvent.rows": Call(event.rows, of_event),
        "system.SystemEvent.margin": Call(event.margin, on_event),
        "system.SystemEvent.margin_bounds": Call(event.margin_bounds, on_event),
        "system.SystemEvent.bounds_of": Call(
            event.bounds_of, {**of_event, "y": numbers([0.0, 1.0])}
        ),
        "methods.AskTellSession.tell": Call(
            lambda x, y: methods.Kriging(runs=6).start(problem, criterion, rng=1).tell(x, y),
            {"x": thing(session.ask()), "y": thing(np.zeros(6))},
        ),
        "methods.AskTellSession.save": Call(
            session.save, {"path": Kind(str(saved), saved, frozenset({"text"}))}
        ),
        "methods.ConditionalMonteCarlo": Call(
            methods.ConditionalMonteCarlo,
            {
                "blocks": optional(count()),
                "missions_per_draw": count(),
                "partner_blocks": count().also("zero"),
                "target_cov": optional(number()),
            },
        ),
        "methods.MultifidelityMonteCarlo": Call(
            methods.MultifidelityMonteCarlo,
            {
                "systems": optional(count()),
                "partner_systems": optional(count()),
                "cost_ratio": number(5.0),
                "pilot": count(10),
                "target_cov": optional(number()),
            },
        ),
        "methods.Automatic": Call(
            methods.Automatic, {"target_cov": number(), "check_runs": count().also("zero")}
        ),
        "methods.ImportanceSampling": Call(
            methods.ImportanceSampling,
            {"samples": optional(count(100)), "target_cov": optional(number())},
        ),
        "methods.SORM": Call(
            methods.SORM,
            {
                "formula": choice("breitung"),
                "search": thing(methods.OpenTURNSFORM()),
                "target_cov": number(),
            },
        ),
        "methods.LineSampling": Call(
            methods.LineSampling, {"lines": optional(count(2)), "target_cov": optional(number())}
        ),
        "methods.DirectionalSampling": Call(
            methods.DirectionalSampling,
            {
                "rays": optional(count(8)),
                "sets": optional(count(2)),
                "target_cov": optional(number()),
            },
        ),
        "methods.SubsetSimulation": Call(
            methods.SubsetSimulation,
            {
                "samples": count(100),
                "repetitions": optional(count(2)),
                "level_probability": number(0.1),
                "target_cov": optional(number()),
            },
        ),
        "methods.Estimate": Call(methods.Estimate, estimate),
        "methods.DimensionReduction": Call(
            methods.DimensionReduction, {"variables": count(2), "nodes": count()}
        ),
        "methods.FFNI": Call(
            methods.FFNI,
            {
                "inner": thing(methods.SparseGrid()),
                "distribution": choice("pearson"),
                "outer": thing(methods.GaussOuter()),
                "check": flag(),
                "target_cov": number(),
            },
        ),
        "methods.FFNI.mended": Call(methods.FFNI.mended, {"distribution": choice("normal")}),
        "methods.FullFactorial": Call(methods.FullFactorial, {"nodes": nodes}),
        "methods.GaussOuter": Call(methods.GaussOuter, {"nodes": nodes}),
        "methods.RefinedOuter": Call(
            methods.RefinedOuter, {"tolerance": number(), "nodes": nodes, "most": count()}
        ),
        "methods.SparseGrid": Call(methods.SparseGrid, {"level": count()}),
        "methods.FFNIPearson": Call(
            methods.FFNIPearson,
            {
                "nodes_shared": nodes,
                "nodes_individual": nodes,
                "family": choice("normal"),
                "rows": optional(count()),
                "check": flag(),
                "target_cov": number(),
            },
        ),
        "methods.FFNISaddlepoint": Call(
            methods.FFNISaddlepoint,
            {
                "nodes_shared": nodes,
                "nodes_individual": nodes,
                "check": flag(),
                "target_cov": number(),
            },
        ),
        "methods.Kriging": Call(
            methods.Kriging,
            {
                "runs": optional(count()),
                "target_cov": number(),
                "trend": choice("best"),
                "kernel": choice("best"),
                "noise": optional(number().also("zero")),
                "spread": number(1.5),
                "warp": flag(),
                "partner_runs": count(0).also("zero"),
            },
        ),
        "methods.MonteCarlo": Call(
            methods.MonteCarlo, {"systems": optional(count()), "target_cov": optional(number())}
        ),
        "methods.OpenTURNSNAIS": Call(
            methods.OpenTURNSNAIS,
            {
                "samples": count(100),
                "repetitions": optional(count(2)),
                "target_cov": optional(number()),
            },
        ),
        "methods.QuasiMonteCarlo": Call(
            methods.QuasiMonteCarlo,
            {
                "points": optional(count()),
                "randomisations": count(10),
                "target_cov": optional(number()),
            },
        ),
        "methods.OpenTURNSFORM": Call(
            methods.OpenTURNSFORM,
            {
                "algorithms": thing(("SQP",)),
                "step": Kind(0.5, np.float64(0.5)),
                "tolerance": Kind(0.01, np.float64(0.01)),
                "max_iterations": count(),
                "starts": count(),
                "target_cov": number(),
            },
        ),
        "methods.OpenTURNSMonteCarlo": Call(
            methods.OpenTURNSMonteCarlo,
            {"target_cov": number(), "block_size": count(), "max_samples": count()},
        ),
        "methods.PolynomialChaos": Call(
            methods.PolynomialChaos,
            {
                "runs": optional(count()),
                "target_cov": number(),
                "sparse": flag(),
                "max_degree": count(),
                "basis": choice("own"),
                "design": choice("ffni"),
                "nodes_shared": nodes,
                "nodes_individual": nodes,
                "spread": number(1.5),
                "warp": flag(),
            },
        ),
        "ReliabilityMethod.start": Call(methods.Kriging(runs=6).start, {**of, **run}),
        "ReliabilityMethod.resume": Call(
            methods.Kriging(runs=6).resume,
            {
                "path": Kind(str(saved), saved, frozenset({"text"})),
                "problem": at,
                "criteria": thing(criterion).except_for("none"),
                "max_evals": optional(thing(None)),
                "rng": optional(count(1)).except_for("zero"),
                "evaluator": run["evaluator"],
            },
        ),
        "methods.Solution": Call(
            methods.Solution,
            {
                "estimates": thing([methods.Estimate(0.1)]).also("empty list"),
                "details": anything(None),
            },
        ),
        "methods.available": Call(methods.available, {}),
        "methods.build": Call(methods.build, {"name": choice("mc")}),
        "problems.Reference": Call(
            problems.Reference,
            {
                "criterion": thing(criterion),
                "pf": Kind(0.1, np.float64(0.1), frozenset({"zero"})),
                "std_error": number().also("zero"),
            },
        ),
        "problems.ReferenceTable": Call(
            problems.ReferenceTable,
            {
                "problem": text(),
                "kind": text(),
                "how": text(),
                "command": text(),
                "entries": thing({criterion: reference}),
            },
        ),
        "problems.ReferenceTable.lookup": Call(references.lookup, {"criterion": thing(criterion)}),
        "plots.derivatives": Call(
            plots.derivatives, {"table": thing(slopes), "ax": optional(thing(drawn_into))}
        ),
        "plots.design": Call(plots.design, {"table": thing(designs)}),
        "plots.figure_settings": Call(plots.figure_settings, {}),
        "plots.importance": Call(
            plots.importance,
            {
                "table": thing(weighed),
                "measure": choice("birnbaum"),
                "ax": optional(thing(drawn_into)),
            },
        ),
        "plots.reliability_panels": Call(
            plots.reliability_panels,
            {
                "frame": thing(frame),
                "quantities": thing(["pf"]),
                "panels": optional(choice("missions")),
                **curve_options,
            },
        ),
        "plots.sobol": Call(
            plots.sobol, {"table": thing(indices), "ax": optional(thing(drawn_into))}
        ),
        "plots.comparison": Call(plots.comparison, {"frame": thing(frame)}),
        "plots.error_against_evaluations": Call(
            plots.error_against_evaluations,
            {"frame": thing(frame), "ax": optional(thing(drawn_into))},
        ),
        "plots.method_styles": Call(
            plots.method_styles, {"labels": thing(["mc"]).also("empty list")}
        ),
        "plots.one_legend": Call(plots.one_legend, {"figure": thing(axes.figure)}),
        **{
            f"plots.{draw.__name__}": Call(
                draw, {**of_benchmark, "ax": optional(thing(drawn_into))}
            )
            for draw in (plots.performance_profile, plots.data_profile)
        },
        "plots.points": Call(
            plots.points,
            {
                "frame": thing(pd.DataFrame([("a", 1.0, 2.0)], columns=["series", "x", "y"])),
                "x": text(),
                "y": text(),
                "log": choice("xy"),
                "limits": optional(thing({"a": 1.0})),
                "ax": optional(thing(drawn_into)),
            },
        ),
        "plots.save": Call(
            plots.save,
            {"figure": thing(axes), "path": file, "formats": thing(["png"]).also("empty list")},
        ),
        "plots.values": Call(plots.values, {"figure": thing(axes)}),
        "problems.folding_wing": Call(
            problems.folding_wing,
            {
                "parameters": optional(thing(wing)),
                "means": wing_moments,
                "standard_deviations": wing_moments,
            },
        ),
        "problems.folding_wing_random_lengths": Call(
            problems.folding_wing_random_lengths,
            {
                "parameters": optional(thing(wing)),
                "means": wing_moments,
                "standard_deviations": wing_moments,
            },
        ),
        "problems.four_bar": Call(problems.four_bar, {"branch": choice("crossed")}),
        "problems.four_branch": Call(problems.four_branch, {"k": number(6.0)}),
        "problems.series": Call(problems.series, {}),
        "problems.stress_strength": Call(
            problems.stress_strength,
            {"units": count(3), "works": count(2), "strength": number(5.0)},
        ),
        "report.Page": Call(
            report.Page,
            {"title": text(), "lead": text(), "kind": text(), "imprint": text()},
        ),
        "report.Page.card": Call(
            page.card, {"title": text(), "answer": text(), "tone": choice("good")}
        ),
        "report.Page.code": Call(page.code, {"source": text()}),
        "report.Page.details": Call(page.details, {"title": text()}),
        "report.Page.equation": Call(
            page.equation, {"latex": text(), "lead": text(), "source": text()}
        ),
        "report.Page.facts": Call(page.facts, {"facts": thing({"a": "b"})}),
        "report.Page.figure": Call(
            page.figure,
            {"figure": thing(axes), "title": text(), "caption": text(), "name": text()},
        ),
        "report.Page.section": Call(
            page.section,
            {
                "title": text(),
                "level": count().except_for("huge"),
                "label": text(),
                "tone": choice("good"),
                "name": text(),
            },
        ),
        "report.Page.table": Call(
            page.table,
            {
                "frame": thing(frame),
                "title": text(),
                "caption": text(),
                "name": text(),
                "belongs": thing([]).also("empty list"),
            },
        ),
        "report.Page.text": Call(page.text, {"source": text(), "small": flag()}),
        "report.Page.write": Call(
            report.Page("some").write,
            {
                "path": Kind(str(folder / "p.md"), folder / "p.md", frozenset({"text"})),
            },
        ),
        "report.literal": Call(report.literal, {"text": text()}),
        "report.ComparisonTable": Call(report.ComparisonTable, {"frame": thing(frame)}),
        "report.report_page": Call(
            report.report_page, {"source": Kind(str(folder), folder, frozenset({"text"}))}
        ),
        "report.write_figures": Call(report.write_figures, {"frame": thing(frame), "folder": file}),
        "report.write_report": Call(
            report.write_report,
            {
                "source": thing(frame).also("text"),
                "path": Kind(str(folder / "r.html"), folder / "r.html", frozenset({"text"})),
            },
        ),
        "testing.LinearNormalSystem": Call(
            testing.LinearNormalSystem,
            {
                "units": count(),
                "mean": any_number(),
                "shared_std": number().also("zero"),
                "individual_std": number(),
                "structure": thing(uqfold.Series()),
            },
        ),
        "testing.LinearNormalSystem.pf": Call(
            testing.LinearNormalSystem().pf, {"criterion": thing(criterion)}
        ),
        "testing.check_method": Call(
            testing.check_method,
            {
                "method": thing(cheap),
                "level": choice("quick"),
                "only": thing([]).also("empty list").except_for("none"),
                "except_for": thing([]).also("empty list"),
                "tolerance": Kind(0.03, np.float64(0.03)),
                "max_evals": optional(count()),
            },
        ),
    }
