"""Where the compiled code is kept."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import uqfold

pytestmark = pytest.mark.thorough

PROGRAM = """
import warnings
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    from uqfold.mechanism import deployment, ideal, stiff
    from uqfold.mechanism.compiled import entry_point
    from extra import twice
    for kernel in (deployment.deploy_lanes, deployment.deploy_rows, ideal._deploy):
        assert kernel.signatures == []
    print(entry_point(twice)(21.0))
for one in caught:
    print(one.category.__name__, one.message)
"""


def run(tmp_path, **environment):
    """Run the program with a copy of the mechanism that no folder is writable for."""
    room = tmp_path / "uqfold"
    shutil.copytree(
        Path(uqfold.__file__).parent / "mechanism",
        room / "mechanism",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    for name in ("__init__.py", "lazy.py", "typing.py"):
        shutil.copy(Path(uqfold.__file__).parent / name, room)
    (tmp_path / "extra.py").write_text("def twice(x):\n    return 2.0 * x\n")
    for folder in (room / "mechanism", tmp_path):
        (folder / "__pycache__").write_text("a file where numba wants a folder")
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    home = str(tmp_path / "extra.py")
    places = {"HOME": home, "XDG_CACHE_HOME": home, "LOCALAPPDATA": home}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**kept, **places, "PYTHONPATH": str(tmp_path), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_no_writable_place_for_the_compiled_code_compiles_without_one_and_says_so_once(tmp_path):
    value, *warnings = run(tmp_path)
    assert value == "42.0"
    [warning] = warnings
    assert warning.startswith("RuntimeWarning the wing's compiled code cannot be kept")
    assert warning.endswith("Set NUMBA_CACHE_DIR to a folder that is")


def test_a_folder_for_compiled_code_is_taken_where_the_usual_ones_are_not_writable(tmp_path):
    assert run(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "kernels")) == ["42.0"]
    assert list((tmp_path / "kernels").rglob("extra.twice*.nbi"))
