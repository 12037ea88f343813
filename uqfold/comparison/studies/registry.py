"""The kinds of analysis that a study may ask for: one file each, one line here.

The `call` of such a kind takes the settings of the analysis (values of its keys) and a
`StepContext`, and gives a pandas frame with the kind's columns.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module

from uqfold.comparison.studies.keys import Kind
from uqfold.evaluation.evaluator import Evaluator
from uqfold.methods.base import ReliabilityMethod
from uqfold.problems.base import Problem

_STEPS: dict[str, str] = {
    "independence": "uqfold.comparison.studies.steps.independence:INDEPENDENCE",
    "lock-scan": "uqfold.comparison.studies.steps.lock_scan:LOCK_SCAN",
    "paired": "uqfold.comparison.studies.steps.paired:PAIRED",
    "scatter": "uqfold.comparison.studies.steps.scatter:SCATTER",
    "trajectory": "uqfold.comparison.studies.steps.trajectory:TRAJECTORY",
    "derivatives": "uqfold.comparison.studies.steps.derivatives:DERIVATIVES",
    "sobol": "uqfold.comparison.studies.steps.variance:SOBOL",
    "threshold-design": "uqfold.comparison.studies.steps.designs:THRESHOLD_DESIGN",
    "timing": "uqfold.comparison.studies.steps.timing:TIMING",
    "input-design": "uqfold.comparison.studies.steps.designs:INPUT_DESIGN",
}


@dataclass(frozen=True)
class StepContext:
    """What an analysis may use.

    Attributes
    ----------
    problems
        The study's problems by name.
    methods
        The study's methods by label.
    evaluator
        Maps a problem's name to how its model is to be run: store, batches, progress.
    """

    problems: Mapping[str, Problem]
    methods: Mapping[str, ReliabilityMethod]
    evaluator: Callable[[str], Evaluator]


def step_kinds() -> dict[str, Kind]:
    """Map the name of every kind of analysis to the kind."""
    return loaded_kinds(_STEPS)


def loaded_kinds(paths: Mapping[str, str]) -> dict[str, Kind]:
    """Load kinds from ``module:attribute``, by name.

    Raises
    ------
    ValueError
        If one carries another name than its line in the registry.
    """
    kinds = {}
    for name, path in paths.items():
        module, _, attribute = path.partition(":")
        kind: Kind = getattr(import_module(module), attribute)
        if kind.name != name:
            raise ValueError(f"{path} is named {kind.name!r}, but registered as {name!r}")
        kinds[name] = kind
    return kinds
