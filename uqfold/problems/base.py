"""A problem: a response model, its random inputs, and how units make up the system."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import (
    function,
    instance,
    or_none,
    refused,
    several,
    text,
)
from uqfold.checks import (
    names as checked_names,
)
from uqfold.inputs import JointInputs, joint_inputs, product_inputs
from uqfold.inputs.assembly import with_other_inputs
from uqfold.problems.criterion import LIMIT_STATE_THRESHOLD, Criteria, criteria
from uqfold.problems.responses import numbers_in
from uqfold.problems.structure import Series, SystemStructure, checked_structure
from uqfold.problems.units import Unit, UnitKinds, checked_units
from uqfold.typing import FloatArray, Model

if TYPE_CHECKING:
    import pandas as pd

    from uqfold.problems.known_answers import ReferenceLike
    from uqfold.problems.reference import ReferenceTable


WITHOUT_MODEL = (
    "the problem has no model: let a session ask for rows and tell it their responses, as in "
    "uqfold.methods.Kriging().start(problem, ...)"
)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Problem:
    """A response model, its random inputs, and how units make up the system.

    Two forms: shared and individual inputs that are independent of each other, ::

        Problem(model, shared=dist, individual=dist, units=4)

    or one joint distribution, whose dependence may also link shared and individual inputs, ::

        Problem(model, inputs=joint, shared=["V_q", "delta"], units=4)

    Parameters
    ----------
    model
        Response model: takes X (n, d), columns shared inputs first, returns y (n,) or (n, 1); the
        response is the quantity that must stay small. +inf is a valid response that fails every
        criterion; NaN, a masked entry or an exception is a failed run. A function of one sample
        (d,) is wrapped by `uqfold.evaluation.per_sample`. None where runs are made elsewhere: then
        sessions of methods (`ReliabilityMethod.start`) ask for them.
    inputs
        Joint distribution of all inputs (second form), or the ``inputs`` of another problem; then
        `shared` and `individual` are what differs from these, as they do with
        ``dataclasses.replace(problem, individual=...)``.
    shared
        First form: distribution of the shared inputs, or None. Second form: their names.
    individual
        Distribution of the individual inputs of one unit (first form).
    units
        Number of exchangeable units, or a sequence of `Unit` records that differ. All units are
        independent given the shared inputs.
    structure
        How the units make up the system: `Series()` by default, `Parallel()`, `KOutOfN(k)`,
        `CutSets(sets)`, `PathSets(sets)` or `Structure(expression)`.
    low_fidelity
        A cheaper partner model with the same arguments, or None: coarser, simpler, or fitted to
        earlier runs. `uqfold.methods.MultifidelityMonteCarlo` runs it many times, to know where
        runs of the model decide; its answer is without bias however wrong the partner is, and the
        cheaper the better it is. No other method runs it. A failed run of it (NaN) does no harm.
    gradient
        Derivatives of the response: takes X (n, d), returns (n, d), of each row by each input; or
        None. `uqfold.methods.OpenTURNSFORM` and `SORM` use it in place of differences, once it has
        agreed with these where they start; if it does not, they say so. It runs in this process,
        and its calls are counted apart (``result.n_gradients``). Units with a model of their own
        have none. A row of NaN is one without a gradient.
    version
        Text that identifies the model's version to a store, or None (nothing is stored).
    name, response, input_units, response_unit
        How reports call the problem, its response and their units.
    names
        Names of all inputs, shared first, instead of those that the distributions carry.
    default_criteria
        The criteria meant when none are given.
    references
        Known answers, in any form that `uqfold.compare` takes as ``reference``. Those of another
        problem are left out if model, inputs, units or structure differ, as with
        ``dataclasses.replace(problem, units=3)``.

    Raises
    ------
    ValueError, TypeError
        If the inputs, units or structure do not fit together.
    """

    model: Model
    inputs: JointInputs
    units: int | tuple[Unit, ...]
    kinds: UnitKinds = field(init=False)
    structure: SystemStructure
    low_fidelity: Model | None
    gradient: Model | None
    version: str | None
    name: str
    response: str
    response_unit: str
    input_units: tuple[str, ...]
    default_criteria: Criteria | None
    references: ReferenceTable | None

    def __init__(
        self,
        model: Model | None,
        *,
        inputs: Any = None,
        shared: Any = None,
        individual: Any = None,
        units: int | Sequence[Unit] = 1,
        structure: SystemStructure | None = None,
        low_fidelity: Model | None = None,
        gradient: Model | None = None,
        version: str | None = None,
        name: str | None = None,
        response: str = "response",
        response_unit: str = "",
        input_units: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        default_criteria: Criteria | None = None,
        references: ReferenceLike | None = None,
    ) -> None:
        or_none("model", model, function, "give a function of X (n, d)")
        model = run_elsewhere if model is None else model
        or_none("low_fidelity", low_fidelity, function, "give a function of X (n, d)")
        or_none("gradient", gradient, function, "give a function of X (n, d) that returns (n, d)")
        names = or_none("names", names, checked_names)
        if inputs is None:
            joint = product_inputs(shared, individual, names)
        elif isinstance(inputs, JointInputs) and not _are_names(shared, individual):
            joint = with_other_inputs(inputs, shared, individual, names)
        elif individual is not None:
            raise refused("individual", individual, "give either inputs= or individual=")
        else:
            joint = joint_inputs(inputs, _names_of_shared(shared), names)
        given = or_none("input_units", input_units, several, text, empty=True)
        # those of another problem with another number of inputs may say nothing
        unit_names = given if given and any(given) else ("",) * joint.dimension
        if len(unit_names) != joint.dimension:
            raise refused(
                "input_units", unit_names, f"give one for each of {joint.dimension} inputs"
            )
        if name is None:
            named = "problem" if model is run_elsewhere else getattr(model, "__name__", "problem")
            name = str(named)
        fields: dict[str, Any] = {
            "model": model,
            "inputs": joint,
            "units": checked_units(units),
            "structure": Series() if structure is None else structure,
            "low_fidelity": low_fidelity,
            "gradient": gradient,
            "version": or_none("version", version, text),
            "name": text("name", name, empty=True),
            "response": text("response", response),
            "response_unit": text("response_unit", response_unit, empty=True),
            "input_units": unit_names,
            "default_criteria": or_none(
                "default_criteria", default_criteria, instance, Criteria, "give criteria(...)"
            ),
            "references": references,
        }
        for key, value in fields.items():
            object.__setattr__(self, key, value)
        kinds = UnitKinds.of(self.units, model, joint, low_fidelity, gradient)
        object.__setattr__(self, "kinds", kinds)
        if len(kinds.models) == 1:
            object.__setattr__(self, "model", kinds.model)
            object.__setattr__(self, "inputs", kinds.inputs[0])
            object.__setattr__(self, "low_fidelity", kinds.partners[0])
            object.__setattr__(self, "gradient", kinds.gradients[0])
        if not isinstance(self.structure, Series):
            checked_structure(self.structure, self.unit_names)
        object.__setattr__(self, "references", self._own(references))

    @classmethod
    def from_limit_state(
        cls, g: Callable[[FloatArray], Any], inputs: Any, **options: Any
    ) -> Problem:
        """Return the one-unit problem of a plain limit state: failure when g(x) <= 0.

        The response is y = -g and the threshold lies one float below zero, so that g = 0 fails;
        `default_criteria` holds it.

        Parameters
        ----------
        g
            Limit-state function: takes X (n, d), returns (n,); one of a single sample is wrapped
            by `uqfold.evaluation.per_sample`.
        inputs
            Joint distribution of the d inputs.
        options
            Further arguments of `Problem`, for instance ``name``; a ``gradient`` is that of g.
        """
        function("g", g, "give a function of X (n, d)")
        if "units" in options:
            remedy = "a limit state has one unit; give Problem(model, units=...) for several"
            raise refused("units", options["units"], remedy)
        name = getattr(g, "__name__", "<lambda>")
        options.setdefault("name", "limit state" if name == "<lambda>" else name)
        options.setdefault("default_criteria", criteria(LIMIT_STATE_THRESHOLD))
        if (gradient := options.get("gradient")) is not None:
            remedy = "give a function of X (n, d) that returns (n, d)"
            options["gradient"] = _Negated(function("gradient", gradient, remedy))
        # a model of one sample knows how to change its sign and stay one
        negated = getattr(g, "negated", None)
        model = negated() if callable(negated) else _Negated(g)
        return cls(model, inputs=inputs, units=1, **options)

    @classmethod
    def from_openturns(cls, event: Any, **options: Any) -> Problem:
        """Return the one-unit problem of an OpenTURNS event: it fails when the event occurs.

        The response is the event's own output, or minus that where small outputs fail; of a union
        or an intersection it is the margin of its events, which fails above zero.
        `default_criteria` holds the threshold.

        Parameters
        ----------
        event
            An ``openturns.ThresholdEvent``, or a ``UnionEvent`` or ``IntersectionEvent`` made of
            such, to any depth.
        options
            Further arguments of `Problem`, for instance ``name``, ``units`` or ``shared``.

        Raises
        ------
        TypeError, ValueError
            If it is an event of another kind, or inputs are given beside those of the event.

        Examples
        --------
        >>> import openturns as ot
        >>> x = ot.RandomVector(ot.Normal(2))
        >>> g = ot.SymbolicFunction(["a", "b"], ["4 - a - b"])
        >>> event = ot.ThresholdEvent(ot.CompositeRandomVector(g, x), ot.LessOrEqual(), 0.0)
        >>> print(Problem.from_openturns(event).default_criteria[0])
        g <= 0, m = 1
        """
        from uqfold.inputs.threshold_event import taken_apart

        if "inputs" in options:
            remedy = "the event has its own; give names= for other names"
            raise refused("inputs", options["inputs"], remedy)
        response, distribution, threshold = taken_apart(event)
        options.setdefault("name", event.getName() if event.getName() != "Unnamed" else "event")
        options.setdefault("default_criteria", criteria(threshold))
        return cls(response, inputs=distribution, **options)

    def with_moments(
        self,
        means: Mapping[str, float] | None = None,
        standard_deviations: Mapping[str, float] | None = None,
    ) -> Problem:
        """Return the same problem with other means or standard deviations of some inputs.

        Name, version and model stay, so that stored runs serve both; the references do not
        belong to it any more. Units with inputs of their own keep these.

        Parameters
        ----------
        means, standard_deviations
            Name of an input -> its new value; see `JointInputs.with_moments`.

        Raises
        ------
        ValueError
            If a name is not one of the inputs, or a distribution cannot have these moments.

        Examples
        --------
        >>> from uqfold.problems import series
        >>> series().with_moments(means={"X2": 1.3}).inputs.means.tolist()
        [1.0, 1.3, 0.5]
        """
        changed = copy(self)
        inputs = self.inputs.with_moments(means, standard_deviations)
        object.__setattr__(changed, "inputs", inputs)
        kinds = self.kinds.with_moments(self.inputs, inputs, means or {}, standard_deviations or {})
        object.__setattr__(changed, "kinds", kinds)
        object.__setattr__(changed, "references", None)
        return changed

    def _own(self, references: ReferenceLike | None) -> ReferenceTable | None:
        """Return references if they are this problem's, not those of one that it is made from."""
        from uqfold.problems.known_answers import reference_table
        from uqfold.problems.reference import answering

        if references is None:
            return None
        asked = (self.default_criteria, self.name, self.system_digest)
        table = reference_table("references", references, *asked)
        return answering(table, self.model, self.inputs, self.units, self.structure)

    @property
    def n_units(self) -> int:
        """Number of units n."""
        return self.units if isinstance(self.units, int) else len(self.units)

    @property
    def unit_names(self) -> tuple[str, ...]:
        """What a `Structure` calls each unit: its own name, else ``u`` and its index from 0."""
        own = ("",) * self.units if isinstance(self.units, int) else [u.name for u in self.units]
        return tuple(name or f"u{i}" for i, name in enumerate(own))

    @property
    def system_digest(self) -> str:
        """Digest of what makes the system besides the model: inputs, units, structure."""
        kinds, joint = self.kinds, self.inputs
        own = [
            ([*map(str, one.columns)], repr(one.parts.dependent), one.fingerprint)
            for one in kinds.inputs
        ]
        # neither text nor fingerprint tells all probabilities of many values
        atoms = [one.atoms for inputs in kinds.inputs for one in inputs.columns]
        values = [one.tolist() for pair in atoms for one in pair if one.size]
        units = [None if one is None else one.tolist() for one in (kinds.of_units, kinds.offsets)]
        system = (self.n_units, units, repr(self.structure))
        parts = (joint.names, joint.n_shared, own, *values, *system)
        return hashlib.blake2b(repr(parts).encode(), digest_size=8).hexdigest()

    @property
    def exchangeable(self) -> bool:
        """Whether all units share one model and one distribution, without offsets."""
        return self.kinds.equal

    def __repr__(self) -> str:
        return (
            f"Problem({self.name!r}, {self.inputs!r}, units={self.n_units}, "
            f"structure={self.structure!r})"
        )

    def __str__(self) -> str:
        return f"{self._headline()}\n{self._table().to_string(index=False)}"

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        return f"<p>{escape(self._headline())}</p>{self._table().to_html(index=False, border=0)}"

    def _headline(self) -> str:
        response = (
            f"{self.response} ({self.response_unit})" if self.response_unit else self.response
        )
        units = "1 unit" if self.n_units == 1 else f"{self.n_units} units, {self.structure!r}"
        return f"{self.name}: {response}, {units}"

    def _table(self) -> pd.DataFrame:
        """Return one row of text for each input."""
        import pandas as pd

        inputs = self.inputs
        moments = zip(inputs.means, inputs.standard_deviations, strict=True)
        rows = [
            {
                "input": name,
                "unit": unit,
                "shared": "yes" if i < inputs.n_shared else "",
                "distribution": str(column),
                "mean": f"{mean:.6g}",
                "std": f"{std:.6g}",
            }
            for i, (name, unit, column, (mean, std)) in enumerate(
                zip(inputs.names, self.input_units, inputs.columns, moments, strict=True)
            )
        ]
        silent = [] if any(self.input_units) else ["unit"]
        return pd.DataFrame(rows).drop(columns=silent)


def run_elsewhere(x: FloatArray) -> FloatArray:
    """Stand for the model of a problem without one.

    Raises
    ------
    RuntimeError
        Always.
    """
    raise RuntimeError(WITHOUT_MODEL)


@dataclass(frozen=True)
class _Negated:
    """The response -g of a limit-state function g; or what a function of its kind returns."""

    g: Callable[[FloatArray], Any]

    def __call__(self, x: FloatArray) -> Any:
        returned = self.g(x)
        y = numbers_in(returned)
        if y.ndim > 0 and np.isnan(y).any():
            # what makes an entry a failed run is told from it
            pairs = zip(returned, y, strict=True)
            return [entry if np.isnan(value).any() else -value for entry, value in pairs]
        return None if returned is None else -y


def _are_names(shared: Any, individual: Any) -> bool:
    """Whether `shared` says by names which inputs are, and nothing else is given."""
    names = shared is None or isinstance(shared, str | Sequence)
    return individual is None and names and all(isinstance(one, str) for one in shared or ())


def _names_of_shared(shared: Any) -> Sequence[str]:
    if shared is None:
        return ()
    try:
        return checked_names("shared", shared)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{error}; with inputs=, shared= is a list of input names") from None
