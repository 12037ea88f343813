"""Every study of ours: its committed results are what a fresh reduced run gives."""

from pathlib import Path

import pytest

from uqfold.cli import main

STUDIES = Path(__file__).parents[2] / "studies"
FOLDERS = sorted(path.parent for path in STUDIES.glob("*/study.toml"))


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_committed_results_are_reproduced(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # a store of its own: nothing that an earlier run left is taken for a fresh result
    with pytest.raises(SystemExit) as exited:
        main(["study", "check", str(folder), "--store", str(tmp_path)])
    assert exited.value.code == 0, capsys.readouterr().out


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_files_are_complete(folder: Path) -> None:
    assert (folder / "README.md").is_file()
    report = (folder / "report.md").read_text(encoding="utf-8")
    for figure in folder.glob("figures/*.png"):
        assert f"figures/{figure.name}" in report
        assert figure.with_suffix(".svg").is_file()
