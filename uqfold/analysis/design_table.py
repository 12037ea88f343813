"""Designs as a table, verified by simulation of the real model where that is asked for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from uqfold.analysis.design import Design
from uqfold.analysis.verification import verify_all
from uqfold.checks import instance, listed, or_none
from uqfold.evaluation import Evaluator
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.seeding import RandomSource

if TYPE_CHECKING:
    import pandas as pd

PLACES = ("value", "safe")
"""Where a design is verified, if it is found."""


def designs_to_frame(
    designs: Sequence[Design],
    verify_by: ReliabilityMethod | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = 0,
    evaluator: Evaluator | None = None,
) -> pd.DataFrame:
    """Return designs as rows, each verified at its best and at its safe value.

    Parameters
    ----------
    designs
        What `design_threshold`, `design_thresholds` or `design_input` returned.
    verify_by
        A simulation of the real model; None verifies nothing.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`, for the verification.

    Returns
    -------
    pandas.DataFrame
        One row per design: ``label`` (its method), ``parameter``, ``unit``, ``threshold`` (NaN
        where it is designed), ``tau``, ``missions``, ``seek``, ``target_pf``, ``status``,
        ``message``, ``value``, ``std_error``, ``low``, ``high``, ``safe``, ``n_evals``, ``seed``;
        of the verification ``verified_by``, ``verified_n_evals``, ``value_pf``,
        ``value_ci_low``, ``value_ci_high``, ``value_meets``, the same of ``safe``, and
        ``agrees`` (yes, no or empty). Numbers are NaN and texts empty where there is none.

    Raises
    ------
    RuntimeError
        If the simulation gives no answer.
    """
    import pandas as pd

    given = listed("designs", designs)
    remedy = "give a method such as uqfold.methods.MonteCarlo(), or None"
    or_none("verify_by", verify_by, instance, ReliabilityMethod, remedy)
    for i, one in enumerate(given):
        instance(
            f"designs[{i}]", one, Design, "give what design_threshold or design_input returned"
        )
    places = [
        (i, place)
        for i, one in enumerate(given)
        for place in PLACES
        if verify_by is not None and math.isfinite(getattr(one, place))
    ]
    found = verify_all(
        [(given[i], getattr(given[i], place)) for i, place in places],
        verify_by, max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    checks = dict(zip(places, found, strict=True))
    rows = []
    for i, one in enumerate(given):
        designs_threshold = one.parameter.startswith("threshold")
        own = [checks[i, place] for place in PLACES if (i, place) in checks]
        row: dict[str, Any] = {
            "label": one.method,
            "parameter": one.parameter,
            "unit": one.unit,
            "threshold": math.nan if designs_threshold else one.criterion.threshold,
            "tau": math.nan if one.criterion.tau is None else one.criterion.tau,
            "missions": str(one.criterion.missions),
            **{name: getattr(one, name) for name in ("seek", "target_pf", "status", "message")},
            "value": one.value,
            "std_error": (one.high - one.low) / (2.0 * 1.96),
            **{name: getattr(one, name) for name in ("low", "high", "safe", "n_evals", "seed")},
            "verified_by": own[0].method if own else "",
            "verified_n_evals": sum({check.n_evals for check in own}),
        }
        for place in PLACES:
            check = checks.get((i, place))
            for name in ("pf", "ci_low", "ci_high"):
                row[f"{place}_{name}"] = math.nan if check is None else getattr(check, name)
            row[f"{place}_meets"] = "" if check is None else check.meets
        row["agrees"] = "" if not own else "yes" if all(check.agrees for check in own) else "no"
        rows.append(row)
    return pd.DataFrame(rows)
