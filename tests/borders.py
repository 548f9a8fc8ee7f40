"""What is imported over which border: names, by AST, of the core by the wings, of the package by its harness and tests.

python -m tests.borders                 # a table, and the places that the declared waist does not have
python -m tests.borders --json          # the same for programs
python -m tests.borders --root FOLDER   # another checkout

The waist is what docs/architecture.md lists; `tests/test_layers.py` holds the code against it.
"""

from __future__ import annotations

import argparse
import ast
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
# Folders and modules of `symofros`; the rest of it opens doors: __init__, tools, harness, pytest_plugin.
CORE = frozenset("errors base native expr description mechanics generator runtime compiler loading".split())
WINGS = ("simulation", "exports", "interop", "diagrams", "blocks", "studio", "commands")
# Whose command line it is: `__main__` is a module of `commands` by another place.
_BY_ANOTHER_PLACE = {"__main__": "commands"}


class Taken(NamedTuple):
    """A name that a file imports.

    Attributes:
        user: Module that imports.
        module: Module that it imports from, or imports whole and reads.
        name: Name; empty of a module that is imported whole and handed on.
    """

    user: str
    module: str
    name: str


@cache
def import_statements(path: Path) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Import statements of a file, within functions, too; found once for all rules."""
    return tuple(
        node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Import | ast.ImportFrom)
    )


def absolute(path: Path, node: ast.ImportFrom, root: Path = ROOT) -> str:
    """The module that a statement of a file imports from, in a checkout."""
    package = path.relative_to(root).parent.parts
    above = package[: len(package) + 1 - node.level] if node.level else ()
    return ".".join([*above, *filter(None, [node.module])])


def modules_of(root: Path, *packages: str) -> dict[str, Path]:
    """Module -> file, of some packages."""
    files = [path for package in packages for path in sorted((root / package).rglob("*.py"))]
    dotted = {".".join(path.relative_to(root).with_suffix("").parts): path for path in files}
    return {name.removesuffix(".__init__"): path for name, path in dotted.items()}


@cache
def names_offered(path: Path) -> frozenset[str]:
    """Names that the `__init__` of a package imports for others."""
    return frozenset(alias.asname for node in import_statements(path) for alias in node.names if alias.asname)


def taken(root: Path, user: str, path: Path, known: Mapping[str, Path]) -> Iterator[Taken]:
    """Names that a module imports of known ones, and what it reads of those that it imports whole (`sf.load`)."""
    whole: dict[str, str] = {}
    for node in import_statements(path):
        if isinstance(node, ast.Import):
            whole |= {alias.asname or alias.name: alias.name for alias in node.names if alias.name in known}
            continue
        module = absolute(path, node, root)
        for alias in node.names if module in known else ():
            if f"{module}.{alias.name}" in known and alias.name not in names_offered(known[module]):
                whole[alias.asname or alias.name] = f"{module}.{alias.name}"
            else:
                yield Taken(user, module, alias.name)
    reads = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)] if whole else []
    read = [(whole[x.value.id], x.attr) for x in reads if isinstance(x.value, ast.Name) and x.value.id in whole]
    unread = set(whole.values()) - {module for module, _ in read} - {"symofros"}
    yield from (Taken(user, *item) for item in (*read, *((module, "") for module in sorted(unread))))


def part(module: str) -> str:
    """Folder or single module of the package that a module belongs to; "" of `symofros` itself."""
    own = (module.split(".") + [""])[1]
    return _BY_ANOTHER_PLACE.get(own, own)


def names_taken(root: Path, users: dict[str, Path]) -> list[Taken]:
    """All that some modules import of `symofros`."""
    known = modules_of(root, "symofros")
    return [item for user, path in users.items() for item in taken(root, user, path, known)]


def over_the_waist(root: Path = ROOT) -> list[Taken]:
    """What the wings import of the core."""
    users = {name: path for name, path in modules_of(root, "symofros").items() if part(name) in WINGS}
    return [item for item in names_taken(root, users) if part(item.module) in CORE]


def listed(heading: str, root: Path = ROOT) -> dict[str, str]:
    """Module -> what it offers: the table under a heading of the map."""
    text = (root / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = re.search(rf"^## {re.escape(heading)}\n((?:(?!^## ).*\n)*)", text, re.MULTILINE)
    return dict(re.findall(r"^\| `([\w.]+)`.*? \| (.+?) \|", section[1] if section else "", re.MULTILINE))


def _counted(items: Iterable[Taken]) -> dict[str, int]:
    distinct = set(items := list(items))
    return {
        "modules": len({item.module for item in distinct}),
        "names": len({item[1:] for item in distinct}),
        "uses": len(items),
    }


def borders(root: Path) -> dict[str, dict[str, int]]:
    """Border -> how many modules, names and uses of names cross it."""
    package = modules_of(root, "symofros")
    items = names_taken(root, package)
    core = [item for item in items if part(item.user) in WINGS and part(item.module) in CORE]
    found = {"wings -> core": _counted(core)}
    found |= {f"  {wing} -> core": _counted(i for i in core if part(i.user) == wing) for wing in WINGS}
    between = [item for item in items if {part(item.user), part(item.module)} <= {*WINGS}]
    between = [item for item in between if part(item.user) != part(item.module)]
    found["wing -> wing"] = _counted(between)
    for user, module in sorted({(part(item.user), part(item.module)) for item in between}):
        pair = [item for item in between if (part(item.user), part(item.module)) == (user, module)]
        found[f"  {user} -> {module}"] = _counted(pair)
    harness = names_taken(root, modules_of(root, "validation"))
    found["validation -> symofros"] = _counted(harness)
    found["  beside `symofros` itself"] = _counted(i for i in harness if i.module != "symofros")
    doors = {"", "tools", "harness", "pytest_plugin"}
    inside = [item for item in names_taken(root, modules_of(root, "tests")) if part(item.module) not in doors]
    return found | {"tests -> internal modules": _counted(inside)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.add_argument("--root", type=Path, default=ROOT, help="the checkout that is read")
    given = parser.parse_args()
    found, waist = borders(given.root), listed("The waist", given.root)
    beside = sorted({item.module for item in over_the_waist(given.root)} - {f"symofros.{name}" for name in waist})
    if given.json:
        print(json.dumps({"borders": found, "waist": list(waist), "beside": beside}, indent=2))
        return
    print(f"{'border':42} {'modules':>8} {'names':>8} {'uses':>8}")
    for border, counts in found.items():
        print(f"{border:42} {counts['modules']:8} {counts['names']:8} {counts['uses']:8}")
    print(f"declared waist: {len(waist)} modules; beside it: {len(beside)}", *beside, sep="\n  ")


if __name__ == "__main__":
    main()
