"""One mechanism stated in two ways is the same; what is beyond a comparison is refused."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from tests.studio.differences.planted import CREATURE
from tests.studio.differences.restated import restated
from tests.studio.differences.test_planted import read_original

COORDINATES = ("coordinates",)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("options", ["names", "frames", "zeros", "fuse", "names frames zeros fuse"])
@pytest.mark.parametrize("robot", ["ur5", "panda", "go2", "icub"])
def test_a_restated_mechanism_is_the_same(robot: str, options: str, seed: int) -> None:
    system = replace(read_original(robot), constraints=())  # Formulas name coordinates.
    asked = {name: name in options.split() for name in ("names", "frames", "zeros", "fuse")}
    found = sf.diff(system, restated(system, seed, **asked))
    assert found.same, str(found)
    assert max(found.errors.values()) < 1e-12
    # Of the fingers either is the other's counterpart, with other limits.
    beyond = [item for item in found.differences if item.changes != COORDINATES and "finger" not in item.joint]
    assert not beyond, str(found)
    assert "zeros" in options or "zero of the coordinate" not in {item.entry for item in found.differences}
    assert all(len(line) <= 80 for line in str(found).splitlines())


def pendulum(**joint: object) -> sf.System:
    stated = {"axis": (0, 1, 0), "limits": sf.Limits(-1.0, 2.0)} | joint
    inertia = sf.Inertia(2.0, (0.1, 0.0, 0.5), (0.3, 0.2, 0.1))
    return sf.System("p", (sf.RigidBody("arm", sf.Joint("turn", "revolute", **stated), inertia),))  # type: ignore[arg-type]


DRY = sf.Friction(0.2, 0.3, 0.01, stribeck_velocity=0.1)
# Entry that differs -> elements of the first and of the second, and what they change.
ELEMENTS: dict[str, tuple[tuple[object, ...], tuple[object, ...], str]] = {
    "damping": ((), (sf.Damper(0.2),), "dissipation"),
    "friction": ((), (sf.Friction(0.2),), "dissipation"),
    "static friction": ((DRY,), (replace(DRY, static=0.4),), "dissipation"),
    "smoothing of friction": ((DRY,), (replace(DRY, minimum_velocity=0.02),), "dissipation"),
    "Stribeck speed": ((DRY,), (replace(DRY, stribeck_velocity=0.2),), "dissipation"),
    "sticking": ((DRY,), (replace(DRY, sticks=True),), "dissipation"),
    "stiffness": ((), (sf.Spring(3.0),), "springs"),
    "rest of the spring": ((sf.Spring(2.0, 0.1), sf.Spring(3.0)), (sf.Spring(5.0),), "springs"),
    "push of the springs": ((sf.Spring(1.0, 0.0, 1.0),), (sf.Spring(1.0, 0.5), sf.Spring(0.0, 0.0, 1.0)), "springs"),
}


@pytest.mark.parametrize("entry", ELEMENTS)
def test_other_elements_leave_the_mechanism_the_same(entry: str) -> None:
    one, other, changes = ELEMENTS[entry]
    found = sf.diff(pendulum(elements=one), pendulum(elements=other))
    first = found.first_difference
    assert found.same and not found.identical and first is not None
    assert (first.entry, first.joint, first.link, first.changes) == (entry, "turn", "arm", (changes,))


SPRINGS = (sf.Spring(2.0, 0.3, 4.0), sf.Spring(5.0, -0.2), sf.Spring(0.0, 0.7, 3.0))


def test_elements_of_the_same_force_are_the_same() -> None:
    """Springs in parallel are one; the viscous part of friction is a damper. Coordinates of the second are 0.4 - q."""
    apart = (*SPRINGS, sf.Friction(0.2, viscous=0.5), sf.Damper(0.1))
    assert sf.diff(pendulum(elements=apart), pendulum(elements=apart[::-1])).identical
    damped = (*SPRINGS, sf.Friction(0.2), sf.Damper(0.6))
    assert sf.diff(pendulum(elements=apart), pendulum(elements=damped)).identical
    turned = [replace(spring, rest=0.4 - float(spring.rest)) for spring in SPRINGS]  # type: ignore[arg-type]
    placed = sf.Rotation.axis_angle((0, 1, 0), 0.4)
    other = pendulum(elements=turned, axis=(0, -1, 0), rotation=placed, limits=sf.Limits(-1.6, 1.4))
    found = sf.diff(pendulum(elements=SPRINGS), other)
    ((_, _, sign, offset),) = found.coordinates
    assert sign == -1.0 and offset == pytest.approx(0.4)
    assert {item.changes for item in found.differences} == {COORDINATES}, str(found)


@pytest.mark.parametrize(
    ("stated", "note"),
    [
        ({"elements": (sf.Stop(500.0, 5.0, -1.0, 1.0),)}, "elements of joints: turn (Stop)"),
        ({"elements": (sf.LuGre(1.0, 50.0),)}, "elements of joints: turn (LuGre)"),
        ({"effort": ("-3*turn",)}, "efforts by formula dropped: turn"),
        ({"actuated": True}, "those driven in one alone: turn"),
    ],
)
def test_what_a_joint_has_beside_its_entries_is_noted(stated: dict[str, object], note: str) -> None:
    for pair in ((pendulum(), pendulum(**stated)), (pendulum(**stated), pendulum())):
        (said,) = sf.diff(*pair).notes
        assert note in said
    assert not sf.diff(pendulum(), pendulum()).notes


def test_the_sign_of_a_coordinate_takes_its_limits_along() -> None:
    found = sf.diff(pendulum(), pendulum(axis=(0, -1, 0), limits=sf.Limits(-2.0, 1.0)))
    assert found.same and found.coordinates == (("turn", "turn", -1.0, 0.0),)
    assert [item.changes for item in found.differences] == [COORDINATES]
    kept = sf.diff(pendulum(), pendulum(axis=(0, -1, 0)))
    assert {item.entry for item in kept.differences} == {"sign of the coordinate", "lower limit", "upper limit"}


@pytest.mark.parametrize("offset", [0.4, 2.8, -2.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_signs_of_coordinates_are_seen_beyond_another_zero(offset: float, sign: float) -> None:
    """Where the second file has its zero half a turn away, axes beyond that joint point the other way in its world."""

    def arm(offset: float, sign: float) -> sf.System:
        inertia = sf.Inertia(2.0, (0.1, 0.2, 0.5), (0.3, 0.2, 0.1))
        yaw = sf.Joint("yaw", "revolute", rotation=sf.Rotation.rpy(0, 0, offset), axis=(0, 0, 1))
        pitch = sf.Joint("pitch", "revolute", "base", position=(0.3, 0.1, 0.2), axis=(sign, 0, 0))
        return sf.System("arm", (sf.RigidBody("base", yaw, inertia), sf.RigidBody("upper", pitch, inertia)))

    found = sf.diff(arm(0.0, 1.0), arm(offset, sign))
    assert found.same and max(found.errors.values()) < 1e-12, str(found)
    assert {name: way for name, _, way, _ in found.coordinates} == {"yaw": 1.0} | ({} if sign > 0 else {"pitch": -1.0})


def test_differences_that_change_no_motion_are_marked() -> None:
    """A body that turns about a vertical axis alone shows its moment about that axis, and nothing else."""
    one, two = pendulum(axis=(0, 0, 1)), pendulum(axis=(0, 0, 1))
    (body,) = two.bodies
    changed = replace(two, bodies=(replace(body, inertia=sf.Inertia(2.0, (0.1, 0.0, 0.7), (0.35, 0.2, 0.1))),))  # type: ignore[arg-type]
    found = sf.diff(one, changed)
    assert found.same and found.identical and [item.changes for item in found.differences] == [(), ()]
    assert "nothing that can be observed" in str(found)


def test_which_file_is_likelier_right() -> None:
    def legs(mass: float, moments: tuple[float, float, float]) -> sf.System:
        bodies = [
            sf.RigidBody(
                name,
                sf.Joint(f"hip_{name}", "revolute", position=(0, y, 0), axis=(0, 1, 0)),
                sf.Inertia(mass if y > 0 else 1.3, (0, 0, -0.2), moments if y > 0 else (0.3, 0.3, 0.1)),
            )
            for name, y in {"left": 0.1, "right": -0.1}.items()
        ]
        return sf.System("legs", tuple(bodies))

    good = legs(1.3, (0.3, 0.3, 0.1))
    twin = sf.diff(legs(1.4, (0.3, 0.3, 0.1)), good).first_difference
    assert twin is not None and (twin.entry, twin.link, twin.likelier) == ("mass", "left", 1) and "right" in twin.reason
    waived = tuple(replace(body, waive=("nonphysical_inertia",)) for body in legs(1.3, (0.9, 0.3, 0.1)).bodies)
    bad = replace(good, bodies=waived)
    impossible = sf.diff(good, bad).first_difference
    assert impossible is not None and (impossible.entry, impossible.likelier) == ("inertia", 0)
    assert "no distribution of mass" in impossible.reason


def test_constraints_are_compared_in_the_coordinates_of_the_first() -> None:
    def fingers(ratio: float, sign: float = 1.0, scale: float = 1.0) -> sf.System:
        inertia = sf.Inertia(1.0, (0.1, 0, 0.2), (0.1, 0.2, 0.15))
        bodies = [
            sf.RigidBody(f"f{k}", sf.Joint(f"q{k}", "prismatic", axis=(0, (1, sign)[k], 0)), inertia) for k in (0, 1)
        ]
        coupling = sf.Coupling("mimic", sf.formula(f"{scale}*(q1 - {sign}*{ratio}*q0)"))
        return sf.System("hand", tuple(bodies), constraints=(coupling,))

    assert sf.diff(fingers(2.0), fingers(2.0, scale=3.0)).same
    assert sf.diff(fingers(2.0), fingers(2.0, sign=-1.0)).same
    found = sf.diff(fingers(2.0), fingers(2.5))
    assert not found.same and found.differences[0].changes == ("constraints",)


def test_the_command_compares_two_files(tmp_path: Path) -> None:
    def ran(*words: object) -> tuple[int, str]:
        done = CliRunner().invoke(app, ["diff", *map(str, words)])
        return done.exit_code, done.output

    exported = [file for file in sf.export(sf.load(CREATURE), "mjcf", tmp_path / "out").files if file.suffix == ".xml"]
    damped = tmp_path / "damped.xml"
    damped.write_text(CREATURE.read_text().replace('damping="0.1"', 'damping="0.15"'))
    heavy = tmp_path / "heavy.xml"
    heavy.write_text(CREATURE.read_text().replace('mass="0.6"', 'mass="0.7"'))
    code, text = ran(CREATURE, *exported, damped, heavy)
    assert code == 1 and "mass of link 'tail'" in " ".join(text.split())
    assert all(len(line) <= 80 for line in text.splitlines())
    assert ran(CREATURE, damped)[0] == 0 and ran(CREATURE, damped, "--strict")[0] == 1
    code, text = ran(CREATURE, heavy, "--json")
    (compared,) = json.loads(text)["comparisons"]
    first = compared["differences"][0]
    assert code == 1 and (first["entry"], first["link"], first["here"], first["there"]) == ("mass", "tail", 0.6, 0.7)
    assert math.isclose(compared["errors"]["kinematics"], 0.0, abs_tol=1e-12)


def test_many_equal_bodies_take_bounded_work() -> None:
    """Renamed joints of one body are matched by their order where they are too many to weigh against each other."""
    rng = np.random.default_rng(0)
    joints = [(f"a{k}", tuple(rng.normal(size=3)), tuple(rng.normal(size=3))) for k in range(60)]

    def star(prefix: str) -> sf.System:
        inertia = sf.Inertia(1.0, (0.1, 0, 0.2), (0.1, 0.2, 0.15))
        bodies = [
            sf.RigidBody(prefix + name, sf.Joint(f"j{prefix}{name}", "revolute", position=p, axis=axis), inertia)
            for name, p, axis in joints
        ]
        return sf.System("star", tuple(bodies))

    assert sf.diff(star("x"), star("y")).same
    with pytest.raises(sf.DescriptionError, match="too many bodies"):
        many = tuple(sf.RigidBody(f"b{k}", sf.Joint(f"j{k}", "revolute")) for k in range(1001))
        sf.diff(sf.System("many", many), star("x"))


def test_parts_that_are_not_compared_are_noted(tmp_path: Path) -> None:
    """Actuators, and couplings that a reader leaves out."""
    pytest.importorskip("mujoco")
    body = '<body><joint name="j"/><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/></body>'
    for name, more in (("plain", ""), ("driven", '<actuator><motor joint="j" gear="3"/></actuator>')):
        (tmp_path / f"{name}.xml").write_text(f"<mujoco><worldbody>{body}</worldbody>{more}</mujoco>")
    found = sf.diff(tmp_path / "plain.xml", tmp_path / "driven.xml")
    assert found.same and found.notes == ("actuators are not compared: 0 in the first, 1 in the second",)
    assert sf.diff(tmp_path / "plain.xml", tmp_path / "plain.xml").notes == ()
    robot, ignored = sf.load(tmp_path / "plain.xml"), "API schema NewtonMimicAPI ignored: 1 joint (j)"
    assert sf.diff(robot, replace(robot, notes=(ignored,))).notes == (f"plain: {ignored}",)


@pytest.mark.parametrize("robot", ["ur5", "go2"])
def test_bodies_that_are_stated_before_their_parents_change_nothing(robot: str) -> None:
    system = replace(read_original(robot), constraints=())
    found = sf.diff(system, replace(system, bodies=system.bodies[::-1]))
    assert found.same and found.identical and max(found.errors.values()) < 1e-12, str(found)
