"""Checks of arguments: what they return, what they refuse, and in which words."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from uqfold import checks
from uqfold.checks import shown


@pytest.mark.parametrize(
    "value", [5, 5.0, np.int64(5), np.uint8(5), np.float32(5), np.array(5), Fraction(5), Decimal(5)]
)
def test_numpy_scalars_are_whole_numbers_like_those_of_python(value):
    answer = checks.whole("runs", value, at_least=1, at_most=5)
    assert answer == 5
    assert type(answer) is int


def test_what_is_no_number_is_a_type_error():
    nanoseconds = np.timedelta64(5, "ns")
    for check in (checks.whole, checks.real):
        for value in (True, np.True_, "5", np.str_("5"), b"5", None, 5j, object(), float):
            with pytest.raises(TypeError, match=rf"^runs = {re.escape(shown(value))}: give a"):
                check("runs", value)
        for value in ([5], np.array([5]), nanoseconds, np.array(nanoseconds), np.ma.masked):
            with pytest.raises(TypeError, match=r"^runs = .*: give a"):
                check("runs", value)


ODD = (
    Decimal("sNaN"),
    Decimal("NaN"),
    Decimal("Infinity"),
    Decimal("1e999999"),
    Fraction(10**400, 3),
)


def test_whole_numbers_out_of_range_are_value_errors():
    for value in (5.5, np.nan, np.inf, -np.inf, 0, -1, 65, 10**400, -(10**5000), *ODD):
        with pytest.raises(ValueError, match=r"^runs = .*: give a whole number from 2 to 64"):
            checks.whole("runs", value, at_least=2, at_most=64)


def test_a_whole_number_fits_into_an_array():
    assert checks.whole("seed", 2**63 - 1) == 2**63 - 1
    with pytest.raises(ValueError, match=r"give a whole number >= 0, smaller than 2\*\*63"):
        checks.whole("seed", 2**63, at_least=0)


@pytest.mark.parametrize(
    "value",
    [0.5, np.float32(0.5), np.longdouble(0.5), np.array(0.5), Fraction(1, 2), Decimal("0.5")],
)
def test_numpy_scalars_are_real_numbers_like_those_of_python(value):
    answer = checks.real("step", value, above=0.0, at_most=1.0)
    assert answer == 0.5
    assert type(answer) is float


def test_real_numbers_out_of_range_are_value_errors():
    cases = (
        (0.0, {"above": 0.0}, "give a positive number"),
        (0, {"above": 0.0, "at_most": 1.0}, "give a number in (0, 1]"),
        (1.0, {"at_least": 0.0, "below": 1.0}, "give a number in [0, 1)"),
        (-1.0, {"at_least": 0.0, "what": "number of seconds"}, "give a number of seconds >= 0"),
        (2.0, {"below": 2.0}, "give a number < 2"),
        (np.inf, {}, "give a finite number"),
        (np.nan, {"finite": False}, "give a number"),
        (Decimal("sNaN"), {"finite": False}, "give a number"),
        (10**400, {"finite": False}, "give a number that fits into a float"),
        (Fraction(1, 10**400), {"above": 0.0}, "give a positive number"),
    )
    for value, bounds, remedy in cases:
        with pytest.raises(ValueError, match=rf"^x = .*: {re.escape(remedy)}$"):
            checks.real("x", value, **bounds)


def test_infinity_is_a_number_where_it_is_allowed():
    assert checks.real("threshold", np.float64(-np.inf), finite=False) == -np.inf
    if np.finfo(np.longdouble).maxexp > 1024:
        with pytest.raises(ValueError, match="threshold"):
            checks.real("threshold", np.longdouble("1e400"), finite=False)


def test_a_flag_is_true_or_false():
    assert checks.flag("quick", np.True_) is True
    assert checks.flag("quick", np.array(False)) is False
    for value in (1, 0, None, "yes", [], np.array([True])):
        with pytest.raises(TypeError, match=r"^quick = .*: give True or False"):
            checks.flag("quick", value)


class Shape(Enum):
    ROUND = "round"


def test_a_choice_is_one_of_the_options():
    assert type(checks.choice("seek", np.str_("largest"), ("smallest", "largest"))) is str
    assert checks.choice("shape", Shape.ROUND, Shape) is Shape.ROUND
    with pytest.raises(ValueError, match=r"^seek = 'big': choose from 'smallest', 'largest'$"):
        checks.choice("seek", "big", ("smallest", "largest"))
    for value in (b"largest", None, 1, ["largest"], np.array(["largest", "smallest"])):
        with pytest.raises(TypeError, match=r"^seek = .*: choose from"):
            checks.choice("seek", value, ("smallest", "largest"))
    with pytest.raises(TypeError, match="order = True"):
        checks.choice("order", True, (1, 2))


def test_text_is_not_empty_and_no_bytes():
    assert type(checks.text("name", np.str_("a"))) is str
    with pytest.raises(ValueError, match=r"^name = '': give text that is not empty$"):
        checks.text("name", "")
    with pytest.raises(TypeError, match=r"^name = b'a': give text$"):
        checks.text("name", b"a")


def test_instances_and_functions():
    assert checks.instance("count", 3, int, "give a count") == 3
    with pytest.raises(TypeError, match=r"^problem = <object object at .*>: give a Problem$"):
        checks.instance("problem", object(), Path, "give a Problem")
    assert checks.function("model", abs) is abs
    for value in (3, None, dict):
        with pytest.raises(TypeError, match=r"^model = .*: give a function$"):
            checks.function("model", value)


def test_paths():
    assert checks.path("folder", Path("a")) == checks.path("folder", np.str_("a")) == Path("a")
    for value in (42, b"a", None, True, ["a"]):
        with pytest.raises(TypeError, match=r"^folder = .*: give a path"):
            checks.path("folder", value)
    for value in ("", "a\0b"):
        with pytest.raises(ValueError, match=r"^folder = .*: give a path"):
            checks.path("folder", value)


def test_none_where_it_is_allowed():
    assert checks.or_none("runs", None, checks.whole, at_least=1) is None
    assert checks.or_none("runs", np.int64(3), checks.whole, at_least=1) == 3
    with pytest.raises(ValueError, match=r"^runs = 0: give a whole number >= 1, or None$"):
        checks.or_none("runs", 0, checks.whole, at_least=1)


def test_items_of_a_list_are_named():
    assert checks.several("taus", np.array([1.0, 2.0]), checks.real) == (1.0, 2.0)
    assert checks.several("taus", (t for t in [1]), checks.real) == (1.0,)
    with pytest.raises(TypeError, match=r"^taus\[1\] = 'x': give a finite number$"):
        checks.several("taus", [1.0, "x"], checks.real)
    for value in ("ab", b"ab", 3, None, {"a": 1}, {1.0}, np.array(1.0), list):
        with pytest.raises(TypeError, match=r"^taus = .*: give a list$"):
            checks.several("taus", value, checks.real)


def test_names_are_not_given_twice():
    assert checks.names("names", ["a", np.str_("b")]) == ("a", "b")
    with pytest.raises(ValueError, match=r"^names = \('a', 'a'\): name each once, not 'a' twice$"):
        checks.names("names", ["a", "a"])
    with pytest.raises(TypeError, match=r"^names = 'ab': give a list$"):
        checks.names("names", "ab")


def test_arrays_have_real_numbers_and_a_shape():
    assert checks.array("X", [[1, 2]], ("n", 2)).dtype == np.float64
    assert checks.array("y", [Fraction(1, 2), 1], ("n",)).tolist() == [0.5, 1.0]
    exact = np.array([Fraction(1, 2), np.nan], dtype=object)
    assert np.isnan(checks.array("y", exact, finite=False)).tolist() == [False, True]
    assert checks.array("X", np.empty((0, 2)), ("n", 2)).shape == (0, 2)
    assert np.isnan(checks.array("y", [np.nan], finite=False)).all()
    with pytest.raises(
        ValueError, match=r"^X = .*: give finite real numbers of shape \(n, 2\), not"
    ):
        checks.array("X", [1.0, 2.0], ("n", 2))
    masked = np.ma.array([1.0, 2.0], mask=[False, True])
    ragged, dates = [[1.0], [1.0, 2.0]], np.array(["2020-01-01"], dtype="M8[D]")
    for value in (masked, ragged, dates, ["1"], [True], [1j], [b"1"], None, object(), [10**400]):
        with pytest.raises((TypeError, ValueError), match=r"^y = "):
            checks.array("y", value, finite=False)
    with pytest.raises(ValueError, match=r"^y = \[nan\]: give finite real numbers$"):
        checks.array("y", [np.nan])


def test_a_record_keeps_the_plain_value():
    @dataclass(frozen=True)
    class Setting:
        runs: int

        def __post_init__(self) -> None:
            checks.keep(self, "runs", checks.whole, at_least=1)

    assert type(Setting(np.int64(3)).runs) is int
    with pytest.raises(ValueError, match=r"^runs = 0"):
        Setting(0)


def test_a_value_that_cannot_be_printed_is_shown_by_its_type():
    class Silent:
        def __repr__(self) -> str:
            raise KeyError("none")

    assert "Silent" in shown(Silent())
    assert shown(10**9999) == "<int>"
    assert len(shown("x" * 999)) < 100
    assert "\n" not in shown(np.zeros((3, 3)))


def test_the_text_of_an_error_is_short_and_visible_whatever_it_holds():
    class MuteError(Exception):
        def __str__(self) -> str:
            raise RuntimeError

    assert checks.raised(MuteError()) == "MuteError: (its text cannot be told)"
    told = checks.raised(ValueError("first\n\x1b[2J\ud800\u202e\x85" + "a" * 10**7 + " last"))
    assert told.startswith("ValueError: first \ufffd[2J\ufffd\ufffd a")
    assert told.endswith("a last")
    assert len(told) < 450
    assert told.isprintable()


def test_a_name_that_is_nearly_right_is_guessed() -> None:
    """All names are listed nevertheless."""
    with pytest.raises(ValueError, match=r"did you mean 'kriging'\? choose from 'mc', 'kriging'"):
        checks.choice("method", "Krigng", ["mc", "kriging"])
    with pytest.raises(ValueError, match="did you mean 'openturns-form'"):
        checks.choice("method", "form", ["openturns-form", "sorm"])  # a part of one name only
    with pytest.raises(ValueError, match=r"'xyz': choose from"):
        checks.choice("method", "xyz", ["mc", "kriging"])
