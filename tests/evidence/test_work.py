from pathlib import Path

import pytest

from uqfold.evidence.work import Work


def test_the_tier_chooses() -> None:
    assert [Work(tier).pick(1, 2, 3) for tier in ("quick", "default", "full")] == [1, 2, 3]


def test_finished_parts_outlive_an_interruption(tmp_path: Path) -> None:
    made: list[str] = []

    def part(name: str, *, stop: bool = False) -> dict[str, list[float]]:
        if stop:
            raise KeyboardInterrupt
        made.append(name)
        return {name: [1.5, float("inf")]}

    told: list[tuple[int, int | None]] = []
    work = Work("full", kept=tmp_path, progress=lambda done, total: told.append((done, total)))
    with pytest.raises(KeyboardInterrupt):
        work.parts({"a": lambda: part("a"), "b": lambda: part("b", stop=True)})
    found = work.parts({"a": lambda: part("a"), "b": lambda: part("b")})
    assert made == ["a", "b"]
    # what an interrupted run spent on a part is not forgotten
    assert len(work.saved) == 1
    assert work.saved[0] >= 0.0
    assert found == {"a": {"a": [1.5, float("inf")]}, "b": {"b": [1.5, float("inf")]}}
    assert told == [(0, 2), (1, 2), (0, 2), (1, 2), (2, 2)]


def test_a_damaged_part_is_computed_again(tmp_path: Path) -> None:
    work = Work("full", kept=tmp_path)
    work.parts({"a": lambda: 1})
    (path,) = tmp_path.iterdir()
    path.write_text("{", encoding="utf-8")
    assert work.parts({"a": lambda: 2}) == {"a": 2}


def test_nothing_is_kept_without_a_folder() -> None:
    counts = iter((1, 2))
    work = Work()
    assert [work.parts({"a": lambda: next(counts)})["a"] for _ in range(2)] == [1, 2]
