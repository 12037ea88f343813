import pytest

from uqfold.validation import Work


def test_the_tier_chooses() -> None:
    assert [Work(tier).pick(1, 2) for tier in ("quick", "full")] == [1, 2]


def test_every_finished_part_is_told() -> None:
    told: list[tuple[int, int | None]] = []
    work = Work("full", progress=lambda done, total: told.append((done, total)))
    assert work.parts({"a": lambda: 1.5, "b": lambda: 2.5}) == {"a": 1.5, "b": 2.5}
    assert told == [(0, 2), (1, 2), (2, 2)]


def test_an_interruption_ends_the_work() -> None:
    def interrupted() -> float:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Work().parts({"a": interrupted})
