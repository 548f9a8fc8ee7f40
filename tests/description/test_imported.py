"""Options of reading mean the same for every foreign format: what is kept, what is noted, which root floats."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.imported.stops import PERIOD, apparent_inertias
from symofros.loading import load_with_sources
from tests.description.usd.models import body, joint, stage

MOMENTS = 'ixx="0.1" iyy="0.2" izz="0.15" ixy="0" ixz="0" iyz="0"'
LINK = f'<link name="{{}}"><inertial><origin xyz="0 0 -0.3"/><mass value="2"/><inertia {MOMENTS}/></inertial></link>'
# An arm that hangs on a base that stands still: damping 0.5, dry friction 0.2, limits +-1.
URDF = f"""<robot name="r">{LINK.format("base")}{LINK.format("arm")}
<joint name="q" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="9" velocity="9"/><dynamics damping="0.5" friction="0.2"/></joint></robot>"""
INERTIAL = '<inertial pos="0 0 -0.3" mass="2" diaginertia="0.1 0.2 0.15"/>'
MJCF = f"""<mujoco><compiler angle="radian"/><worldbody><body name="base">{INERTIAL}<body name="arm">{INERTIAL}
<joint name="q" axis="0 1 0" range="-1 1" damping="0.5" frictionloss="0.2"/></body></body></worldbody></mujoco>"""
MATRIX = "<inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.15</izz></inertia>"
MASS = f"<inertial><pose>0 0 -0.3 0 0 0</pose><mass>2</mass>{MATRIX}</inertial>"
SDF = f"""<sdf version="1.9"><model name="r"><link name="base">{MASS}</link><link name="arm">{MASS}</link>
<joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="q" type="revolute"><parent>base</parent><child>arm</child><axis><xyz>0 1 0</xyz>
<limit><lower>-1</lower><upper>1</upper></limit><dynamics><damping>0.5</damping><friction>0.2</friction></dynamics>
</axis></joint></model></sdf>"""
RIGID: dict[str, Any] = {"mass": 2.0, "centerOfMass": (0, 0, -0.3), "diagonalInertia": (0.1, 0.2, 0.15)}
DEGREE = np.pi / 180.0
USD = stage(
    body("base", **RIGID),
    body("arm", **RIGID),
    joint("Fixed", "hold", "", "base"),
    joint(
        "Revolute",
        "q",
        "base",
        "arm",
        extra=(f"float newton:damping = {0.5 * DEGREE}", "float newton:friction = 0.2"),
        axis="Y",
        lowerLimit=-1.0 / DEGREE,
        upperLimit=1.0 / DEGREE,
    ),
)
FILES = {".urdf": URDF, ".xml": MJCF, ".sdf": SDF, ".usda": USD}
DIGITS = 1e-6  # Numbers of USD have single precision.
ELEMENTS = {"none": (), "viscous": (sf.Damper,), "all": (sf.Damper, sf.Friction)}
INTERPRETED = sf.Options(backend="interpreter")


def written(folder: Path, suffix: str, text: str | None = None) -> Path:
    path = folder / f"robot{suffix}"
    path.write_text(FILES[suffix] if text is None else text, encoding="utf-8")
    return path


def hinge(system: sf.System) -> sf.Joint:
    return next(b.joint for b in system.bodies if b.joint is not None and b.joint.name == "q")


@pytest.mark.parametrize("dissipation", [None, "none", "viscous", "all", "stiction"])
@pytest.mark.parametrize("suffix", FILES)
def test_dissipation_follows_the_option_and_dropped_terms_are_noted(
    tmp_path: Path, suffix: str, dissipation: Any
) -> None:
    system = sf.load(written(tmp_path, suffix), dissipation=dissipation)
    kept = dissipation or ("none" if suffix == ".urdf" else "viscous")
    elements = hinge(system).elements
    assert tuple(map(type, elements)) == ELEMENTS["all" if kept == "stiction" else kept]
    assert [e.sticks for e in elements if isinstance(e, sf.Friction)] == {"all": [False], "stiction": [True]}.get(
        kept, []
    )
    stated = [element.coefficient if isinstance(element, sf.Damper) else element.dynamic for element in elements]  # type: ignore[union-attr]
    np.testing.assert_allclose(np.array(stated, dtype=float), [0.5, 0.2][: len(elements)], rtol=DIGITS)
    reported = {
        '; damping of joints ignored (dissipation="viscous" of load, or --dissipation viscous, keeps it)': kept
        == "none",
        'dry friction of joints ignored (dissipation="all" of load, or --dissipation all, keeps it)': kept
        not in ("all", "stiction"),
        "dry friction of joints smoothed below 0.001 rad/s or m/s, so that what it holds at rest creeps": kept == "all",
    }
    notes = "; ".join(["", *system.notes])
    assert {text: text in notes for text in reported} == reported


@pytest.mark.parametrize("suffix", FILES)
def test_limits_become_stops_scaled_by_the_apparent_inertia(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path, suffix)
    data = sf.load(path)
    assert not any(isinstance(element, sf.Stop) for element in hinge(data).elements)
    assert any('limits kept as data, without a stop (limits="stops"' in n for n in data.notes) == (suffix == ".xml")
    for floating in (False, True):
        system = sf.load(path, limits="stops", floating_base=floating)
        stop = hinge(system).elements[-1]
        assert isinstance(stop, sf.Stop)
        model = sf.compile(system, INTERPRETED)
        k = model.names.v.index("q")
        omega, inertia = 2.0 * np.pi / PERIOD, 1.0 / np.linalg.inv(model.mass_matrix(model.neutral()))[k, k]
        expected = [inertia * omega**2, 2.0 * inertia * omega, -1.0, 1.0]
        numbers = [stop.stiffness, stop.damping, stop.lower, stop.upper]
        np.testing.assert_allclose(np.array(numbers, dtype=float), expected, rtol=DIGITS)
        assert any(
            "limits are stops that yield" in note and f"(q {stop.stiffness:.3g} N m" in note for note in system.notes
        )


@pytest.mark.parametrize("suffix", FILES)
def test_a_grounded_base_floats_if_asked(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path, suffix)
    base = sf.load(path).body("base")
    assert base.joint is None or base.joint.kind == "fixed"
    system = sf.load(path, floating_base=True)
    free, inertia = system.body("base").joint, system.body("base").inertia
    assert free is not None and inertia is not None and float(inertia.mass) == 2.0  # type: ignore[arg-type]
    assert (free.kind, free.name) == ("free", "root_joint" if suffix == ".urdf" else "base_floating")
    assert system.origin["joint", free.name]


FLOATS = {
    ".xml": MJCF.replace('name="base">', 'name="base"><freejoint name="f"/>'),
    ".sdf": SDF.replace('<joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>', ""),
    ".usda": USD.replace("PhysicsFixedJoint", "PhysicsJoint"),
}


@pytest.mark.parametrize("suffix", FLOATS)
def test_a_floating_base_is_not_doubled(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path, suffix, FLOATS[suffix])
    assert sf.load(path, floating_base=True) == sf.load(path)


REFUSED = {
    "moves on joint 'j'": (".xml", MJCF.replace('name="base">', 'name="base"><joint name="j"/>')),
    "several stand on the ground: base, other": (
        ".xml",
        MJCF.replace("</worldbody>", '<body name="other"/></worldbody>'),
    ),
    "the root link is 'world', which is the ground": (".urdf", URDF.replace('"base"', '"world"')),
}


@pytest.mark.parametrize("found", REFUSED)
def test_a_root_that_cannot_float_is_refused(tmp_path: Path, found: str) -> None:
    path = written(tmp_path, *REFUSED[found])
    with pytest.raises(sf.DescriptionError, match=f"that could float[\\s\\S]*{found}"):
        sf.load(path, floating_base=True)


def test_passive_forces_match_mujoco(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    inner = (
        f'<body name="b" pos="0.2 0 0.1">{INERTIAL}<joint name="s" type="slide" axis="1 1 0" damping="3" range="-1 1"/>'
    )
    ball = f'<body name="c" pos="0 0.1 0.3">{INERTIAL}<joint name="r" type="ball" damping="0.7"/></body></body>'
    text = MJCF.replace("</body></body></worldbody>", f"{inner}{ball}</body></body></worldbody>")
    path = written(tmp_path, ".xml", text)
    theirs = mujoco.MjModel.from_xml_path(str(path))
    state = mujoco.MjData(theirs)
    rng = np.random.default_rng(5)
    state.qvel[:] = rng.standard_normal(theirs.nv)
    mujoco.mj_forward(theirs, state)
    system = sf.load(path, dissipation="viscous", limits="stops")
    model = sf.compile(system, INTERPRETED)
    ours = model.generalized_force(model.neutral(), state.qvel, np.zeros(model.nu))
    np.testing.assert_allclose(ours, state.qfrc_passive, rtol=1e-12, atol=1e-15)
    # Its limits are scaled by the same inertia as our stops.
    inertias = apparent_inertias(system.bodies)  # type: ignore[arg-type]
    assert inertias is not None
    np.testing.assert_allclose([inertias["arm"], inertias["b"]], 1.0 / theirs.dof_invweight0[:2], rtol=1e-12)
    with_friction = sf.compile(sf.load(path, dissipation="all"), INTERPRETED)
    fast = np.where(np.arange(theirs.nv) == 0, 2.0, 0.0)
    rubbed = with_friction.generalized_force(model.neutral(), fast, np.zeros(model.nu))
    np.testing.assert_allclose(rubbed[0], -0.5 * 2.0 - theirs.dof_frictionloss[0], rtol=1e-12)


KINDS = ("revolute", "prismatic", "screw", "universal", "cylindrical", "planar", "ball", "free", "continuous")


def test_apparent_inertias_match_the_mass_matrix() -> None:
    rng = np.random.default_rng(3)
    bodies, parent = list[sf.RigidBody](), "world"
    for kind in KINDS:
        axis, axis2 = ((x, y, z) for x, y, z in rng.standard_normal((2, 3)).tolist())
        x, y, z = rng.uniform(-1.0, 1.0, 3).tolist()
        turned = sf.Rotation.rpy(*rng.uniform(-1.0, 1.0, 3).tolist())
        two = {"axis2": axis2} if kind == "universal" else {"pitch": 0.3} if kind == "screw" else {}
        made = sf.Joint(f"j_{kind}", kind, parent, None, (x, y, z), turned, axis, armature=0.25, **two)  # type: ignore[arg-type]
        inertia = sf.Inertia(2.0, (0.1, -0.2, 0.3), (0.3, 0.4, 0.5, 0.02, 0.01, -0.03))
        bodies.append(sf.RigidBody(f"b_{kind}", made, inertia))
        parent = f"b_{kind}"
    model = sf.compile(sf.System("all", tuple(bodies)), INTERPRETED)
    expected = 1.0 / np.diag(np.linalg.inv(model.mass_matrix(model.neutral())))
    first = {
        name: next(i for i, v in enumerate(model.names.v) if v.startswith(f"j_{name[2:]}"))
        for name in (b.name for b in bodies)
    }
    found = apparent_inertias(bodies)
    assert found is not None
    np.testing.assert_allclose(list(found.values()), [expected[first[name]] for name in found], rtol=1e-11)


def test_a_singular_mass_matrix_gives_no_stop(tmp_path: Path) -> None:
    tip = (
        '<link name="tip"/><joint name="t" type="continuous"><parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/>'
    )
    path = written(tmp_path, ".urdf", URDF.replace("</robot>", f"{tip}</joint></robot>"))
    notes = sf.load(path, limits="stops", waive=["massless_tip"]).notes
    said = "limits kept as data, as no stiffness of a stop follows from a singular mass matrix: 1 joint (q)"
    assert said in notes


@pytest.mark.parametrize(
    ("dynamics", "said"),
    [
        ('damping="0.5" K="7"', "entries of <dynamics> other than damping and friction ignored: 1 joint (q)"),
        ('damping="0" friction="0.0" K="0"', ""),
    ],
)
def test_other_entries_of_urdf_dynamics_are_noted_unless_zero(tmp_path: Path, dynamics: str, said: str) -> None:
    text = URDF.replace('damping="0.5" friction="0.2"', dynamics)
    notes = sf.load(written(tmp_path, ".urdf", text), dissipation="all").notes
    assert [note for note in notes if "<dynamics>" in note or "friction" in note] == [said] * bool(said)


def test_damping_of_a_floating_joint_is_always_noted(tmp_path: Path) -> None:
    text = URDF.replace('type="revolute"', 'type="floating"')
    notes = sf.load(written(tmp_path, ".urdf", text), dissipation="all").notes
    assert any(n.startswith("damping and friction of fixed, planar and floating joints ignored") for n in notes)


@pytest.mark.parametrize(("suffix", "old", "new"), [(".urdf", '"0.5"', '"high"'), (".sdf", ">0.2<", ">-0.2<")])
def test_invalid_coefficients_are_refused_if_dissipation_is_read(
    tmp_path: Path, suffix: str, old: str, new: str
) -> None:
    path = written(tmp_path, suffix, FILES[suffix].replace(old, new))
    assert any("ignored" in note for note in sf.load(path).notes)
    with pytest.raises(sf.DescriptionError, match="joint 'q': its (damping|friction) is no coefficient"):
        sf.load(path, dissipation="all")


@pytest.mark.parametrize("asked", [{"floating_base": True}, {"dissipation": "all"}, {"limits": "stops"}])
def test_native_files_accept_no_import_options(tmp_path: Path, asked: dict[str, Any]) -> None:
    sf.save(sf.load(written(tmp_path, ".urdf")), tmp_path / "r.yaml")
    with pytest.raises(sf.DescriptionError, match=f"{next(iter(asked))} applies to URDF, xacro, SDF, MJCF and USD"):
        sf.load(tmp_path / "r.yaml", **asked)


@pytest.mark.parametrize(("asked", "meant"), [({"dissipation": "viscos"}, "viscous"), ({"limits": "stop"}, "stops")])
def test_an_unknown_choice_is_refused(tmp_path: Path, asked: dict[str, Any], meant: str) -> None:
    path = written(tmp_path, ".urdf")
    for read in (sf.load, load_with_sources):  # The second by commands.
        with pytest.raises(sf.ArgumentError, match=f"did you mean '{meant}'"):
            read(path, **asked)


def test_bodies_are_left_out_by_name() -> None:
    """The others in their order; a name that no body has is refused."""
    names = ("a", "b", "c", "d")
    system = sf.System("s", [sf.RigidBody(name, sf.Joint(f"q{name}", "revolute"), sf.Inertia(1.0)) for name in names])
    assert [body.name for body in system.without_bodies("c", "a").bodies] == ["b", "d"]
    with pytest.raises(sf.DescriptionError, match="nobody"):
        system.without_bodies("a", "nobody")
