"""The problems of a study: cases of ours with options, or a function in a file beside the study."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from uqfold.comparison.named_problems import available_problems
from uqfold.comparison.studies.document import Place, nearest
from uqfold.comparison.studies.keys import COUNT, FLAG, MAPPING, TEXT, Key, read_table
from uqfold.problems.base import Problem

PROBLEM_KEYS = (
    Key("case", TEXT, "One of the cases that `uqfold compare --help` lists.", None),
    Key(
        "function",
        TEXT,
        "Instead of `case`: `module:function` of a Python file beside the study; the function "
        "gives the `uqfold.Problem`. Only `study run` and `study check` import it.",
        None,
    ),
    Key("options", MAPPING, "Arguments of the case's function, or of yours.", {}),
    Key("units", COUNT, "Another number of units; references no longer apply.", None),
    Key(
        "independent",
        FLAG,
        "Whether every response is drawn from the marginal distribution, over units and missions: "
        "all inputs become individual ones, and references no longer apply.",
        False,
    ),
    Key(
        "store",
        FLAG,
        "Whether model runs are kept; false where the model is faster than the disk.",
        True,
    ),
)


@dataclass(frozen=True)
class ProblemSpec:
    """One problem of a study.

    Attributes
    ----------
    name
        Its name in the study.
    settings
        Values of `PROBLEM_KEYS`.
    folder
        Folder of the study.
    place
        Where the file states it.
    """

    name: str
    settings: Mapping[str, Any]
    folder: Path
    place: Place

    @property
    def is_ours(self) -> bool:
        """Whether building it imports nothing but uqfold."""
        return self.settings["case"] is not None

    def build(self) -> Problem:
        """Build the problem; imports the study's own file if it names one.

        Raises
        ------
        StudyError
            If its function or options are wrong.
        """
        function = self._function()
        options = dict(self.settings["options"])
        place = self.place.at("options")
        known = inspect.signature(function).parameters
        for name in options:
            if name not in known:
                raise place.at(name).error(f"no such option; {nearest(name, known)}")
        try:
            problem = function(**options)
        except (TypeError, ValueError) as error:
            raise place.error(str(error)) from error
        except (Exception, SystemExit) as error:
            if self.is_ours:
                raise
            said = f"{type(error).__name__}: {error}"
            raise self.place.at("function").error(f"the function raised {said}") from error
        if not isinstance(problem, Problem):
            raise self.place.at("function").error(f"the function gave {problem!r}, not a Problem")
        return self._changed(problem)

    def fingerprint(self) -> str:
        """Give a text that changes with whatever the file of a user's function says."""
        if self.is_ours:
            return ""
        return hashlib.sha256(self._file().read_bytes()).hexdigest()

    def _changed(self, problem: Problem) -> Problem:
        units, independent = self.settings["units"], self.settings["independent"]
        if units is None and not independent:
            return problem
        if not problem.exchangeable:
            raise self.place.error("units and independent need units that are all alike")
        inputs = problem.inputs
        return Problem(
            problem.model,
            inputs=inputs.distribution,
            shared=() if independent else inputs.shared_names,
            names=inputs.names,
            units=problem.n_units if units is None else units,
            structure=problem.structure,
            low_fidelity=problem.low_fidelity,
            version=problem.version,
            name=problem.name,
            response=problem.response,
            response_unit=problem.response_unit,
            input_units=problem.input_units,
        )

    def _function(self) -> Any:
        if self.is_ours:
            return available_problems()[self.settings["case"]].function()
        file, attribute = self._file(), self.settings["function"].partition(":")[2]
        place = self.place.at("function")
        # a name of its own: studies may all call their files alike, and a file may change
        content = str(file.resolve()).encode() + file.read_bytes()
        name = f"_uqfold_study_{hashlib.sha256(content).hexdigest()[:16]}"
        module = sys.modules.get(name)
        if module is None:
            spec = importlib.util.spec_from_file_location(name, file)
            if spec is None or spec.loader is None:
                raise place.error(f"{file.name} cannot be imported")
            module = importlib.util.module_from_spec(spec)
            sys.modules[name] = module
            try:
                spec.loader.exec_module(module)
            except (Exception, SystemExit) as error:
                del sys.modules[name]
                said = f"{type(error).__name__}: {error}"
                raise place.error(f"{file.name} cannot be imported: {said}") from error
        function = getattr(module, attribute, None)
        if not callable(function):
            raise place.error(f"{file.name} has no function {attribute!r}")
        return function

    def _file(self) -> Path:
        return self.folder / f"{self.settings['function'].partition(':')[0]}.py"


def read_problem(name: str, content: Any, place: Place, folder: Path) -> ProblemSpec:
    """Read and check one problem of a study, without importing anything of the user's.

    Raises
    ------
    StudyError
        If it is wrong.
    """
    settings = read_table(content, place, PROBLEM_KEYS)
    case, function = settings["case"], settings["function"]
    if (case is None) == (function is None):
        raise place.error("give either case or function")
    spec = ProblemSpec(name, settings, folder, place)
    if case is not None:
        if case not in available_problems():
            raise place.at("case").error(
                f"{case!r} is no case; {nearest(case, available_problems())}"
            )
        spec.build()
        return spec
    module, colon, attribute = function.partition(":")
    if not (colon and module.isidentifier() and attribute.isidentifier()):
        raise place.at("function").error(f"{function!r}: give module:function")
    if not (folder / f"{module}.py").is_file():
        raise place.at("function").error(f"there is no {module}.py beside the study")
    return spec
