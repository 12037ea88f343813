"""What a notebook shows of a figure that was made without pyplot."""

import io
from typing import Any

import pandas as pd
import pytest
from matplotlib.figure import Figure
from PIL import Image

from uqfold import plots
from uqfold.plots.analyses import PLACES

POINTS = pd.DataFrame({"series": ["a", "a"], "x": [1.0, 2.0], "y": [1.0, 3.0]})
DESIGN: dict[str, Any] = {
    "label": "kriging", "parameter": "threshold", "unit": "", "threshold": 4.0, "tau": float("nan"),
    "missions": "1", "seek": "smallest", "status": "found", "target_pf": 1e-3, "value": 4.0,
    "low": 3.9, "high": 4.1,
}  # fmt: skip
SIMULATED = {"pf": 1e-3, "ci_low": 9e-4, "ci_high": 2e-3}


def shown(drawn: Any) -> None:
    data, size = drawn._repr_png_()
    with Image.open(io.BytesIO(data)) as picture:
        # sharp on screens of twice the pixels, and no larger than on paper
        assert picture.width > size["width"] > 300
        assert picture.width / picture.height == pytest.approx(size["width"] / size["height"], 0.02)


def test_axes_and_figures_show_themselves() -> None:
    axes = plots.points(POINTS, "x", "y")
    shown(axes)
    shown(axes.figure)


def test_axes_of_the_caller_stay_his() -> None:
    own = Figure().subplots()
    assert plots.points(POINTS, "x", "y", ax=own) is own
    assert not hasattr(own, "_repr_png_")


def test_no_unit_is_no_empty_brackets() -> None:
    places = {f"{place}_{one}": pf for place in PLACES for one, pf in SIMULATED.items()}
    figure = plots.design(pd.DataFrame([DESIGN | places]))
    shown(figure)
    assert figure.axes[0].get_xlabel() == "smallest threshold"
