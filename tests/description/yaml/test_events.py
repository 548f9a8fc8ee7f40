"""Events in the native file: read, written, refused in words that name object and line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sympy
from typer.testing import CliRunner

import symofros as sf
from reference_models import MODELS
from symofros.__main__ import app
from symofros.description.events import event_text
from symofros.description.yaml import event_data

HEAD = """\
symofros: 1
parameters: {shut: 1, mass: {value: 2, constant: true}, low: 0}
bodies:
  weight:
    joint: {name: z, kind: prismatic, axis: [0, 0, 1]}
    inertia: {mass: mass}
closures:
  latch: {first: {body: world}, second: {body: weight}, translations: [z]}
switches:
  latch: {engaged: shut, pose: moment}
"""


def written(folder: Path, events: str) -> Path:
    path = folder / "latched.yaml"
    path.write_text(f"{HEAD}events:\n  {events}\n", encoding="utf-8")
    return path


CASES: list[tuple[str, list[str]]] = [
    ("a: lam.lach.z - 1", ["event 'a': unknown symbol 'lam.lach.z'", "did you mean 'lam.latch.z'?"]),
    ("a: wrench.latch.fq", ["event 'a': unknown symbol 'wrench.latch.fq'"]),
    ("a: reaction.x.fx - 1", ["event 'a': unknown symbol 'reaction.x.fx'", "did you mean 'reaction.z.fx'?"]),
    ("a: z + (", ["event 'a'", "formula"]),
    ("a: {formula: z, action: {shutt: 0}}", ["event 'a': its action sets 'shutt'", "did you mean 'shut'?"]),
    ("a: {formula: z, action: {z: 0}}", ["its action sets the coordinate 'z'", "set its speed, 'dz'"]),
    ("a: {formula: z, action: {mass: 1}}", ["its action sets the constant 'mass'", "leave 'constant' out"]),
    ("a: {formula: z, action: {latch.z.held: 1}}", ["'latch' holds the pose of the moment", "set what engages it"]),
    ("a: {formula: z, action: {dz: 0, '`dz`': 1}}", ["its action sets"]),
    ("a: {formula: z, action: {shut: lam.latch.z}}", ["what its action sets 'shut' to: 'lam.latch.z' may not be used"]),
    ("a: {formula: z, direction: up}", ["event 'a': direction: unknown choice 'up'", "both, rising, falling"]),
    ("a: {formula: z, restitution: 2, action: {shut: 1}}", ["event 'a'", "restitution is a number from 0 to 1"]),
    ("a: {condition: z}", ["event 'a': unknown entry 'condition'", "write it as 'formula'"]),
    ("a: {formula: z, set: {shut: 0}}", ["event 'a': unknown entry 'set'", "write it as 'action'"]),
    ("a: {action: {shut: 0}}", ["event 'a': entry 'formula' is missing"]),
    ("a: z\n  a: z - 1", ["'a' appears twice"]),
    ("a: {formula: z, direction: falling, action: {shut: 0.5}, restitution: 0.5, rests: lam.latch.z}", ["event 'a'"]),
]


@pytest.mark.parametrize(("events", "words"), CASES)
def test_faults_name_event_line_rule_and_remedy(tmp_path: Path, events: str, words: list[str]) -> None:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(written(tmp_path, events))
    assert all(word in str(caught.value) for word in words), caught.value
    assert f"latched.yaml:{12 + events.count(chr(10))}:" in str(caught.value) and "remedy:" in str(caught.value)


@pytest.mark.parametrize(("section", "remedy"), [("actions", "'events'"), ("modes", "'switches'")])
def test_other_words_are_answered_with_the_section_s_own(tmp_path: Path, section: str, remedy: str) -> None:
    path = tmp_path / "latched.yaml"
    path.write_text(f"{HEAD}{section}: {{}}\n", encoding="utf-8")
    with pytest.raises(sf.DescriptionError, match=f"write it as {remedy}"):
        sf.load(path)


def test_two_files_have_no_event_in_common(tmp_path: Path) -> None:
    path = written(tmp_path, "a: z")
    path.write_text(path.read_text().replace("symofros: 1", "symofros: 1\ninclude: [part.yaml]"))
    (tmp_path / "part.yaml").write_text("symofros: 1\nevents: {b: z - 1}\n")
    assert list(sf.load(path).events) == ["b", "a"]
    (tmp_path / "part.yaml").write_text("symofros: 1\nevents: {a: z - 1}\n")
    with pytest.raises(sf.DescriptionError, match="event 'a' is in two files"):
        sf.load(path)


EVENTS: dict[str, Any] = {
    "breaks": sf.Event("wrench.latch.fz - 40", "rising", action={"shut": 0, "dz": "dz/2"}),
    "ends": sf.Event("t - 3", terminal=True),
    "strikes": sf.Event("z", "falling", action={"low": 1}, restitution=0.7),
    "lands": sf.Event("z", "falling", action={"low": 1}, restitution=0.5, rests="lam.latch.z"),
    "once": sf.Event("dz", once=True),
    "crosses": "z - 0.25",
}


def test_all_that_an_event_states_is_written_and_read(tmp_path: Path) -> None:
    """Also from SymPy's formulas; what is the default, or the key, is left out."""
    system = replace(sf.load(written(tmp_path, "a: z")), events=EVENTS)
    sf.save(system, tmp_path / "again.yaml")
    text = (tmp_path / "again.yaml").read_text()
    again = sf.load(tmp_path / "again.yaml")
    assert again == system and list(again.events) == [*EVENTS] and hash(again) == hash(system)
    assert again != replace(system, events={**EVENTS, "crosses": "z - 0.26"})
    assert "  crosses: z - 0.25\n" in text and "  once: {formula: dz, once: true}\n" in text
    assert event_data(again.events["lands"]) == {
        "formula": "z", "direction": "falling", "action": {"low": 1}, "restitution": 0.5, "rests": "lam.latch.z",
    }  # fmt: skip
    symbolic = replace(system, events={"a": sympy.Symbol("z") ** 2 - 1})
    sf.save(symbolic, tmp_path / "symbolic.yaml")
    assert sf.load(tmp_path / "symbolic.yaml") == symbolic


@pytest.mark.parametrize("events", [{1: "z"}, {"a": None}, {"a": "z +"}, {"": "z"}, ["z"], {"a": float("nan")}])
def test_what_is_no_event_is_refused_in_python(tmp_path: Path, events: Any) -> None:
    system = sf.load(written(tmp_path, "a: z"))
    with pytest.raises(sf.DescriptionError):
        sf.compile(replace(system, events=events))


def test_events_are_shown_and_compared(tmp_path: Path) -> None:
    """`info` lists them, `diff` names the one that changed, and switches."""
    system, path = MODELS["docking"], tmp_path / "other.yaml"
    changed = dict(system.events) | {"slips": replace(system.events["slips"], action={"grip": 0.0, "geared": 0.0})}
    other = replace(system, events=changed, switches=system.switches[:2])
    sf.save(other, path)
    shown = CliRunner().invoke(app, ["info", str(path), "--json"]).stdout
    assert '"catches"' in shown and event_text(changed["slips"]).endswith("rises: grip = 0, geared = 0, once")
    assert event_text(changed["slips"]) in shown
    found = sf.diff(system, path)
    assert [item.entry for item in found.differences] == ["switch of 'rope'", "event 'slips'"]
    assert not found.same and sf.diff(system, replace(system, events=changed)).same
    assert sf.diff(system, system).identical
    assert not sf.diff(system, replace(system, events={})).identical
