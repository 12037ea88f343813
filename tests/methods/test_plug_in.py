"""A method of another package is found through its entry point, listed, and compared."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

MODULE = """
from dataclasses import dataclass
from typing import ClassVar

from uqfold.methods import Estimate, ReliabilityMethod, Solution


@dataclass(frozen=True)
class Half(ReliabilityMethod):
    name: ClassVar[str] = "half"
    title: ClassVar[str] = "always one half"

    def _solve(self, task):
        return Solution([Estimate(0.5)] * len(task.criteria))
"""
COMPARE = """
import uqfold
frame = uqfold.compare(uqfold.problems.series(), ["half", "ffni-spa"], uqfold.criteria(2.0))
print(list(frame["label"]), frame["pf"][0])
"""


def install(folder: Path, name: str, value: str) -> dict[str, str]:
    """Lay a package out as an installer would, and give the environment that sees it."""
    (folder / "plugin_half.py").write_text(MODULE)
    info = folder / "plugin_half-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: plugin-half\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[uqfold.methods]\n{name} = {value}\n")
    path = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
    return {**os.environ, "PYTHONPATH": path}


def run(environment: dict[str, str], *words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, *words],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=Path(__file__).parents[2],
        timeout=60,
    )


def test_registered_method_is_listed_and_compared(tmp_path: Path) -> None:
    environment = install(tmp_path, "half", "plugin_half:Half")
    listed = run(environment, "-m", "uqfold", "methods")
    assert "half" in listed.stdout
    assert "always one half" in listed.stdout
    compared = run(environment, "-c", COMPARE)
    assert compared.stdout == "['half', 'ffni-spa'] 0.5\n", compared.stderr


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("mc", "plugin_half:Half", "two methods are named 'mc'"),
        ("half", "plugin_half:dataclass", "is no ReliabilityMethod"),
    ],
)
def test_wrong_entry_is_refused(tmp_path: Path, name: str, value: str, message: str) -> None:
    environment = install(tmp_path, name, value)
    done = run(environment, "-c", "import uqfold; uqfold.methods.available()")
    assert done.returncode != 0
    assert message in done.stderr
