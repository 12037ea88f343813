"""Draw the house into ``docs/design.md``: rooms, what they hold, and what they import.

    python docs/house.py           # draw it anew
    python docs/house.py --check   # exit 1 if the drawing is not the present one

Rooms and arrows are read from the import statements, for types only and within functions too; what
a room holds is the first sentence of its docstring. Arrows that follow from others are left out.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "uqfold"
PAGE = ROOT / "docs" / "design.md"
BEGIN, END = "<!-- drawn by python docs/house.py -->", "<!-- end of the drawing -->"

Arrows = dict[str, set[str]]


def arrows(package: Path) -> Arrows:
    """Return room -> rooms that it imports; a module of the package itself is a room too."""
    modules = [path for path in package.glob("*.py") if not path.stem.startswith("__")]
    folders = [path.parent for path in package.glob("*/__init__.py")]
    files = {path.stem: [path] for path in modules}
    files |= {folder.name: sorted(folder.rglob("*.py*")) for folder in folders}
    sources = {
        room: [path for path in paths if path.suffix in (".py", ".pyi")]
        for room, paths in files.items()
    }
    return {
        room: {one for path in paths for one in imported(path) if one in files} - {room}
        for room, paths in sources.items()
    }


def imported(path: Path) -> Iterator[str]:
    """Yield the rooms that a file imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        yield from (name.split(".")[1] for name in names if name.startswith("uqfold."))


def reached(room: str, found: Arrows) -> set[str]:
    """Return all rooms that a room stands on, directly or not."""
    below, waiting = set[str](), [room]
    while waiting:
        new = found[waiting.pop()] - below
        below |= new
        waiting += new
    return below


def drawing(package: Path) -> str:
    """Return the drawing as Markdown."""
    found = arrows(package)
    below = {room: reached(room, found) for room in found}
    circles = [room for room in found if room in below[room]]
    if circles:
        raise SystemExit(f"rooms that import each other: {', '.join(sorted(circles))}")
    order = sorted(found, key=lambda room: (-len(below[room]), room))
    rooms = [room for room in order if (package / room).is_dir()]
    width = max(map(len, rooms))
    lines = ["```text"]
    for room in rooms:
        direct = {one for one in found[room] if one in rooms}
        implied = {two for one in direct for two in below[one]}
        onto = [one for one in rooms if one in direct - implied]
        lines.append(f"{room:<{width}}  ->  {', '.join(onto)}" if onto else room)
    lines += ["```", "", "| room | holds |", "| --- | --- |"]
    lines += [f"| `{room}` | {held(package / room / '__init__.py')} |" for room in rooms]
    single = [one for one in order if one not in rooms]
    lines += ["", "Below them, each a single module:", ""]
    lines += [f"- `{one}`: {held(package / f'{one}.py')}" for one in single]
    return "\n".join(lines)


def held(path: Path) -> str:
    """Return the first sentence of a module's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.partition("\n\n")[0].split()).replace("|", "\\|")


def page(text: str) -> str:
    """Return a page with the present drawing in it."""
    pattern = re.compile(f"(?<={re.escape(BEGIN)}\n).*?(?={re.escape(END)})", re.DOTALL)
    return pattern.sub(lambda _: f"{drawing(PACKAGE)}\n", text)


def main(words: list[str]) -> int:
    """Draw, or check."""
    text = PAGE.read_text(encoding="utf-8")
    current = page(text)
    if words == ["--check"]:
        return int(text != current)
    PAGE.write_text(current, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
