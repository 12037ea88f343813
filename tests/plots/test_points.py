"""Sets of points: colours of methods, a reference with its band, limits, logarithmic axes."""

import pandas as pd
import pytest

from uqfold import plots
from uqfold.plots.style import method_styles

FRAME = pd.DataFrame(
    [
        ("reference", 1.0, 0.1, 0.09, 0.11),
        ("reference", 2.0, 0.01, 0.009, 0.011),
        ("mc", 1.0, 0.12, 0.1, 0.14),
        ("mc", 2.0, None, None, None),
    ],
    columns=["series", "x", "y", "low", "high"],
)


def test_points_have_the_colour_of_their_method_and_the_reference_a_band() -> None:
    ax = plots.points(FRAME, "T (s)", "pf", log="y", limits={"limit": 0.05, "-limit": 0.02})
    told = plots.values(ax.figure)
    assert set(told) == {"series=reference", "series=mc"} or set(told) == {"series=mc"}
    (drawn,) = [line for line in ax.get_lines() if line.get_label() == "mc"]
    assert drawn.get_color() == method_styles(["mc"])["mc"].color
    assert len(told["series=mc"]) == 1  # the gap is no point
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_yscale()) == ("T (s)", "pf", "log")
    assert [text.get_text() for text in ax.texts] == ["limit"]
    assert len(ax.collections) == 2  # band, and error bars of the points


def test_it_draws_into_axes_that_are_given() -> None:
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert plots.points(FRAME[["series", "x", "y"]], "x", "y", ax=ax) is ax
    with pytest.raises(TypeError, match="give a DataFrame with columns series, x and y"):
        plots.points(FRAME[["x", "y"]], "x", "y")
