"""Names in kinematics and dynamics follow NOTATION.md: quantity, frames it is between, frame it is expressed in.

A linter over the syntax trees: every variable, parameter, attribute and label that begins like a monogram (`w_A...`,
`p_A...`) must be a whole one (`w_AB_B`, `p_AB`), and every class that keeps a bare quantity must state its frames here.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import symofros
from symofros.base.names import local_name

PACKAGE = Path(symofros.__file__).parent
NOTATION = (PACKAGE / "NOTATION.md").read_text(encoding="utf-8")
FOLDERS = ("spatial", "kinematics", "dynamics")

# Frames: NOTATION.md lists them. A point is the origin of a frame, or the mass centre of a body.
FRAME = "[WAKLBPDEFCST]"
POINT = f"{FRAME}(o|cm)"
MONOGRAM = re.compile(
    f"(p_{FRAME}({FRAME}|{POINT})|R_{FRAME}{FRAME}|(w|alpha)_{FRAME}{FRAME}_{FRAME}|(v|a)_{FRAME}{POINT}_{FRAME}"
    f"|(f|n)_{FRAME}o_{FRAME}|mp_{FRAME}{FRAME}cm|I_{FRAME}{POINT}_{FRAME})(_rate)?"
)
LIKE_A_MONOGRAM = re.compile("(p|R|w|alpha|v|a|f|n|mp|I)_[A-Z]")
QUANTITIES = frozenset(("p", "R", "w", "alpha", "v", "a", "f", "n", "mp", "I", "S", "J"))

# Classes whose fields are bare quantities, and what those are. A class is listed where its instances stand for several
# frames in turn, so that no one monogram is right; everything else is named in full.
BARE = {
    "PartialVelocity": "w_PD_D and v_PDo_D per unit speed across a joint, w_AL_L and v_ALo_L of a link, or those in W",
    "MatrixRotation": "R_AB of the factor of a product, between frames that have no names",
    "Acceleration": "a part of alpha_WL_L and a_WLo_L",
    "Wrench": "f_Lo_L and n_Lo_L of a link, of what it carries, or of its parent",
    "FrameState": "p_WF, R_WF, v_WFo_W, w_WF_W, a_WFo_W, alpha_WF_W of a constraint's frame, which it calls A or B",
    "RelativeMotion": "w_AL_L, v_ALo_L of a link in its parent, and the derivatives of their components",
    "Variation": "changes of w_WL_L, alpha_WL_L, a_WLo_L per unit of a coordinate or a speed",
    "Line": "p and v of the middle of a body's line against W, its direction a (no acceleration), in W",
    "Triad": "p_WSo, R_WS, v_WSo_W, w_WS_W of a frame S of a solid",
    "Momentum": "linear momentum, and angular momentum about Lo, in L",
}


@cache
def trees() -> dict[str, ast.Module]:
    paths = [path for folder in FOLDERS for path in sorted((PACKAGE / "mechanics" / folder).rglob("*.py"))]
    return {path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text(encoding="utf-8")) for path in paths}


def names(tree: ast.AST) -> Iterator[str]:
    """Variables, parameters and attributes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.Attribute):
            yield node.attr


def labels(tree: ast.AST) -> Iterator[str]:
    """Quantities that values of the graph are labelled with, by which the generated C calls them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "named":
            yield re.split(r"[\"'[]", ast.unparse(node.args[0]))[1]


def test_names_with_a_monogram_prefix_are_monograms() -> None:
    wrong = {
        f"{path}: {name}"
        for path, tree in trees().items()
        for name in names(tree)
        if LIKE_A_MONOGRAM.match(name) and not MONOGRAM.fullmatch(name)
    }
    assert not wrong


def test_labels_of_the_generated_code_are_monograms() -> None:
    found = {label for tree in trees().values() for label in labels(tree)}
    assert {"w_WL_L", "a_WLo_L", "f_Lo_L", "I_KLo_L"} <= found
    assert not {label for label in found if not MONOGRAM.fullmatch(label)}
    assert local_name("f_Lo_L[upper arm][2]", 7) == "f_Lo_L__upper_arm_2_7"


def test_only_classes_that_state_their_frames_have_bare_quantities() -> None:
    bare = {
        node.name
        for tree in trees().values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
        for field in node.body
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and field.target.id in QUANTITIES
    }
    assert bare == set(BARE)


def test_every_frame_letter_is_in_the_notation() -> None:
    legend = re.search(r"^Frames:(.*?)\n\n", NOTATION, re.S | re.M)
    assert legend is not None
    missing = [letter for letter in FRAME.strip("[]") if not re.search(rf"\b{letter}\b", legend[1])]
    assert not missing


# The glossary.


def glossary() -> list[list[str]]:
    """Rows of the glossary: term, symbol, code, C, where."""
    lines = NOTATION.split("## Glossary")[1].splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("| ")]
    return rows[1:]


@cache
def source(where: str) -> str:
    return (PACKAGE / where).read_text(encoding="utf-8")


def test_glossary_terms_cite_existing_files() -> None:
    rows = glossary()
    assert len(rows) > 30 and all(len(row) == 5 for row in rows)
    paths = [path for row in rows for path in re.findall(r"`([^`]+)`", row[4])]
    assert not [path for path in paths if not (PACKAGE / path).is_file()]
    assert not [row[0] for row in rows if "`" not in row[4]]


def test_glossary_entries_cite_existing_code() -> None:
    missing = []
    for term, _, code, _, where in glossary():
        texts = [source(path) for path in re.findall(r"`([^`]+)`", where)]
        for name in re.findall(r"`([^`]+)`", code):
            words = re.findall(r"\w+", name)
            if not all(any(re.search(rf"\b{word}\b", text) for text in texts) for word in words):
                missing.append(f"{term}: {name}")
    assert not missing


def test_glossary_entries_cite_existing_c() -> None:
    paths = [path for path in (PACKAGE / "native").rglob("*") if path.suffix in (".h", ".c", ".in")]
    paths += [*(PACKAGE / "generator").rglob("*.py"), *(PACKAGE / "mechanics").rglob("*.py")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in paths)
    names = [name for row in glossary() for name in re.findall(r"`(\w+)[^`]*`", row[3])]
    assert not [name for name in names if not re.search(rf"\b{name}\b", text)]
