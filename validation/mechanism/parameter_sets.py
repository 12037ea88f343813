"""The wings that the checks run through: Tables 1, 6, 8, 9 and 10 and their 3-sigma corners."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import count, product

import numpy as np

from uqfold.mechanism import WingParameters

# name -> (mean, standard deviation) in SI units, angles in radians
TABLE_6: dict[str, tuple[float, float]] = {
    "V_q": (140.0, 10.0),
    "delta": (0.0, math.radians(5.0)),
    "k_d": (550.0, 10.0),
    "b": (0.007, 0.00025),
    "C_r": (0.0015, 0.00005),
}
TABLE_10: dict[str, tuple[float, float]] = {
    "V_q": (200.0, 25.0),
    "delta": (0.0, math.radians(25.0)),
    "k_d": (1100.0, 10.0),
    "b": (0.006, 0.00025),
    "C_r": (0.0015, 0.00005),
    "l_1": (1.5, 0.002),
    "l_2": (1.3, 0.002),
}
TABLE_8: dict[str, tuple[float, float]] = {
    "V_q": (100.0, 180.0),
    "delta": (math.radians(30.0), math.radians(-30.0)),
    "b": (0.006, 0.008),
    "k_d": (600.0, 500.0),
    "C_r": (0.002, 0.001),
}
"""Changed means, the conditions 1 to 10 in order."""
TABLE_9: dict[str, tuple[float, float]] = {
    "V_q": (1.0, 20.0),
    "delta": (math.radians(1.0), math.radians(20.0)),
    "b": (0.00001, 0.0005),
    "k_d": (1.0, 30.0),
    "C_r": (0.000005, 0.0002),
}
"""Changed standard deviations, the conditions 11 to 20 in order."""


def draws_of_table_6(n: int, seed: int) -> dict[str, np.ndarray]:
    """Return draws (n,) of the random inputs of Table 6 by name."""
    rng = np.random.default_rng(seed)
    return {name: rng.normal(mean, sigma, n) for name, (mean, sigma) in TABLE_6.items()}


def means(table: Mapping[str, tuple[float, float]]) -> WingParameters:
    """Return the wing at the means of a table; what the table does not name is as in Table 1."""
    return WingParameters(**{name: mean for name, (mean, _) in table.items()})


def corners(
    table: Mapping[str, tuple[float, float]], free: int
) -> Iterator[tuple[str, WingParameters]]:
    """Return corners at 3 standard deviations from the means, as a two-level fractional factorial.

    The first `free` variables take all sign combinations. Each further one takes the product of
    the signs of the free ones without one of them, and the last variable of all the product of
    all free ones.
    """
    for signs in product((-1, 1), repeat=free):
        without_one = [math.prod(signs[:k] + signs[k + 1 :]) for k in range(len(table) - free - 1)]
        levels = dict(zip(table, [*signs, *without_one, math.prod(signs)], strict=True))
        wing = {name: mean + 3.0 * levels[name] * sigma for name, (mean, sigma) in table.items()}
        label = "".join("+" if sign > 0 else "-" for sign in levels.values())
        yield label, WingParameters(**wing)


def parameter_sets() -> dict[str, WingParameters]:
    """Return all sets by name."""
    six = means(TABLE_6)
    sets = {"table 1": WingParameters(), "table 6": six, "table 10": means(TABLE_10)}
    sets |= {
        f"{name}, material": wing.replace(tangential_velocity="material")
        for name, wing in sets.items()
    }
    sets |= {f"table 6 corner {label}": wing for label, wing in corners(TABLE_6, 4)}
    number = count(1)
    for name, changed in TABLE_8.items():
        for mean in changed:
            sets[f"table 8 condition {next(number)}"] = six.replace(**{name: mean})
    for name, changed in TABLE_9.items():
        for sigma in changed:
            condition = f"table 9 condition {next(number)}"
            for sign, word in ((-1, "low"), (1, "high")):
                value = TABLE_6[name][0] + 3.0 * sign * sigma
                sets[f"{condition} {word}"] = six.replace(**{name: value})
    sets |= {f"table 10 corner {label}": wing for label, wing in corners(TABLE_10, 3)}
    return sets
