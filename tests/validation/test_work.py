from pathlib import Path

import pytest

from uqfold.validation import Work


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


def test_a_damaged_part_is_computed_again_with_a_warning(tmp_path: Path) -> None:
    work = Work("full", kept=tmp_path)
    work.parts({"a": lambda: 0.142})
    (path,) = tmp_path.iterdir()
    whole = path.read_bytes()
    assert b"0.142" in whole
    # one digit, cut off, empty, another kind of file, without its digest
    damaged = [whole.replace(b"0.142", b"0.842"), whole[:-5], b"", b"{", whole.split(b"\n")[1]]
    for content in damaged:
        path.write_bytes(content)
        with pytest.warns(UserWarning, match="is damaged, and left out"):
            assert work.parts({"a": lambda: 2.0}) == {"a": 2.0}
        assert work.parts({"a": lambda: 3.0}) == {"a": 2.0}
    # the part of another name
    work.parts({"b": lambda: 4.0})
    (other,) = set(tmp_path.iterdir()) - {path}
    other.rename(path)
    with pytest.warns(UserWarning, match="is damaged"):
        assert work.parts({"a": lambda: 5.0}) == {"a": 5.0}


def test_nothing_is_kept_without_a_folder() -> None:
    counts = iter((1, 2))
    work = Work()
    assert [work.parts({"a": lambda: next(counts)})["a"] for _ in range(2)] == [1, 2]
