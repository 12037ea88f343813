"""Drawing charts as SVG, complete without any script.

Elements are built as a tree and serialised, so that every text and attribute is escaped. Colours
and lines come from the page's style sheet through classes.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator

from uqfold.report.page.chart import DASHED, Axis, Band, Chart, Mark, Point, Series, Strip
from uqfold.report.page.frame import BOTTOM, RIGHT, Frame, frame_of, split_power
from uqfold.report.page.markers import marker_path
from uqfold.report.page.scales import Line, tick_texts

NAMESPACE = "http://www.w3.org/2000/svg"

ColorClass = Callable[[str], str]
"""Gives the class of a colour in the style sheet."""


def draw_chart(
    chart: Chart, identifier: str, color_class: ColorClass, *, alone: bool = False
) -> ET.Element:
    """Draw one chart.

    Parameters
    ----------
    chart
        What to draw.
    identifier
        Unique in the document.
    color_class
        Gives the class of each key's colour.
    alone
        Whether it has the width of the page to itself.
    """
    frame = frame_of(chart, alone=alone)
    width, height = frame.right + RIGHT, frame.bottom + BOTTOM
    svg = ET.Element(
        "svg",
        {
            "xmlns": NAMESPACE,
            "viewBox": f"0 0 {width:g} {height:g}",
            "class": "chart",
            "role": "img",
            "aria-label": description(chart),
        },
    )
    clip = ET.SubElement(ET.SubElement(svg, "defs"), "clipPath", {"id": f"{identifier}-clip"})
    edge = 5.0
    box = (frame.left - edge, frame.top - edge, frame.right + edge, frame.bottom + edge)
    ET.SubElement(clip, "rect", _rectangle(*box))
    for band in chart.bands:
        _draw_band(svg, frame, band)
    _draw_axes(svg, frame, chart)
    inside = ET.SubElement(svg, "g", {"clip-path": f"url(#{identifier}-clip)"})
    for mark in chart.marks:
        _draw_mark(inside, frame, mark)
    for series in chart.series:
        _draw_series(inside, frame, series, chart.bars, color_class)
    return svg


def draw_strip(strip: Strip, text: str, color_class: ColorClass) -> ET.Element:
    """Draw numbers on one logarithmic line, for a cell of a table; `text` says the same."""
    width, height, edge = 150.0, 22.0, 8.0
    line = Line(*strip.ends, "log")
    attributes = {"viewBox": f"0 0 {width:g} {height:g}", "class": "strip", "role": "img"}
    svg = ET.Element("svg", {"xmlns": NAMESPACE, **attributes, "aria-label": text})

    def at(value: float) -> float:
        place = line.place(value)
        place = 0.0 if math.isnan(place) else min(max(place, 0.0), 1.0)
        return edge + place * (width - 2.0 * edge)

    middle = height / 2.0
    ET.SubElement(svg, "path", {"class": "rule", "d": f"M{edge} {middle}H{width - edge:g}"})
    for mark in strip.marks:
        ET.SubElement(svg, "path", {"class": "limit", "d": f"M{at(mark):.1f} 2V{height - 2:g}"})
    group = ET.SubElement(svg, "g", {"class": color_class(strip.key.color)})
    for value in strip.values:
        path = marker_path("o", at(value), middle, 5.0)
        ET.SubElement(group, "path", {"class": "dot", "d": path})
    if not math.isnan(strip.typical):
        path = marker_path(strip.key.marker, at(strip.typical), middle, 11.0)
        ET.SubElement(group, "path", {"class": "point", "d": path})
    return svg


def draw_swatch(color: str, marker: str, color_class: ColorClass) -> ET.Element:
    """Draw a marker in its colour, for legends and tables; decoration beside its name."""
    svg = ET.Element(
        "svg",
        {"xmlns": NAMESPACE, "viewBox": "0 0 14 14", "class": "swatch", "aria-hidden": "true"},
    )
    if marker == DASHED:
        group = ET.SubElement(svg, "g", {"class": "dashed"})
        ET.SubElement(group, "path", {"class": "line", "d": "M0 7H14"})
        return svg
    group = ET.SubElement(svg, "g", {"class": color_class(color)})
    ET.SubElement(group, "path", {"class": "point", "d": marker_path(marker, 7.0, 7.0, 9.0)})
    return svg


def svg_text(element: ET.Element) -> str:
    """Serialise a drawing."""
    return ET.tostring(element, encoding="unicode")


def description(chart: Chart) -> str:
    """Say in words what a chart shows, for those who do not see it."""
    said = [chart.title]
    for axis, name in ((chart.x, "Horizontal"), (chart.y, "Vertical")):
        kind = ", logarithmic" if axis.scale == "log" else ""
        if axis.categories:
            said.append(f"{name}: {', '.join(axis.categories)}")
        else:
            said.append(f"{name} axis: {axis.name}{kind}")
    named = [series.key.label for series in chart.series if series.points]
    said.append(f"Drawn: {', '.join(dict.fromkeys(named))}" if named else "Nothing is drawn")
    return ". ".join(said) + "."


def _draw_axes(svg: ET.Element, frame: Frame, chart: Chart) -> None:
    grid = ET.SubElement(svg, "g", {"class": "grid"})
    texts = ET.SubElement(svg, "g", {"class": "axis", "aria-hidden": "true"})
    for value, label in _ticks(frame.x, chart.x):
        x = frame.at_x(value)
        ET.SubElement(grid, "path", {"d": f"M{x:.1f} {frame.top:g}V{frame.bottom:g}"})
        _text(texts, x, frame.bottom + 16.0, label, "middle")
    if chart.y.categories:
        for i, name in enumerate(chart.y.categories):
            y = frame.at_y(float(i))
            ET.SubElement(grid, "path", {"d": f"M{frame.left:g} {y:.1f}H{frame.right:g}"})
            _text(texts, frame.left - 10.0, y + 4.0, name, "end")
    else:
        for value, label in _ticks(frame.y, chart.y):
            y = frame.at_y(value)
            ET.SubElement(grid, "path", {"d": f"M{frame.left:g} {y:.1f}H{frame.right:g}"})
            _text(texts, frame.left - 7.0, y + 4.0, label, "end")
        _text(texts, 0.0, 12.0, chart.y.name, "start", "name")
    _text(texts, frame.right, frame.bottom + 34.0, chart.x.name, "end", "name")
    ET.SubElement(
        svg, "path", {"class": "base", "d": f"M{frame.left:g} {frame.bottom:g}H{frame.right:g}"}
    )


def _ticks(line: Line, axis: Axis) -> Iterator[tuple[float, str]]:
    ticks = line.ticks()
    yield from zip(ticks, tick_texts(ticks, percent=axis.percent), strict=True)


def _text(
    parent: ET.Element, x: float, y: float, text: str, anchor: str, style: str = ""
) -> ET.Element:
    attributes = {"x": f"{x:.1f}", "y": f"{y:.1f}", "text-anchor": anchor}
    element = ET.SubElement(parent, "text", {**attributes, **({"class": style} if style else {})})
    power = split_power(text)
    if power is None or style:
        element.text = text
    else:
        element.text = power[0]
        raised = ET.SubElement(element, "tspan", {"dy": "-5", "class": "power"})
        raised.text = power[1]
        if power[2]:
            ET.SubElement(element, "tspan", {"dy": "5"}).text = power[2]
    return element


def _draw_band(svg: ET.Element, frame: Frame, band: Band) -> None:
    first, last = sorted(frame.spread(band.side, band.low, band.high))
    style = {"class": "stripe faint" if band.faint else "stripe"}
    if band.side == "x":
        first, last = max(first, frame.left), min(last, frame.right)
        ET.SubElement(svg, "rect", {**style, **_rectangle(first, frame.top, last, frame.bottom)})
    else:
        first, last = max(first, frame.top), min(last, frame.bottom)
        ET.SubElement(svg, "rect", {**style, **_rectangle(frame.left, first, frame.right, last)})


def _rectangle(x1: float, y1: float, x2: float, y2: float) -> dict[str, str]:
    width, height = max(x2 - x1, 0.0), max(y2 - y1, 0.0)
    return {"x": f"{x1:.1f}", "y": f"{y1:.1f}", "width": f"{width:.1f}", "height": f"{height:.1f}"}


def _draw_mark(parent: ET.Element, frame: Frame, mark: Mark) -> None:
    group = ET.SubElement(parent, "g", {"class": "mark"})
    if mark.side == "x":
        x = frame.at_x(mark.at)
        ET.SubElement(group, "path", {"d": f"M{x:.1f} {frame.top:g}V{frame.bottom:g}"})
        _text(group, x + 5.0, frame.top + 11.0, mark.label, "start", "name")
    else:
        y = frame.at_y(mark.at)
        ET.SubElement(group, "path", {"d": f"M{frame.left:g} {y:.1f}H{frame.right:g}"})
        _text(group, frame.right - 4.0, y - 5.0, mark.label, "end", "name")


def _draw_series(
    parent: ET.Element, frame: Frame, series: Series, bars: str, color_class: ColorClass
) -> None:
    style = "series dashed" if series.dashed else "series"
    group = ET.SubElement(
        parent,
        "g",
        {
            "class": f"{style} {color_class(series.key.color)}".strip(),
            "data-key": series.key.name,
            "data-label": series.key.label,
        },
    )
    if series.band:
        _draw_area(group, frame, series)
    if series.joined:
        for run in _runs(series.points):
            path = "L".join(f"{frame.at_x(p.x):.2f} {frame.at_y(p.y):.2f}" for p in run)
            ET.SubElement(group, "path", {"class": "line", "d": f"M{path}"})
    for point in series.points:
        if not series.band:
            _draw_bar(group, frame, point, bars)
        if series.size and _shown(point):
            x, y = frame.at_x(point.x), frame.at_y(point.y)
            marker = ET.SubElement(
                group,
                "path",
                {
                    "class": "point hollow" if point.hollow else "point",
                    "d": marker_path(series.key.marker, x, y, series.size),
                    "data-at": f"{x:.1f} {y:.1f}",
                },
            )
            ET.SubElement(marker, "title").text = point.text


def _shown(point: Point) -> bool:
    return math.isfinite(point.x) and math.isfinite(point.y)


def _runs(points: tuple[Point, ...]) -> Iterator[list[Point]]:
    """Give the runs of points between gaps."""
    run: list[Point] = []
    for point in points:
        if _shown(point):
            run.append(point)
        elif run:
            yield run
            run = []
    if run:
        yield run


def _draw_area(group: ET.Element, frame: Frame, series: Series) -> None:
    known = [p for p in series.points if math.isfinite(p.low) and math.isfinite(p.high)]
    if not known:
        return
    ends = [frame.spread("y", point.low, point.high) for point in known]
    there = [f"{frame.at_x(p.x):.2f} {end[1]:.2f}" for p, end in zip(known, ends, strict=True)]
    back = [f"{frame.at_x(p.x):.2f} {end[0]:.2f}" for p, end in zip(known, ends, strict=True)]
    path = "M" + "L".join([*there, *reversed(back)]) + "z"
    ET.SubElement(group, "path", {"class": "area", "d": path})


def _draw_bar(group: ET.Element, frame: Frame, point: Point, bars: str) -> None:
    """Draw the error bar of a point, or the arrow of an upper bound without a point."""
    if math.isnan(point.high):
        return
    along, across = (point.x, point.y) if bars == "x" else (point.y, point.x)
    if math.isnan(across):
        return
    low, high = frame.spread(bars, point.low, point.high)
    cap = 3.5
    if math.isnan(along):
        # an arrow from the bound towards zero, wherever that may be
        tip = high + (-16.0 if bars == "x" else 16.0)
        barb = tip + (5.0 if bars == "x" else -5.0)
        style, low, ends = "bar bound", tip, ((high, cap, 0.0), (barb, cap, tip - barb))
    else:
        style, ends = "bar", ((low, cap, 0.0), (high, cap, 0.0))
    if bars == "x":
        y = frame.at_y(point.y)
        drawn = f"M{low:.2f} {y:.2f}H{high:.2f}"
        for at, half, slope in ends:
            drawn += f"M{at:.2f} {y - half:.2f}l{slope:.2f} {half:.2f}l{-slope:.2f} {half:.2f}"
        place = f"{high:.1f} {y:.1f}"
    else:
        x = frame.at_x(point.x)
        drawn = f"M{x:.2f} {low:.2f}V{high:.2f}"
        for at, half, slope in ends:
            drawn += f"M{x - half:.2f} {at:.2f}l{half:.2f} {slope:.2f}l{half:.2f} {-slope:.2f}"
        place = f"{x:.1f} {high:.1f}"
    bar = ET.SubElement(group, "path", {"class": style, "d": drawn})
    if math.isnan(along):
        bar.set("data-at", place)
        ET.SubElement(bar, "title").text = point.text
