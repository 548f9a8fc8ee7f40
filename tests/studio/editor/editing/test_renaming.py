"""Renaming: every reference follows, nothing else does, and renaming back gives the first text."""

from __future__ import annotations

import pytest

import symofros as sf
from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.editing.data_edits import Edit, EditError, Path
from symofros.studio.editor.editing.formulas import formulas
from symofros.studio.editor.editing.yaml_edits import with_references
from symofros.studio.editor.editing.yaml_spans import YamlText
from tests.studio.editor.texts import DATA, FILES, TEXTS


def renamed(text: str, path: Path, to: str) -> str:
    return with_references(text, [Edit("rename", path, key=to)])


def names_of(name: str) -> list[tuple[Path, str]]:
    """What can be renamed in a reference model, with its name as stated."""
    data = DATA[name]
    found: list[tuple[Path, str]] = [(("parameters", key), key) for key in data.get("parameters") or {}]
    found += [(("inputs", key), key) for key in data.get("inputs") or {}]
    for body, entry in data["bodies"].items():
        found.append((("bodies", body), body))
        found += [(("bodies", body, "frames", frame), frame) for frame in entry.get("frames") or {}]
        joint = entry.get("joint", {})
        found += [(("bodies", body, "joint"), joint["name"])] if "name" in joint else []
        own = joint.get("coordinates", [])
        found += [(("bodies", body, "joint", "coordinates", i), symbol) for i, symbol in enumerate(own)]
    return found


CASES = [(name, path, old) for name in sorted(FILES) for path, old in names_of(name)]


@pytest.mark.parametrize(("name", "path", "old"), CASES[::27], ids=lambda x: str(x) if isinstance(x, str) else None)
def test_renaming_and_back_restores_the_bytes(name: str, path: Path, old: str) -> None:
    there = renamed(TEXTS[name], path, "brand_new")
    assert not analyse(FILES[name], there).problems
    back = path if "joint" in path else (*path[:-1], "brand_new")
    assert renamed(there, back, old) == TEXTS[name]


ODD = ("brand-new", "a b", "L/R", "sin", "a::b", "1e3", "b`q", "ü: [x, #]")


@pytest.mark.parametrize(("case", "odd"), [*zip(CASES[5::31], ODD * 3, strict=False)], ids=str)
def test_names_that_formulas_quote_go_there_and_back(case: tuple[str, Path, str], odd: str) -> None:
    name, path, old = case
    there = renamed(TEXTS[name], path, odd)
    assert not analyse(FILES[name], there).problems
    back = path if "joint" in path else (*path[:-1], odd)
    assert YamlText(renamed(there, back, old)).data == DATA[name]  # YAML's own quotes stay.


def test_a_renamed_model_is_the_same_mechanism(tmp_path) -> None:
    text = TEXTS["friction_arm"]
    for path, old in reversed(names_of("friction_arm")):  # What is in a body before the body.
        text = renamed(text, path, f"new_{old}")
    file = tmp_path / "friction_arm.yaml"
    file.write_text(text)
    before, after = sf.load(FILES["friction_arm"]), sf.load(file)
    models = [sf.compile(system, sf.Options(backend="interpreter")) for system in (before, after)]
    q = models[0].neutral() + 0.3
    assert models[1].names.q == tuple(f"new_{name}" for name in models[0].names.q)
    assert (models[0].mass_matrix(q) == models[1].mass_matrix(q)).all()


TEXT = """\
symofros: 1
parameters: {L: 1, Lx: 2}
bodies:
  arm:
    joint: {kind: revolute, effort: ["-L*dq_arm - Lx*sin( q_arm )"]}   # q_arm
    inertia: {mass: 'L + Lx', moments: [L*1e-3, L, L]}
    frames: {tip: {position: [L, 0, 0]}}
    loads: [{at: tip, force: [0, q_arm, 0]}]
  hand:
    joint: {kind: ball, parent: arm, frame: tip, rotors: []}
    inertia: {mass: 1, moments: [1, 1, 1]}
    frames: {tip: {}}
connections:
  c: {first: {body: world}, second: {body: arm, frame: tip}, stiffness: L}
virtual_power:
  p: {dq_arm: -dq_arm*L, q_hand.wx: q_hand.qx}
potentials: {arm: L*cos(q_arm)}
nonholonomic:
  n: {coefficients: {dq_arm: L}, right: 0}
"""


def test_a_body_takes_its_references_and_its_coordinate_along() -> None:
    done = renamed(TEXT, ("bodies", "arm"), "boom")
    expected = (
        TEXT.replace("  arm:\n", "  boom:\n").replace("parent: arm", "parent: boom").replace("body: arm", "body: boom")
    )
    expected = expected.replace("q_arm", "q_boom").replace("# q_boom", "# q_arm")
    assert done == expected  # The potential that is also called arm, and the comment, stay.


def test_a_joint_without_a_name_gets_one() -> None:
    done = renamed(TEXT, ("bodies", "hand", "joint"), "wrist")
    assert "joint: {kind: ball, parent: arm, frame: tip, rotors: [], name: wrist}" in done
    assert "wrist.wx: wrist.qx" in done


def test_a_parameter_is_renamed_by_tokens_and_a_frame_on_its_own_body_only() -> None:
    done = renamed(TEXT, ("parameters", "L"), "len")
    assert "{len: 1, Lx: 2}" in done and "-len*dq_arm - Lx*sin( q_arm )" in done and "mass: 'len + Lx'" in done
    assert "potentials: {arm: len*cos(q_arm)}" in done
    done = renamed(TEXT, ("bodies", "arm", "frames", "tip"), "end")
    assert done.count("end") == 4 and "frames: {tip: {}}" in done


@pytest.mark.parametrize(
    ("path", "to", "says"),
    [
        (("parameters", "L"), "Lx", "'Lx'"),
        (("parameters", "L"), "q_arm", "'q_arm' is taken"),
        (("parameters", "L"), "t", "'t' is taken"),
        (("parameters", "L"), "a\nb", "'a\\nb'"),
        (("bodies", "arm"), "hand", "'hand'"),
        (("bodies", "arm"), "world", "'world'"),
        (("bodies", "arm", "joint"), "L", "'L' is taken"),
        (("bodies", "zz"), "y", "no 'zz'"),
    ],
)
def test_a_name_that_would_be_confused_is_refused(path: Path, to: str, says: str) -> None:
    with pytest.raises(EditError) as caught:
        renamed(TEXT, path, to)
    assert says in caught.value.problem.found


def test_joints_take_the_names_that_formulas_reserve() -> None:
    done = renamed(TEXT, ("bodies", "arm", "joint"), "t")
    assert "cos(`t`)" in done and "-dt*L" in done
    assert renamed(done, ("bodies", "arm", "joint"), "q_arm").count("q_arm") >= TEXT.count("q_arm")


def test_formulas_are_found_by_the_schema() -> None:
    found = {text for _, text in formulas(YamlText(TEXT).root.plain())}
    assert {"L + Lx", "L*1e-3", "-dq_arm*L", "L*cos(q_arm)", "q_arm", "L"} <= found
    assert not found & {"arm", "tip", "revolute", "world"}


DIAGRAM = """symofros_diagram: 1
models:
  arm: {file: arm.yaml}   # what moves
simulation: {plots: [{title: pd, signals: [pd.effort, "pd.effort[0]", pdx.y]}]}
blocks:
  pd: {kind: joint_pd, kp: 1, kd: 8.0e-4, inputs: {q: pdx}}   # comment
  pdx: {kind: forward_dynamics, model: arm, inputs: {u: pd}}
parts:
  left: {file: l.yaml, models: {m: arm}, inputs: {a: pd.effort}}
wires: {left/inner.u: pd.effort, pdx.v: left/inner.y}
outlets: {out: pd.effort}
"""


REFERENCES = {
    "blocks/pd/law": [
        ('[pd.effort, "pd.effort[0]"', '[law.effort, "law.effort[0]"'),
        ("  pd: {kind", "  law: {kind"),
        ("{u: pd}", "{u: law}"),
        ("{a: pd.effort}", "{a: law.effort}"),
        ("inner.u: pd.effort", "inner.u: law.effort"),
        ("{out: pd.effort}", "{out: law.effort}"),
    ],
    "parts/left/right": [
        ("  left: {file", "  right: {file"),
        ("{left/inner.u", "{right/inner.u"),
        ("left/inner.y", "right/inner.y"),
    ],
    "models/arm/robot": [
        ("  arm: {file", "  robot: {file"),
        ("model: arm", "model: robot"),
        ("{m: arm}", "{m: robot}"),
    ],
}


@pytest.mark.parametrize("renamed", REFERENCES)
def test_references_follow_a_renaming(renamed: str) -> None:
    section, name, new = renamed.split("/")
    wanted = DIAGRAM
    for old, after in REFERENCES[renamed]:
        assert wanted.count(old) == 1, old
        wanted = wanted.replace(old, after)
    assert with_references(DIAGRAM, [Edit("rename", (section, name), key=new)]) == wanted


@pytest.mark.parametrize("new", ["pdx", "left", "1x", "a.b", ""])
def test_taken_and_invalid_names_are_refused(new: str) -> None:
    with pytest.raises(EditError):
        with_references(DIAGRAM, [Edit("rename", ("blocks", "pd"), key=new)])


def test_events_follow_what_they_name() -> None:
    """Forces of constraints and joints, parameters and speeds that actions set, and the constraint's switch."""
    text = TEXTS["docking"].replace("turns: dshoulder", "turns: dshoulder + lam.gear - reaction.shoulder.fz")
    for path, to in (
        (("closures", "grasp"), "hold"),
        (("couplings", "gear"), "left-gear"),
        (("parameters", "grip"), "shut"),
        (("bodies", "upper_arm", "joint"), "base"),
    ):
        text = renamed(text, path, to)
    for line in (
        "  slips: {formula: wrench.hold.fx^2 + wrench.hold.fy^2 - 100^2, direction: rising, action: {shut: 0}, once",
        "  turns: dbase + `lam.left-gear` - reaction.base.fz",
        "  hold: {engaged: shut, pose: moment}",
        "  left-gear: {engaged: geared, pose: moment}",
    ):
        assert line in text, text
    assert not analyse(FILES["docking"], text).problems


def test_an_event_s_fault_leads_to_its_entry() -> None:
    text = TEXTS["docking"].replace("action: {taut: 1}", "action: {tauter: 1}")
    (problem,) = analyse(FILES["docking"], text).problems
    assert problem["path"][:2] == ["events", "catches"], problem
