"""A store never answers for another model: what identifies one in it."""

import collections
import dataclasses
import datetime
import enum
import functools
import itertools
import math
import operator
import types
from dataclasses import InitVar, dataclass, field
from decimal import Decimal
from fractions import Fraction
from pathlib import Path, PurePosixPath
from typing import Any, Generic, NamedTuple, TypeVar
from zoneinfo import ZoneInfo

import numpy as np
import openturns as ot
import pytest
from scipy import special

import uqfold
from tests.evaluation import models
from uqfold.evaluation import Evaluator, Store, per_sample
from uqfold.evaluation.description import UndescribedError, described
from uqfold.evaluation.identity import model_identity
from uqfold.methods import MonteCarlo
from uqfold.typing import FloatArray


class Material(enum.Enum):
    STEEL = 1
    BRASS = 2


class Level(enum.IntEnum):
    STEEL = 1


class Pair(NamedTuple):
    a: Any
    b: Any


@dataclass(frozen=True)
class Scaled:
    p: Any

    def __call__(self, x: FloatArray) -> FloatArray:
        return float(self.p) * x[:, 0]


@dataclass(frozen=True)
class Other:
    p: Any

    def __call__(self, x: FloatArray) -> FloatArray:
        return x[:, 0]


def two(x: FloatArray, factor: float = 2.0) -> FloatArray:
    return factor * x[:, 0]


def closed_over(p: Any) -> Any:
    def model(x: FloatArray) -> FloatArray:
        return float(p) * x[:, 0]

    return model


def with_default(p: Any) -> Any:
    def model(x: FloatArray, factor: Any = p) -> FloatArray:
        return float(factor) * x[:, 0]

    return model


def local_class(p: Any) -> Any:
    @dataclass(frozen=True)
    class Local:
        def __call__(self, x: FloatArray) -> FloatArray:
            return float(p) * x[:, 0]

    return Local()


def attribute(p: Any) -> Any:
    def model(x: FloatArray) -> FloatArray:
        return float(model.factor) * x[:, 0]  # type: ignore[attr-defined]

    model.factor = p  # type: ignore[attr-defined]
    return model


def local_class_method(p: Any) -> Any:
    class Local:
        factor = p

        @classmethod
        def run(cls, x: FloatArray) -> FloatArray:
            return float(cls.factor) * x[:, 0]

    return Local.run


def local_base(p: Any) -> Any:
    class Base:
        def __call__(self, x: FloatArray) -> FloatArray:
            return float(p) * x[:, 0]

    @dataclass(frozen=True)
    class Local(Base):
        def again(self) -> Any:
            return super(), Local()

    return Local()


def local_tuple(p: Any) -> Any:
    class Local(NamedTuple):
        column: int = 0

        def __call__(self, x: FloatArray) -> FloatArray:
            return float(p) * x[:, self.column]

    return Local()


def local_property(p: Any) -> Any:
    @dataclass(frozen=True)
    class Local:
        @property
        def factor(self) -> float:
            return float(p)

        def __call__(self, x: FloatArray) -> FloatArray:
            return self.factor * x[:, 0]

    return Local()


def local_static(p: Any) -> Any:
    @dataclass(frozen=True)
    class Local:
        @staticmethod
        def factor() -> float:
            return float(p)

        def __call__(self, x: FloatArray) -> FloatArray:
            return self.factor() * x[:, 0]

    return Local()


@dataclass(frozen=True)
class Prepared:
    given: InitVar[Any]

    def __post_init__(self, given: Any) -> None:
        object.__setattr__(self, "factor", given)

    def __call__(self, x: FloatArray) -> FloatArray:
        return self.remembered * x[:, 0]

    @functools.cached_property
    def remembered(self) -> float:
        return float(self.factor)  # type: ignore[attr-defined]


MAKERS = [
    *(Scaled, closed_over, with_default, local_class, attribute, local_class_method),
    *(local_base, local_tuple, local_property, local_static, Prepared),
]


def branch(first: bool) -> Any:
    if first:

        def model(x: FloatArray) -> FloatArray:
            return x[:, 0]

    else:

        def model(x: FloatArray) -> FloatArray:
            return x[:, 1]

    return model


class Odd(functools.partial):  # type: ignore[type-arg]
    """Calls what it likes."""


def with_attribute(p: Any) -> Any:
    model = functools.partial(two)
    model.factor = p  # type: ignore[attr-defined]
    return model


def record(a: float, b: int) -> np.ndarray:
    return np.array([(a, b)], dtype=np.dtype([("a", float), ("b", "i1")], align=True))


VALUES = [
    *(None, ..., True, False, 0, 1, -1, 10**400, 0.0, -0.0, 1.0, math.nan, math.inf, "1", "1.0"),
    *(
        b"1",
        bytearray(b"1"),
        1 + 0j,
        complex(1, -0.0),
        Decimal(1),
        Decimal("1.0"),
        Fraction(1),
        "None",
    ),
    *(Material.STEEL, Material.BRASS, Level.STEEL, PurePosixPath("1"), PurePosixPath("a/b"), "a/b"),
    *(kind(1) for kind in (np.int8, np.int64, np.uint8, np.float32, np.float64, np.bool_, np.str_)),
    *(np.int64(3), np.float64(3.0), np.longdouble, np.datetime64(1, "s"), np.datetime64(1, "ms")),
    *(np.array(1), np.array([1]), np.array([[1]]), np.array([1.0]), np.array([1], dtype=">i8")),
    *(
        np.array([1], dtype=object),
        np.array([1.0], dtype=object),
        np.array(["1"]),
        np.array([b"1"]),
    ),
    *(np.ma.array([1.0, 2.0], mask=m) for m in ([0, 0], [0, 1], [1, 0])),
    *(record(1.0, 1), record(1.0, 2), record(2.0, 1)),
    *([], (), {}, set(), frozenset(), [1], (1,), {1}, frozenset({1}), [[1]], [[1], []], [[], [1]]),
    *({1: 2}, {"1": 2}, {1.0: 2}, {(1, 2): 3}, {1: {2: 3}}, {1: 2, 3: 4}, [1, 2], [[1, 2]]),
    *(Pair(1, 2), (1, 2), range(1), range(1, 2), slice(1), slice(1, 2)),
    *(Scaled(1), Scaled(1.0), Other(1), [Scaled(1)], {"a": Scaled(2)}, Scaled(Scaled(1))),
    *(datetime.date(2026, 1, 1), datetime.datetime(2026, 1, 1), datetime.timedelta(1)),
    *(datetime.datetime(2026, 1, 1, tzinfo=zone) for zone in (datetime.UTC, ZoneInfo("UTC"))),
    *(datetime.time(1, 2), datetime.datetime(2026, 1, 1, fold=1), "2026-01-01"),
    *(np.sin, np.cos, math.sin, math.cos, int, float, Scaled, math, operator, len, [].append),
    *(two, models.quadratic, functools.partial(two, factor=1.0), functools.partial(two, factor=1)),
    *(Scaled(1).__call__, Scaled(2).__call__, Other(1).__call__, per_sample(two)),
    *(lambda x: x[:, 0], lambda x: x[:, 1], lambda x: 2 * x[:, 0], lambda x: 3 * x[:, 0]),
    *(make(p) for make in MAKERS[1:] for p in (1, 1.0, np.int64(1))),
    *(branch(True), branch(False), with_attribute(1), with_attribute(2), special.expit),
]


def test_values_that_differ_have_descriptions_that_differ() -> None:
    told = [repr(described(value)) for value in VALUES]
    for (a, first), (b, second) in itertools.combinations(zip(VALUES, told, strict=True), 2):
        assert first != second, (a, b)


def test_the_same_value_has_the_same_description() -> None:
    a, b = {"x": 1, "y": [Scaled(np.int64(3))]}, {"x": 1, "y": [Scaled(np.int64(3))]}
    assert described(a) == described(b)
    assert described({"b", "a", "c"}) == described({"c", "a", "b"})
    for make in MAKERS:
        assert described(make(2.5)) == described(make(2.5))
    # what lies between the fields of a record means nothing
    one, other = record(1.0, 1), record(1.0, 1)
    other.view(np.uint8)[-1] = 77
    assert described(one) == described(other)


class Opaque:
    def __call__(self, x: FloatArray) -> FloatArray:
        return x[:, 0]


@dataclass
class Thawed:
    p: float = 1.0

    def __call__(self, x: FloatArray) -> FloatArray:
        return self.p * x[:, 0]


@dataclass(frozen=True)
class Apart:
    p: float
    log: Any = field(default=None, compare=False)

    def __call__(self, x: FloatArray) -> FloatArray:
        return self.p * x[:, 0]


def holding_itself() -> list[Any]:
    loop: list[Any] = []
    loop.append(loop)
    return loop


@pytest.mark.parametrize(
    "model",
    [
        Opaque(),
        Thawed(),
        Scaled(Opaque()),
        Scaled({"a": [object()]}),
        Scaled(holding_itself()),
        Scaled(np.array([object()])),
        Scaled(np.longdouble(1)),
        closed_over(Opaque()),
        functools.partial(two, factor=Thawed()),
        Opaque().__call__,
        ot.SymbolicFunction(["a", "b"], ["a"]),
        types.MethodType(two, Opaque()),
        functools.partial(two, factor=np.random.default_rng(1)),
        Odd(two),
        Scaled(np.frompyfunc(lambda x: 2.0 * x, 1, 1)),
    ],
)
def test_of_what_cannot_be_told_nothing_is_stored_and_a_warning_says_why(
    model: Any, tmp_path: Path
) -> None:
    with pytest.raises(UndescribedError, match="model"):
        model_identity(models.problem(model))
    with pytest.warns(UserWarning, match=r"nothing is stored: .*frozen dataclass") as caught:
        session = Evaluator(store=tmp_path / "runs.db").open(models.problem(model), None)
    assert "model" in str(caught[0].message)
    session.evaluate(models.rows(1))
    with Store(tmp_path / "runs.db") as store:
        assert len(store) == 0


def test_what_has_no_influence_on_a_response_is_left_out() -> None:
    one, other = (models.problem(Apart(2.0, log)) for log in (None, Opaque()))
    assert model_identity(one) == model_identity(other)
    assert model_identity(one) != model_identity(models.problem(Apart(3.0)))


PARAMETERS = [np.int64(1), np.int64(3), 2, 2.0, Decimal(5), Fraction(7), np.array(4.0), True]


@pytest.mark.parametrize("make", MAKERS)
def test_the_store_does_not_answer_for_another_model(make: Any, tmp_path: Path) -> None:
    asked, x = uqfold.criteria(1.0), models.rows(50)
    for p in PARAMETERS:
        problem = models.problem(make(p))
        session = Evaluator(store=tmp_path / "runs.db").open(problem, None)
        np.testing.assert_array_equal(session.evaluate(x), float(p) * x[:, 0])
        assert session.n_reused == 0
    for p in (1, 3):
        problem = models.problem(make(np.int64(p)))
        stored = Evaluator(store=tmp_path / "other.db")
        answers = [MonteCarlo(systems=500).estimate(problem, asked, rng=1)]
        answers += [MonteCarlo(systems=500).estimate(problem, asked, rng=1, evaluator=stored)] * 2
        assert len({one[0].pf for one in answers}) == 1


def test_lambdas_are_told_by_their_code(tmp_path: Path) -> None:
    x = models.rows(20)
    for column, model in enumerate((lambda x: x[:, 0], lambda x: x[:, 1])):
        session = Evaluator(store=tmp_path / "runs.db").open(models.problem(model), None)
        np.testing.assert_array_equal(session.evaluate(x), x[:, column])
        assert session.n_reused == 0


@dataclass(frozen=True)
class Keyed(dict):  # type: ignore[type-arg]
    def __init__(self, p: float) -> None:
        dict.__init__(self, a=p)


@dataclass(frozen=True)
class Listing(tuple):  # type: ignore[type-arg]
    def __new__(cls, p: float) -> Any:
        return tuple.__new__(cls, (p,))

    def __init__(self, p: float) -> None:
        """Leave what ``__new__`` has made."""


@dataclass(frozen=True)
class Number(float):
    def __init__(self, p: float) -> None:
        """Leave what ``__new__`` has made."""


class Slotted:
    __slots__ = ("z",)


@dataclass(frozen=True)
class OfSlotted(Slotted):
    def __init__(self, p: float) -> None:
        object.__setattr__(self, "z", p)


class Named(NamedTuple):
    column: int = 0


class Attributed(Named):
    p: float


def named_tuple(p: float) -> Any:
    one = Attributed()
    one.p = p
    return one


class Grade(enum.Enum):
    FINE = 1


def member_with_attribute(p: float) -> Any:
    Grade.FINE.factor = p  # type: ignore[attr-defined]
    return Grade.FINE


def local_enum(p: float) -> Any:
    class Local(enum.Enum):
        FINE = 1

        def factor(self) -> float:
            return p

    return Local.FINE


def local_number_of_enum(p: float) -> Any:
    class Local(float, enum.Enum):
        FINE = 1

        def __new__(cls, value: int) -> Any:
            one = float.__new__(cls, p)
            one._value_ = value
            return one

    return Local.FINE


def run_time_class(p: float) -> Any:
    return type("T", (), {"a": p})


def run_time_tuple(p: float) -> Any:
    return collections.namedtuple("Q", ["z"], defaults=[p])


def run_time_dataclass(p: float) -> Any:
    return dataclasses.make_dataclass("D", [], frozen=True, namespace={"k": p})()


def with_metaclass(p: float) -> Any:
    class Meta(type):
        @property
        def factor(cls) -> float:
            return p

    class Local(metaclass=Meta):
        """Has nothing of its own."""

    return Local


def partial_method(p: float) -> Any:
    @dataclass(frozen=True)
    class Local:
        __call__ = functools.partialmethod(two, factor=p)

    return Local()


def of_text(p: float) -> Any:
    """Return what sympy's lambdify would: a function of the same name each time."""
    made: dict[str, Any] = {}
    exec(f"def generated(x):\n    return {p} * x[:, 0]", made)
    return made["generated"]


class OfNoCompiler:
    py_func = staticmethod(two)

    def __init__(self, p: float) -> None:
        self.p = p


def own_module(p: float) -> Any:
    module = types.ModuleType("settings")
    module.p = p  # type: ignore[attr-defined]
    return module


def filled(p: float) -> Any:
    return np.ma.array([1.0, 2.0], mask=[0, 1], fill_value=p)


class Tagged(PurePosixPath):
    """A path that holds something else too."""


def tagged(p: float) -> Any:
    path = Tagged("a")
    path.p = p  # type: ignore[attr-defined]
    return path


@pytest.mark.parametrize("bound", [False, True])
@pytest.mark.parametrize(
    "make",
    [
        *(Keyed, Listing, Number, OfSlotted, named_tuple, member_with_attribute, local_enum),
        *(local_number_of_enum, run_time_class, run_time_tuple, run_time_dataclass),
        *(with_metaclass, partial_method, of_text, OfNoCompiler, own_module, filled, tagged),
    ],
)
def test_all_that_an_object_holds_is_described_or_it_is_refused(make: Any, bound: bool) -> None:
    """Bases with content, slots, attributes, classes made at run time: each holds p somewhere."""

    def told(p: float) -> Any:
        value = make(p)
        try:
            held = functools.partial(two, factor=value) if bound else value
            return described(held)
        except UndescribedError:
            return None

    first, second = told(0.1), told(0.9)
    assert first is None or first != second


@pytest.mark.parametrize("make", [OfSlotted, named_tuple, member_with_attribute, run_time_class])
def test_what_has_more_attributes_than_usual_is_recognised(make: Any) -> None:
    assert described(make(0.1)) == described(make(0.1)) != described(make(0.9))


@pytest.mark.parametrize("kind", [Keyed, Number, local_enum])
def test_an_object_of_which_not_all_is_seen_is_not_stored(kind: Any, tmp_path: Path) -> None:
    """The store does not answer for a frozen dataclass that is a dict, say, with other content."""
    models_of = [functools.partial(two, factor=kind(p)) for p in (0.1, 0.9)]
    for model in models_of:
        with pytest.warns(UserWarning, match=r"nothing is stored: .* content|made while"):
            Evaluator(store=tmp_path / "runs.db").open(models.problem(model), None)


T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True)
class Typed(Generic[T_co]):
    p: float


@dataclass(frozen=True, slots=True)
class Slim:
    p: float
    log: Any = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class SlimChild(Slim):
    q: float = 1.0


def test_usual_bases_and_slots_change_no_description() -> None:
    """Entries of earlier stores are found again."""
    here = __name__
    p = ["p", ["float", "0x1.0000000000000p+0"]]
    assert described(Typed[float](1.0)) == ["record", f"{here}.Typed", [p], []]
    assert described(Slim(1.0, "log")) == ["record", f"{here}.Slim", [p], []]
    child = ["record", f"{here}.SlimChild", [p, ["q", p[1]]], []]
    assert described(SlimChild(1.0, "log")) == child
    assert described(Named(2)) == [f"{here}.Named", [["int", "2"]], []]
    assert described(Material.STEEL) == ["enum", f"{here}.Material", "STEEL", ["int", "1"]]
    assert described(Level.STEEL) == ["enum", f"{here}.Level", "STEEL", ["int", "1"]]
    assert described(type(None)) == ["type", "builtins.NoneType", []]
