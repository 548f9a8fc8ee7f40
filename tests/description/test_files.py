"""The native file: round trips, and every fault with its line."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import pytest

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.description.yaml.files import MAX_BYTES, read_yaml
from symofros.description.yaml.yaml_pieces import compose_text
from tests.description import reading
from tests.exports.interchange.stated_trees import stated_tree

HEAD = "symofros: 1\nsystem: {name: arm}\n"
LINK = "  link: {joint: {name: q1, kind: revolute}, inertia: {mass: 1, moments: [1, 1, 1]}}\n"
ARM = HEAD + "bodies:\n" + LINK


load, faults = (partial(of, name="arm.yaml") for of in (reading.load, reading.faults_of))


def test_yaml_1_2_numbers_are_read(tmp_path: Path) -> None:
    arm = load(tmp_path, HEAD + "parameters: {a: 1e-3, b: {value: -2.5E+2, constant: true}}\nbodies:\n" + LINK)
    assert arm.parameter_values() == {"a": 1e-3, "b": -250.0}


@pytest.mark.parametrize("text", ["symofros: 1\nbodies: [", "- 1\n- 2\n", "a: " + "[" * 80 + "]" * 80])
def test_texts_that_are_not_yaml_mappings_are_refused(text: str, tmp_path: Path) -> None:
    """All other faults of a text are in faults.txt."""
    assert "arm.yaml:" in (message := faults(tmp_path, text)) and "rule:" in message


def test_all_faults_of_a_file_are_reported_together(tmp_path: Path) -> None:
    """Of form, of formulas, of the tree and of physics, each with its line, in order."""
    text = (
        HEAD.replace("}", ", gravit: [0, 0, -1]}")
        + "parameters: {L: 1}\nbodies:\n"
        + "  a: {joint: {name: q1, kind: revolut}}\n"
        + "  b: {joint: {name: q2, kind: revolute}, inertia: {mass: m9}}\n"
        + "  c: {joint: {name: q3, kind: revolute, parent: d}, inertia: {mass: 1, moments: [1, 1, 1]}}\n"
        + "  e: {joint: {name: q4, kind: revolute, parent: c, frame: tip}, inertia: {mass: -2}}\n"
    )
    message = faults(tmp_path, text)
    order = ["gravit", "revolut", "m9", "'d'", "'tip'", "mass -2"]
    places = [message.find(part) for part in order]
    assert -1 not in places, message
    assert [f"arm.yaml:{n}" in message for n in (2, 5, 6, 7, 8)] == [True] * 5
    # Body a is broken, but it exists: no problem says that it does not.
    assert "parent 'a'" not in message


def test_empty_large_binary_and_missing_files_are_refused(tmp_path: Path) -> None:
    assert "the file is empty" in faults(tmp_path, "")
    assert "UTF-8" in faults(tmp_path, ARM.encode("utf-16"))
    assert "MiB" in faults(tmp_path, "# " + "x" * (5 << 20)) or "large" in faults(tmp_path, "# " + "x" * (5 << 20))
    with pytest.raises(sf.DescriptionError, match="does not exist"):
        sf.load(tmp_path / "none.yaml")


class TestInclude:
    def test_parts_are_merged(self, tmp_path: Path) -> None:
        (tmp_path / "parts").mkdir()
        (tmp_path / "parts" / "hand.yaml").write_text(
            "symofros: 1\nparameters: {m_hand: 2}\n"
            "bodies:\n  hand:\n    joint: {name: q2, kind: revolute, parent: link}\n"
            "    inertia: {mass: m_hand, moments: [1, 1, 1]}\n"
        )
        arm = load(tmp_path, ARM + "include: [parts/hand.yaml]\n")
        assert {body.name for body in arm.bodies} == {"link", "hand"}
        assert arm.parameter_values() == {"m_hand": 2.0}

    @pytest.mark.parametrize(
        ("target", "says"),
        [
            *((path, "leaves the main file's folder") for path in ("../secret.yaml", "/etc/passwd.yaml", "link.yaml")),
            ("parts/../../secret.yaml", "leaves the main file's folder"),
            *[("cycle.yaml", "cycle"), ("none.yaml", "none.yaml"), ("again.yaml", "'link'")],
        ],
    )
    def test_includes_that_cannot_be_are_refused(self, target: str, says: str, tmp_path: Path) -> None:
        inside = tmp_path / "inside"
        inside.mkdir()
        (tmp_path / "secret.yaml").write_text("symofros: 1\nparameters: {secret: 1}\n")
        os.symlink(tmp_path / "secret.yaml", inside / "link.yaml")
        (inside / "cycle.yaml").write_text("symofros: 1\ninclude: [arm.yaml]\n")
        (inside / "again.yaml").write_text("symofros: 1\nbodies:\n" + LINK)
        message = faults(inside, ARM + f"include: [{target}]\n")
        assert says in message and ("arm.yaml:5" in message) == ("leaves" in says or target == "none.yaml"), message


def test_reading_keeps_the_valid_elements(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(ARM + "  bad: {joint: 3}\n")
    found = read_yaml(tmp_path / "arm.yaml")
    assert found.system is not None and [body.name for body in found.system.bodies] == ["link"]
    assert found.broken >= {"bad"} and len(found.problems) == 1


@pytest.mark.parametrize("seed", range(100, 112))
def test_every_joint_kind_round_trips(seed: int, tmp_path: Path) -> None:
    """Also with noise in all that is stated, limits on one side, springs, dampers and friction."""
    for tree in (random_tree(seed, kinds=MORE_KINDS), stated_tree(seed)):
        sf.save(tree, tmp_path / "tree.yaml")
        assert sf.load(tmp_path / "tree.yaml") == tree


EVERYTHING = Path(__file__).with_name("all_forces.yaml").read_text()


def test_all_kinds_of_forces_are_written_and_read(tmp_path: Path) -> None:
    system = load(tmp_path, EVERYTHING)
    sf.save(system, tmp_path / "again.yaml")
    assert sf.load(tmp_path / "again.yaml") == system
    model = sf.compile(system, sf.Options(backend="interpreter"))
    assert model.names.q == ("q", "s", "a") and model.names.u == ("u1", "x", "dx", "ddx")
    assert model.forward_dynamics([0.1, 0.2, 0.3], [1, 2, 3], [1, 0, 0, 0], t=2.0).shape == (3,)


def test_unsaved_text_is_read_as_if_it_were_saved(tmp_path: Path) -> None:
    (tmp_path / "parts.yaml").write_text("symofros: 1\nparameters: {m: 2}\n")
    file = tmp_path / "arm.yaml"
    text = "symofros: 1\ninclude: [parts.yaml]\nbodies: {a: {joint: {kind: revolute}, inertia: {mass: m}}}\n"
    unwritten = read_yaml(file, text)
    assert not file.exists() and unwritten.problems == ()
    file.write_text(text)
    assert read_yaml(file).system == unwritten.system
    assert read_yaml(file, "symofros: 2\n").problems[0].where == f"{file}:1"
    assert "too large" in read_yaml(tmp_path / "a.yaml", "#" * (MAX_BYTES + 1)).problems[0].what


def test_nodes_know_their_span_and_style_in_the_text() -> None:
    text = "a: 1  # c\nb c: {x: 'y', z: [1, 2]}\nd: |\n  e\nf:\n  - g\n"
    root, _ = compose_text(text, "x")
    places = {
        key: (text[node.key_start : node.key_end], text[node.start : node.end], node.style)
        for key, node in root.value.items()
    }
    assert places["a"] == ("a", "1", "plain") and places["b c"] == ("b c", "{x: 'y', z: [1, 2]}", "flow")
    assert places["d"][1:] == ("|\n  e\n", "|") and places["f"][2] == "block"
    inner = root.value["b c"].value["x"]
    assert text[inner.start : inner.end] == "'y'" and inner.style == "'"
