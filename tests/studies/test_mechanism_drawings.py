"""The drawings of the study of the mechanism, and its animation."""

import importlib.util
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from uqfold.mechanism import WingParameters, motion_table

PATH = Path(__file__).parents[2] / "studies" / "mechanism" / "drawings.py"
spec = importlib.util.spec_from_file_location("drawings", PATH)
assert spec is not None
assert spec.loader is not None
drawings = importlib.util.module_from_spec(spec)
spec.loader.exec_module(drawings)

SVG = "{http://www.w3.org/2000/svg}"
FRAMES, STILL = 400, 60
RADIUS = 44.0


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return pd.DataFrame(motion_table(WingParameters(C_r_C=0.002)))


def lines(figure: Figure, panel: int) -> list[np.ndarray]:
    return [line.get_xydata() for line in figure.axes[panel].get_lines()]


def test_crank_angle_is_drawn_in_degrees_up_to_the_lock(table: pd.DataFrame) -> None:
    figure = drawings.crank_angle(table)
    curve, lock = lines(figure, 0)
    assert curve[-1] == pytest.approx(
        [table["time"].iloc[-1], np.degrees(table["theta_1"].iloc[-1])]
    )
    assert lock[0, 0] == table["time"].iloc[-1]
    (axes,) = figure.axes
    assert axes.get_xlabel() == "time (s)"
    assert "degrees" in axes.get_ylabel()
    assert f"{table['time'].iloc[-1]:.4f} s" in axes.texts[0].get_text()


def test_poses_are_those_of_the_motion_and_leave_out_what_comes_too_late(
    table: pd.DataFrame,
) -> None:
    figure = drawings.poses(table, times=(0.1, 0.3, 0.9))
    # per pose: crank, rod, slider
    drawn = lines(figure, 0)[:9]
    for k, t in enumerate((0.1, 0.3, table["time"].iloc[-1])):
        i = int(np.argmin(np.abs(table["time"] - t)))
        crank, rod, slider = drawn[3 * k : 3 * k + 3]
        B, C = (table["x_B"][i], table["y_B"][i]), (table["x_C"][i], table["y_C"][i])
        np.testing.assert_array_equal(crank, [(0.0, 0.0), B])
        np.testing.assert_array_equal(rod, [C, B])
        np.testing.assert_array_equal(slider, [C])
        assert np.hypot(*np.subtract(B, C)) == pytest.approx(1.3, abs=0.006)
    assert len(figure.axes[0].texts) == 4  # three times and A


def test_each_joint_has_its_own_panels(table: pd.DataFrame) -> None:
    figure = drawings.forces(table)
    for joint, panels in (("B", (0, 1)), ("C", (2, 3))):
        for panel in panels:
            axes = figure.axes[panel]
            assert f"joint {joint}" in axes.get_title()
            curve = lines(figure, panel)[0][:, 1]
            expected = table[f"normal_force_{joint}"]
            above = expected > 10.0
            np.testing.assert_allclose(curve[above], expected[above])
            assert above.sum() > 100


def test_clearances_are_those_of_the_wing(table: pd.DataFrame) -> None:
    assert drawings.clearance(table, "B") == pytest.approx(0.0025, rel=1e-9)
    assert drawings.clearance(table, "C") == pytest.approx(0.002, rel=1e-9)


def test_animation_moves_from_rest_to_the_lock_and_stands_still(table: pd.DataFrame) -> None:
    root = ET.fromstring(drawings.animation(table))
    animations = root.findall(f".//{SVG}animate")
    assert {a.get("repeatCount") for a in animations} == {"indefinite"}
    assert len({a.get("dur") for a in animations}) == 1
    values = [np.array(a.get("values", "").split(";"), dtype=float) for a in animations]
    frames = FRAMES + STILL
    assert {len(v) for v in values} == {frames}
    for v in values:
        assert np.ptp(v) > 1.0
        np.testing.assert_array_equal(v[FRAMES - 1 :], v[-1])
    duration = float(animations[0].get("dur", "").removesuffix("s"))
    assert duration * (FRAMES - 1) / (frames - 1) == pytest.approx(
        12.0 * table["time"].iloc[-1], 1e-3
    )


def test_animated_crank_has_the_angle_of_the_motion(table: pd.DataFrame) -> None:
    root = ET.fromstring(drawings.animation(table))
    crank, rod = (e for e in root.findall(f"{SVG}line") if e.get("stroke-width") == "6")
    ends = {
        a.get("attributeName"): np.array(a.get("values", "").split(";"), dtype=float)
        for a in crank.findall(f"{SVG}animate")
    }
    x_A, y_A = float(crank.get("x1", "")), float(crank.get("y1", ""))
    angle = np.arctan2(y_A - ends["y2"], ends["x2"] - x_A)
    assert angle[0] == pytest.approx(0.0, abs=1e-3)
    assert angle[-1] == pytest.approx(table["theta_1"].iloc[-1], abs=1e-3)
    # C keeps its height
    assert [a.get("attributeName") for a in rod.findall(f"{SVG}animate")] == ["x1", "x2", "y2"]


def test_animated_journals_are_magnified_to_the_drawn_bearing(table: pd.DataFrame) -> None:
    root = ET.fromstring(drawings.animation(table))
    circles = root.findall(f"{SVG}circle")
    bearings = [c for c in circles if c.get("r") == f"{RADIUS:g}"]
    journals = [c for c in circles if c.find(f"{SVG}animate") is not None]
    assert len(bearings) == len(journals) == 2
    for bearing, journal in zip(bearings, journals, strict=True):
        x, y = (
            np.array(a.get("values", "").split(";"), dtype=float)
            for a in journal.findall(f"{SVG}animate")
        )
        centre = float(bearing.get("cx", "")), float(bearing.get("cy", ""))
        assert (x[0], y[0]) == pytest.approx(centre, abs=0.01)
        assert RADIUS < np.hypot(x - centre[0], y - centre[1]).max() < 1.2 * RADIUS
    text = "".join(root.itertext())
    assert "clearance 2.5 mm" in text
    assert "clearance 2 mm" in text


def test_animation_is_one_file_without_script_or_links(table: pd.DataFrame) -> None:
    picture = drawings.animation(table)
    assert "<script" not in picture
    assert "href" not in picture
    assert len(picture) < 100_000
