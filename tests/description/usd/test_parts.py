"""What a USD stage is made of: parts that are missing are refused, and no path leads outside, whatever names are."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros.description.usd.stage import warnings_of
from symofros.description.workers import MAX_PRINTED, answer_of
from tests.description.usd.models import ARM, body, joint, stage
from tests.late import require

require("pxr.Usd", "usd")

PARTS = {
    "missing": "@gone.usda@",
    "not USD": "@junk.usda@",
    "an unknown kind of file": "@junk.txt@",
    "on the network": "@http://localhost:1/part.usda@",
    "a folder": "@folder@",
    "a prim that is not there": "@part.usda@</nobody>",
    "without a default prim": "@anonymous.usda@",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "part.usda").write_text(stage(body("arm", **ARM)))
    (tmp_path / "anonymous.usda").write_text('#usda 1.0\ndef Xform "arm" {}\n')
    (tmp_path / "junk.usda").write_text("junk")
    (tmp_path / "junk.txt").write_text("junk")
    (tmp_path / "folder").mkdir()
    return tmp_path


ARCS = [("references", part) for part in PARTS]
ARCS += [("payload", "missing"), ("subLayers", "missing"), ("subLayers", "not USD")]


@pytest.mark.parametrize(("arc", "part"), ARCS)
def test_a_part_that_is_missing_is_refused(folder: Path, arc: str, part: str) -> None:
    named = PARTS[part]
    text = stage(body("base", **ARM))
    if arc == "subLayers":
        text = text.replace("(\n", f"(\n    subLayers = [{named}]\n", 1)
    else:
        extra = f'def Xform "more" (prepend {arc} = {named}) {{\n}}\n'
        text = f"{text}\n{extra}"
    file = folder / "robot.usda"
    file.write_text(text)
    with pytest.raises(sf.DescriptionError, match="a part of the stage is missing") as raised:
        sf.load(file)
    assert named.strip("@").partition("@")[0].rpartition("/")[2] in str(raised.value)


def test_each_missing_part_is_reported(folder: Path) -> None:
    file = folder / "robot.usda"
    extra = "".join(f'def Xform "m{k}" (prepend references = @gone{k}.usda@) {{\n}}\n' for k in range(3))
    file.write_text(stage(body("base", **ARM)) + "\n" + extra)
    with pytest.raises(sf.DescriptionError) as raised:
        sf.load(file)
    assert len(raised.value.problems) == 3


@pytest.mark.parametrize("name", ["[x", "x[y", "x[y]", "part.usda[y]", "[x]", "[x]y", "x]"])
@pytest.mark.parametrize("suffix", [".usda", ""])
def test_symbolic_links_of_any_name_cannot_leave_the_folder(folder: Path, name: str, suffix: str) -> None:
    inside = folder / "model"
    inside.mkdir()
    (inside / "part.usda").write_text(stage(body("own", **ARM)))
    (inside / f"{name}{suffix}").symlink_to(folder / "part.usda")
    file = inside / "robot.usda"
    file.write_text(stage().replace("(\n", f"(\n    subLayers = [@./{name}{suffix}@]\n", 1))
    with pytest.raises(sf.DescriptionError, match="other folders|is missing"):
        sf.load(file)


@pytest.mark.parametrize("name", ["[robots]", "a[b", "a]b", "x.usdz[y]"])
def test_folders_may_have_any_name(folder: Path, name: str) -> None:
    inside = folder / name
    inside.mkdir()
    (inside / "part.usda").write_text(stage(body("arm", **ARM)))
    (inside / "robot.usda").write_text(stage().replace("(\n", "(\n    subLayers = [@./part.usda@]\n", 1))
    for file in ("part.usda", "robot.usda"):
        assert [body.name for body in sf.load(inside / file).bodies] == ["arm"]


def test_members_of_a_usdz_package_are_found(folder: Path) -> None:
    from pxr import UsdUtils

    inside = folder / "[robots]"
    inside.mkdir()
    package = inside / "robot.usdz"
    assert UsdUtils.CreateNewUsdzPackage(str(folder / "part.usda"), str(package))
    assert sf.load(package).bodies[0].name == "arm"


def test_warnings_are_parsed_from_the_output_of_openusd(folder: Path) -> None:
    file = folder / "robot.usda"
    file.write_text(stage(body("arm", **ARM)))
    assert not any("OpenUSD" in note for note in sf.load(file).notes)
    printed = (
        "Warning: in _Report at line 12 of /opt/x.cpp -- In </a>: odd.\n\nWarning: in _Report at line 12 of /y -- b\n"
    )
    assert warnings_of(printed) == ["In </a>: odd.", "b"]


def test_output_of_a_worker_is_bounded_and_its_failures_are_reported(tmp_path: Path) -> None:
    script = tmp_path / "worker.py"
    script.write_text("import sys\nsys.stderr.write('\\x1bxy' * 400_000)\nprint('{\"text\": 1}')\n")
    answer = answer_of(str(script), {}, 60.0, "too much")
    assert answer["text"] == 1 and answer["printed"].startswith("\\u001bxy")
    assert len(answer["printed"]) < 10 * MAX_PRINTED
    script.write_text("import sys\nprint('no memory', file=sys.stderr)\nsys.exit(3)\n")
    assert answer_of(str(script), {}, 60.0, "too much") == {"fault": "it takes too much", "printed": "no memory\n"}
    script.write_text("print('not JSON')")
    assert "no answer" in answer_of(str(script), {}, 60.0, "too much")["fault"]


@pytest.mark.parametrize("absent", ["(active = false)", "class", "over"])
@pytest.mark.parametrize(("first", "second"), [("arm", "gone"), ("gone", "arm")])
def test_a_joint_to_what_the_stage_leaves_out_is_no_joint_to_the_world(
    tmp_path: Path, absent: str, first: str, second: str
) -> None:
    """A prim that is inactive, abstract or undefined has a path and is no body."""
    gone = body("gone", **ARM)
    gone = (
        gone.replace("def Xform", absent, 1)
        if absent in ("class", "over")
        else gone.replace("(", "(active = false\n", 1)
    )
    file = tmp_path / "robot.usda"
    file.write_text(stage(body("arm", **ARM), gone, joint("Revolute", "j", first, second)))
    with pytest.raises(sf.DescriptionError, match="joint 'j' joins no two bodies"):
        sf.load(file)


@pytest.mark.parametrize(
    ("units", "note"),
    [
        ({"meters": 0.01}, "metersPerUnit of layers that the stage is made of ignored, .*: 1 layer .part.usda, 0.01."),
        ({"kilograms": 0.001}, "kilogramsPerUnit of layers .* 1 layer .part.usda, 0.001."),
        ({"up": "Y"}, "upAxis of layers .* 1 layer .part.usda, Y."),
        ({}, ""),
    ],
)
def test_parts_in_other_units_are_noted(tmp_path: Path, units: dict[str, Any], note: str) -> None:
    """OpenUSD converts none: a part in centimetres is a hundred times as long in a stage in metres."""
    (tmp_path / "part.usda").write_text(stage(body("arm", **ARM), **units))
    file = tmp_path / "robot.usda"
    part = 'def Xform "part" (prepend references = @part.usda@) {\n}\n'
    file.write_text(stage(body("link", **ARM), part, joint("Revolute", "j", "", "link")))
    notes = [text for text in sf.load(file).notes if " of layers " in text]
    assert len(notes) == bool(note) and all(re.search(note, text) for text in notes)
