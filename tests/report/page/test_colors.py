"""Colours that can be told from the paper."""

import pytest

from uqfold.methods import available
from uqfold.plots.style import method_styles
from uqfold.report.page.colors import (
    DARK_PAPER,
    LEAST_CONTRAST,
    LIGHT_PAPER,
    by_day,
    by_night,
    contrast,
)


def channels(color: str) -> tuple[float, ...]:
    return tuple(int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5))


@pytest.mark.parametrize("paper", [LIGHT_PAPER, DARK_PAPER])
def test_fifteen_methods_can_be_told_from_the_paper_and_from_the_others(paper: str) -> None:
    labels = [*available(), *"abcdef"][:15]
    seen = by_day if paper == LIGHT_PAPER else by_night
    shown = [seen(style.color) for style in method_styles(labels).values()]
    assert len(set(shown)) == len(labels)
    for color in shown:
        assert contrast(channels(color), channels(paper)) >= LEAST_CONTRAST - 0.05


def test_dark_and_light_change_places_by_night() -> None:
    assert by_night("#ffffff") == DARK_PAPER
    assert contrast(channels(by_night("#000000")), channels(DARK_PAPER)) > 12.0
    # areas and grids stay behind what is drawn on them
    for pale in ("#d9d9d9", "#e6e6e6"):
        assert by_day(pale) == pale
        assert contrast(channels(by_night(pale)), channels(DARK_PAPER)) < 2.0


def test_black_and_white_are_as_far_apart_as_can_be() -> None:
    assert contrast((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)) == pytest.approx(21.0)
