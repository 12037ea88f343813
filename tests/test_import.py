"""Importing uqfold, or asking for help, loads nothing heavy; no modules import each other."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import uqfold

HEAVY = ("scipy.stats", "openturns", "chaospy", "sklearn", "pandas", "matplotlib", "numba")


def loaded(code: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys\nprint('\\n'.join(sys.modules))"],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return set(done.stdout.split())


def test_import_uqfold_loads_nothing_heavy() -> None:
    assert loaded("import uqfold").isdisjoint({*HEAVY, "numpy", "typer", "rich"})


def test_the_check_can_fail() -> None:
    assert "numba" in loaded("import uqfold, numba")


@pytest.mark.parametrize("words", [["--help"], ["compare", "--help"], ["--version"], ["compare"]])
def test_help_loads_nothing_heavy(words: list[str]) -> None:
    code = f"import uqfold.cli\ntry:\n    uqfold.cli.main({words})\nexcept SystemExit:\n    pass"
    assert loaded(code).isdisjoint({*HEAVY, "numpy", "scipy"})


# No circles between modules


def sources(top: Path) -> dict[str, Path]:
    """Module -> its file, for all in the folder `top` but in what begins with a dot, as .venv."""
    files = {path.relative_to(top).with_suffix(""): path for path in sorted(top.rglob("*.py"))}
    files = {
        part: path
        for part, path in files.items()
        if not any(name.startswith(".") for name in part.parts)
    }
    return {".".join(part.parts).removesuffix(".__init__"): path for part, path in files.items()}


def imported(path: Path) -> Iterator[tuple[str, str]]:
    """(module, name) of all that a file imports, for types only and inside functions too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            yield from ((str(node.module), alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)


def dependencies(top: Path) -> dict[str, set[str]]:
    """Module -> the modules that it imports; what a package hands on counts as its origin."""
    modules = sources(top)
    packages = {name for name, path in modules.items() if path.name == "__init__.py"}
    origin: dict[str, str] = {}
    for package in packages:
        stub = modules[package].with_suffix(".pyi")
        for path in [modules[package], *([stub] if stub.exists() else [])]:
            for module, name in imported(path):
                origin[f"{package}.{name}"] = module
    found: dict[str, set[str]] = {}
    for module, path in modules.items():
        found[module] = set()
        for home, name in imported(path):
            target = f"{home}.{name}"
            while target in origin and target not in modules:
                target = f"{origin[target]}.{name}"
            found[module].add(target if target in modules else target.rpartition(".")[0])
    return {
        name: {one for one in found[name] if one in modules and one not in packages | {name}}
        for name in modules
        if name not in packages
    }


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """A shortest way from a module back to itself, for each module that has one."""
    ways = []
    for start in sorted(graph):
        came_from: dict[str, str] = {}
        queue = [start]
        for module in queue:
            for one in sorted(graph[module] - came_from.keys()):
                came_from[one] = module
                queue.append(one)
        if start in came_from:
            way = [start, came_from[start]]
            while way[-1] != start:
                way.append(came_from[way[-1]])
            ways.append(way[::-1])
    return ways


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Circles between files are gone, also those of type-only and function-level imports."""
    found = circles(dependencies(Path(uqfold.__file__).parents[1]))
    assert [" -> ".join(way) for way in found] == []


def test_a_virtual_environment_in_the_project_is_no_part_of_it(tmp_path: Path) -> None:
    """README makes one there."""
    for folder in (".venv/lib/other", "house"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "__init__.py").write_text("")
    assert list(sources(tmp_path)) == ["house"]


@pytest.mark.parametrize(
    "back",
    [
        "from house.a import A",
        "import house.a",
        "def later():\n    from house.a import A",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from house.a import A",
        "from house import A",
        "from house import a",
    ],
)
def test_the_check_of_circles_can_fail(tmp_path: Path, back: str) -> None:
    house = tmp_path / "house"
    house.mkdir()
    (house / "__init__.py").write_text("from house.a import A")
    (house / "a.py").write_text("from house.b import B")
    (house / "b.py").write_text("from house.c import C")
    (house / "c.py").write_text("import numpy")
    assert circles(dependencies(tmp_path)) == []
    (house / "c.py").write_text(back)
    assert " -> ".join(circles(dependencies(tmp_path))[0]) == (
        "house.a -> house.b -> house.c -> house.a"
    )
