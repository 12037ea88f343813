"""Files appear whole or not at all, and nobody can foresee or plant what they are written to."""

import errno
import os
import stat
import sys
from pathlib import Path

import pytest

from uqfold.writing import check_writable, replacing, write_text


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_text(path, "öld\r\n")
    assert path.read_bytes() == "öld\r\n".encode()

    def interrupted() -> None:
        with replacing(path) as stream:
            stream.write(b"half")
            assert path.read_bytes() == "öld\r\n".encode()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == "öld\r\n".encode()
    assert os.listdir(tmp_path) == ["table.csv"]


def test_temporary_names_cannot_be_foreseen_and_follow_no_link(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A planted link leads nowhere, even when its name is guessed."""
    (tmp_path / "kept.txt").write_text("kept")
    names = ["guessed", "guessed", "new"]
    monkeypatch.setattr("uqfold.writing.secrets.token_hex", lambda n: names.pop(0))
    (tmp_path / ".guessed.csv").symlink_to(tmp_path / "kept.txt")
    write_text(tmp_path / "table.csv", "text")
    assert names == []
    assert (tmp_path / "kept.txt").read_text() == "kept"
    assert (tmp_path / ".guessed.csv").is_symlink()
    assert (tmp_path / "table.csv").read_text() == "text"
    monkeypatch.undo()
    seen = set()
    for _ in range(20):
        with replacing(tmp_path / "table.csv"):
            seen |= set(os.listdir(tmp_path))
    assert len(seen) == 20 + 3


def test_a_link_in_the_place_of_the_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "kept.txt").write_text("kept")
    (tmp_path / "table.csv").symlink_to(tmp_path / "kept.txt")
    write_text(tmp_path / "table.csv", "text")
    assert (tmp_path / "kept.txt").read_text() == "kept"
    assert not (tmp_path / "table.csv").is_symlink()


def test_errors_name_the_file_that_was_asked_for(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    for path in (tmp_path / "file" / "x", tmp_path / "none" / "x", tmp_path / "folder"):
        with pytest.raises(OSError, match=r".") as raised:
            write_text(path, "text")
        assert raised.value.filename == str(path)
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]
    # what somebody else has against another file stays his
    with pytest.raises(FileNotFoundError) as other, replacing(tmp_path / "new"):
        (tmp_path / "folder" / "other").read_text()
    assert other.value.filename == str(tmp_path / "folder" / "other")


@pytest.mark.skipif(sys.platform != "linux", reason="/dev/full")
def test_a_device_is_written_to_and_stays_one() -> None:
    """Full disk: the error names the place, and no device is replaced by a file."""
    with pytest.raises(OSError, match="No space left") as raised:
        write_text("/dev/full", "text")
    assert (raised.value.errno, raised.value.filename) == (errno.ENOSPC, "/dev/full")
    assert stat.S_ISCHR(os.stat("/dev/full").st_mode)
    write_text("/dev/null", "text")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_a_folder_is_tried_before_work_is_spent(tmp_path: Path) -> None:
    check_writable(tmp_path / "new" / "folder")
    assert os.listdir(tmp_path / "new" / "folder") == []
    (tmp_path / "file").touch()
    for path in (tmp_path / "file", tmp_path / "file" / "x"):
        with pytest.raises(OSError, match=r"file") as raised:
            check_writable(path)
        assert raised.value.filename == str(path)
