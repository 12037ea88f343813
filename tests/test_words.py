"""One word per idea: no two classes of one name, and docstrings that say what is returned."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = [
    path for room in ("uqfold", "studies", "validation") for path in (ROOT / room).rglob("*.py")
]


@pytest.fixture(scope="module")
def trees() -> dict[Path, ast.Module]:
    return {path: ast.parse(path.read_text(encoding="utf-8")) for path in FILES}


def named_types(tree: ast.Module) -> Iterator[str]:
    """Yield the public classes and type aliases of a module."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            name = node.name
        elif isinstance(node, ast.AnnAssign) and ast.unparse(node.annotation) == "TypeAlias":
            name = ast.unparse(node.target)
        else:
            continue
        if not name.startswith("_"):
            yield name


def test_no_two_classes_have_one_name(trees: dict[Path, ast.Module]) -> None:
    homes = defaultdict(list)
    for path, tree in trees.items():
        for name in named_types(tree):
            homes[name].append(path.relative_to(ROOT).as_posix())
    assert {name: paths for name, paths in homes.items() if len(paths) > 1} == {}


def test_docstrings_say_what_is_returned(trees: dict[Path, ast.Module]) -> None:
    """ "Give ..." is not what a function does that returns something, nor is "True." a sentence."""
    found = [
        f"{path.relative_to(ROOT)}: {said}"
        for path, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Module)
        and (said := ast.get_docstring(node) or "").startswith(
            ("Give ", "Gives ", "True.", "Those ")
        )
    ]
    assert found == []
