"""Numbers, criteria and seeds as a study file states them."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

from uqfold.comparison.studies.document import Place
from uqfold.comparison.studies.keys import COUNT, NUMBER, Key, Value, list_of, read_table
from uqfold.problems.criterion import Binomial, Missions

MAX_POINTS = 100_000


def _numbers(content: Any, place: Place) -> tuple[float, ...]:
    if isinstance(content, dict):
        return _spaced(content, place)
    values: tuple[float, ...] = list_of(NUMBER).read(content, place)
    return values


def _spaced(content: dict[str, Any], place: Place) -> tuple[float, ...]:
    """Give equally spaced numbers, formed in decimals: 0.53 + 3 * 0.0025 is 0.5375 exactly."""
    keys = [
        Key("start", NUMBER, "first number"),
        Key("stop", NUMBER, "last number"),
        Key("step", NUMBER, "distance", None),
        Key("count", COUNT, "how many", None),
    ]
    read = read_table(content, place, keys)
    for name in ("start", "stop", "step"):
        if read[name] is not None and not math.isfinite(read[name]):
            raise place.at(name).error(f"{read[name]}: give a finite number")
    start, stop = (Decimal(repr(read[name])) for name in ("start", "stop"))
    if (read["step"] is None) == (read["count"] is None):
        raise place.error("give start, stop and either step or count")
    if read["count"] is not None:
        count = read["count"]
        if count < 2:
            raise place.at("count").error(f"{count}: give at least 2")
        step = (stop - start) / (count - 1)
    else:
        step = Decimal(repr(read["step"]))
        if step == 0 or (stop - start) / step < 0:
            raise place.at("step").error(f"{step} does not lead from {start} to {stop}")
        steps = (stop - start) / step
        if steps != int(steps):
            raise place.at("step").error(f"{stop} is not a whole number of steps from {start}")
        count = int(steps) + 1
    if count > MAX_POINTS:
        raise place.error(f"{count} numbers: at most {MAX_POINTS}")
    return tuple(float(start + i * step) for i in range(count))


def _tau(content: Any, place: Place) -> float | None:
    if content == "none":
        return None
    if isinstance(content, str):
        raise place.error(f"{content!r}: give a number >= 0, or the text none")
    value: float = NUMBER.read(content, place)
    if not value >= 0.0:
        raise place.error(f"{value:g}: give a number >= 0, or the text none")
    return value


def _missions(content: Any, place: Place) -> Missions:
    if not isinstance(content, dict):
        count: int = COUNT.read(content, place)
        return count
    keys = [Key("planned", COUNT, "planned flights"), Key("p", NUMBER, "probability of each")]
    read = read_table(content, place, keys)
    try:
        return Binomial(read["planned"], read["p"])
    except ValueError as error:
        raise place.error(str(error)) from error


def _seed(content: Any, place: Place) -> int:
    if isinstance(content, bool) or not isinstance(content, int) or content < 0:
        raise place.error(f"{content!r}: a seed is a whole number >= 0")
    return content


def _seeds(content: Any, place: Place) -> tuple[int, ...]:
    if isinstance(content, int) and not isinstance(content, bool):
        count: int = COUNT.read(content, place)
        if count > MAX_POINTS:
            raise place.error(f"{count} seeds: at most {MAX_POINTS}")
        return tuple(range(count))
    if not isinstance(content, list) or not content:
        raise place.error(f"{content!r}: give a number of seeds, or a list of seeds")
    seeds = tuple(_seed(seed, place.at(i)) for i, seed in enumerate(content))
    if len(set(seeds)) != len(seeds):
        raise place.error("a seed occurs twice")
    return seeds


NUMBERS = Value(
    "number, list of numbers, or a table with start, stop and either step or count", _numbers
)
TAUS = list_of(Value("number >= 0, or the text none", _tau))
MISSIONS = list_of(Value("whole number, or a table with planned and p", _missions))
SEED = Value("whole number >= 0", _seed)
SEEDS = Value("how many seeds (counted from 0), or a list of them", _seeds)
