"""A method of another package is found through its entry point, listed, and compared."""

import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar
from unittest.mock import patch

import pytest

from uqfold.cli import main
from uqfold.methods import ReliabilityMethod, Solution, Task, registry

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
GOOD = "half = plugin_half:Half"
COMPARE = """
import uqfold, uqfold.cli
frame = uqfold.compare(uqfold.problems.series(), ["half", "ffni-spa"], uqfold.criteria(2.0))
print(list(frame["label"]), frame["pf"][0])
uqfold.cli.main(["methods"])
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


@pytest.fixture
def run_here(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Iterator[Callable[..., "subprocess.CompletedProcess[str]"]]:
    """Run the program in this process, with the packages that are laid out in the folder."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def program(*words: str) -> "subprocess.CompletedProcess[str]":
        registry._found.cache_clear()
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            with pytest.raises(SystemExit) as ended:
                main(words)
        out, err = capsys.readouterr()
        said = "".join(f"{one.message}\n" for one in warned)
        return subprocess.CompletedProcess(words, int(ended.value.code or 0), out, said + err)

    yield program
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", None)).startswith(str(tmp_path)):
            del sys.modules[name]
    registry._found.cache_clear()


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
    done = run(environment, "-c", COMPARE)
    compared, _, listed = done.stdout.partition("\n")
    assert compared == "['half', 'ffni-spa'] 0.5", done.stderr
    assert "half" in listed
    assert "always one half" in listed


UNSET = MODULE.replace(
    "class Half(ReliabilityMethod):", "class Half(ReliabilityMethod):\n    n: int"
)
FAILING = f"{MODULE}\n    def __init__(self):\n        raise OSError('no licence')\n"
BROKEN = {
    "missing": ("import no_such_package", "ModuleNotFoundError: No module named 'no_such_package'"),
    "exiting": ("raise SystemExit(3)", "raised SystemExit: 3"),
    "odd": ("raise BaseException('odd')", "raised BaseException: odd"),
    "misspelt": ("def Half(: pass", "raised SyntaxError"),
    "empty": ("", "raised AttributeError"),
    "function": ("from dataclasses import dataclass as Half", "is not a ReliabilityMethod"),
    "abstract": ("from uqfold.methods import ReliabilityMethod as Half", "raised TypeError"),
    "unset": (UNSET, "raised TypeError"),
    "failing": (FAILING, "raised OSError: no licence"),
}
"""Name of a method and of its module -> source, and what is said about it."""


def test_broken_plug_ins_are_named_and_the_other_methods_go_on(
    tmp_path: Path, run_here: Any
) -> None:
    """A plug-in with a broken import takes no method down."""
    entries = [f"{name} = {name}:Half" for name in BROKEN]
    install(tmp_path, "nowhere", "\n".join(["nowhere:Half", *entries, GOOD]))
    for name, (code, _) in BROKEN.items():
        (tmp_path / f"{name}.py").write_text(code)
    listed = run_here("methods")
    assert listed.returncode == 0
    names = {line.split()[0] for line in listed.stdout.splitlines()}
    assert {"half", "ffni-spa", "openturns-mc"} <= names
    assert names.isdisjoint({"nowhere", *BROKEN})
    said = {line.split("'")[1]: line for line in listed.stderr.splitlines() if "left out" in line}
    for name, (_, message) in BROKEN.items():
        assert f"the method {name!r} is left out: {name}:Half " in said[name]
        assert message in said[name]
        assert said[name].endswith(". Update or remove the package plugin-half")
    assert "ModuleNotFoundError" in said["nowhere"]
    asked = run_here("compare", "series", "--method", "exiting")
    assert asked.returncode == 2
    message = "the method 'exiting' is not available: exiting:Half raised SystemExit: 3"
    assert message in " ".join(asked.stderr.split())
    assert "Traceback" not in asked.stderr


def test_a_built_in_method_keeps_its_name(tmp_path: Path, run_here: Any) -> None:
    install(tmp_path, "mc", "plugin_half:Half")
    listed = run_here("methods")
    assert (listed.returncode, "always one half" in listed.stdout) == (0, False)
    assert "the method 'mc' is left out: plugin_half:Half has the name of another" in listed.stderr


def test_of_two_plug_ins_with_one_name_one_is_left_out(tmp_path: Path, run_here: Any) -> None:
    install(tmp_path, "half", "plugin_half:Half")
    other = tmp_path / "other-1.0.dist-info"
    other.mkdir()
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (other / "entry_points.txt").write_text("[uqfold.methods]\nhalf = plugin_half:Half\n")
    listed = run_here("methods")
    assert listed.returncode == 0
    assert listed.stdout.count("always one half") == 1
    assert "the method 'half' is left out" in listed.stderr


def test_an_entry_that_nobody_can_read_is_named_with_its_package(
    tmp_path: Path, run_here: Any
) -> None:
    """An entry called "=x" has no name of its own."""
    install(tmp_path, "=x", "plugin_half:Half")
    listed = run_here("methods")
    assert (listed.returncode, "Traceback" in listed.stderr) == (0, False)
    told = "is left out: x = plugin_half:Half is not module:class. Update or remove the package "
    assert f"{told}plugin-half" in listed.stderr


def test_a_plug_in_that_fails_later_is_named() -> None:
    @dataclass(frozen=True)
    class Expired(ReliabilityMethod):
        title: ClassVar[str] = "expired"

        def __post_init__(self) -> None:
            raise OSError("no licence")

        def _solve(self, task: Task) -> Solution:
            raise NotImplementedError

    methods, _ = registry._found()
    with (
        patch.object(registry, "_found", lambda: ({**methods, "expired": Expired}, {})),
        pytest.raises(ValueError, match=r"name = 'expired': .*OSError: no licence; update or rem"),
    ):
        registry.build("expired")
