"""USD by UsdPhysics: units, frames and directions of joints, mass properties, loops; what is refused or remarked."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.base.arrays import Array
from symofros.description.usd import stage as usd_stage
from symofros.description.usd.masses import _unit_shape
from symofros.description.usd.reader import names_of
from symofros.description.usd.usd_worker import shortest
from tests.description.usd.models import ARM, HALF, LOCKED, body, freedoms, joint, placed, prim, shape, stage
from tests.late import require

require("pxr.Usd", "usd")

Load = Callable[[str], sf.System]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    def read(text: str) -> sf.System:
        file = tmp_path / "robot.usda"
        file.write_text(text)
        return sf.load(file)

    return read


def dynamics(system: sf.System, q: list[float], v: list[float]) -> tuple[Any, Any]:
    model = sf.compile(system, sf.Options(backend="interpreter"))
    return model.mass_matrix(np.array(q)), model.bias(np.array(q), np.array(v))


def arm(**options: Any) -> sf.System:
    """One link on the world, by our own description."""
    joint = sf.Joint("hinge", "revolute", axis=(0.0, 1.0, 0.0), position=(0.5, 0.0, 1.0), actuated=True)
    inertia = sf.Inertia(2.0, (0.1, 0.2, -0.3), (0.3, 0.4, 0.5))
    return sf.System("robot", (sf.RigidBody("arm", joint, inertia),), **options)


def hinge(**changes: Any) -> str:
    stated: dict[str, Any] = {"axis": "Y", "localPos0": (0.5, 0.0, 1.0)} | changes
    return joint("Revolute", "hinge", "", "arm", **stated)


def test_a_hinged_link_has_the_stated_inertia_and_limits(load: Load) -> None:
    system = load(stage(body("arm", at=(0.5, 0, 1), **ARM), hinge(lowerLimit=-90.0, upperLimit=45.0)))
    (link,) = system.bodies
    assert link.joint is not None and link.joint.kind == "revolute" and link.joint.actuated
    assert link.joint.limits is not None and link.joint.limits.lower == pytest.approx(-math.pi / 2, abs=1e-15)
    for mine, stated in zip(dynamics(system, [0.4], [0.7]), dynamics(arm(), [0.4], [0.7]), strict=True):
        np.testing.assert_allclose(mine, stated, rtol=1e-15)


@pytest.mark.parametrize("kind", ["Revolute", "Prismatic"])
def test_a_joint_stated_from_child_to_parent_is_the_same_joint(load: Load, kind: str) -> None:
    """Coordinates, limits and directions stay: only who carries whom is turned round."""
    base = body("base", mass=5.0, diagonalInertia=(1, 2, 3), centerOfMass=(0, 0, 0))
    link = body("arm", at=(0.5, 0, 1), **ARM)
    own = {"axis": "X", "localPos0": (0.5, 0.0, 1.0), "localRot0": (HALF, 0.0, HALF, 0.0), "lowerLimit": -1.0}
    other = {"axis": "X", "localPos1": (0.5, 0.0, 1.0), "localRot1": (HALF, 0.0, HALF, 0.0), "lowerLimit": -1.0}
    fixed = joint("Fixed", "clamp", "", "base")
    straight = load(stage(base, link, fixed, joint(kind, "j", "base", "arm", **own)))
    turned = load(stage(base, link, fixed, joint(kind, "j", "arm", "base", **other)))
    # Seen from the arm, the base moves by q: so the arm moves on the base by -q.
    (M, h), (N, k) = dynamics(straight, [0.3], [0.7]), dynamics(turned, [-0.3], [-0.7])
    np.testing.assert_allclose(N, M, rtol=1e-14)
    np.testing.assert_allclose(k, -h, atol=1e-13)


def test_a_body_pivoting_off_its_origin_has_the_stated_pose(load: Load) -> None:
    turned = (HALF, 0.0, 0.0, HALF)  # About z by a right angle.
    text = stage(
        body("arm", at=(0.5, -0.25, 0), **ARM),
        joint("Revolute", "j", "", "arm", axis="Z", localPos0=(0.5, 0, 0), localPos1=(0.25, 0, 0), localRot1=turned),
    )
    model = sf.compile(load(text), sf.Options(backend="interpreter"))
    assert model.nv == 1 and [b.name for b in load(text).bodies] == ["arm_at_j", "arm"]
    for angle in (0.0, 0.7):
        p, R = model.frame_pose("arm", np.array([angle]))
        # J1 stands at 90 degrees in the arm: the arm at -90 degrees where the coordinate is zero.
        own = angle - math.pi / 2
        np.testing.assert_allclose(R[:2, 0], [math.cos(own), math.sin(own)], atol=1e-15)
        np.testing.assert_allclose(p + R @ [0.25, 0, 0], [0.5, 0, 0], atol=1e-15)


KINDS: dict[str, set[str]] = {
    "fixed": set(),
    "continuous": {"rotY"},
    "prismatic": {"transZ"},
    "ball": {"rotX", "rotY", "rotZ"},
    "cylindrical": {"rotY", "transY"},
    "planar": {"transX", "transZ", "rotY"},
}


def test_free_directions_select_the_joint_kind(load: Load) -> None:
    names = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
    bodies, joints = [body(kind, **ARM) for kind in KINDS], []
    for kind, free in KINDS.items():
        joints.append(joint("", f"on_{kind}", "", kind, **freedoms({n: LOCKED for n in names if n not in free})))
    system = load(stage(*bodies, *joints))
    made = {item.joint.name: item.joint.kind for item in system.bodies if item.joint is not None}
    assert {f"on_{kind}": kind for kind in KINDS}.items() <= made.items()
    # The normal of the planar joint is y of the joint, z of ours.
    model = sf.compile(system, sf.Options(backend="interpreter"))
    q = model.neutral()
    q[[list(model.names.q).index(f"on_planar.{name}") for name in ("x", "y", "angle")]] = 0.2, 0.3, 0.5
    p, R = model.frame_pose("planar", q)
    assert p[1] == pytest.approx(0.0, abs=1e-15) and R[1, 1] == pytest.approx(1.0)


def test_a_joint_outside_the_articulation_closes_the_loop(load: Load) -> None:
    """A parallelogram: the closure holds where it stands, and leaves one freedom."""
    light = {"mass": 1.0, "centerOfMass": (0, 0, 0), "diagonalInertia": (0.1, 0.1, 0.1)}
    text = stage(
        body("left", at=(0, 0, 0), **light),
        body("right", at=(1, 0, 0), **light),
        body("top", at=(0, 1, 0), **light),
        joint("Revolute", "a", "", "left", axis="Z"),
        joint("Revolute", "b", "", "right", axis="Z", localPos0=(1, 0, 0)),
        joint("Revolute", "c", "left", "top", axis="Z", localPos0=(0, 1, 0)),
        joint(
            "Revolute",
            "d",
            "top",
            "right",
            axis="Z",
            localPos0=(1, 0, 0),
            localPos1=(0, 1, 0),
            excludeFromArticulation=True,
        ),
    )
    system = load(text)
    assert [constraint.name for constraint in system.constraints] == ["d"]
    model = sf.compile(system, sf.Options(backend="interpreter"))
    names = list(model.names.q)
    q = np.array([{"a": 0.3, "b": 0.3, "c": -0.3}[name] for name in names])
    assert np.abs(model.constraint(q)).max() < 1e-15
    assert np.linalg.matrix_rank(model.constraint_jacobian(q)) == 2


@pytest.mark.parametrize(
    ("kind", "sizes", "solid"),
    [
        ("Cube", {"size": 0.5}, sf.solids.box(1000.0, 0.5, 0.5, 0.5)),
        ("Sphere", {"radius": 0.5}, sf.solids.sphere(1000.0, 0.5)),
        ("Cylinder", {"radius": 0.2, "height": 0.7, "axis": "X"}, sf.solids.cylinder(1000.0, 0.2, 0.7, axis="x")),
    ],
)
def test_omitted_mass_properties_follow_from_collision_shapes(
    load: Load, kind: str, sizes: dict[str, Any], solid: sf.Inertia
) -> None:
    (made,) = load(stage(body("arm", shape(kind, "c", **sizes)))).bodies
    assert isinstance(made, sf.RigidBody) and made.inertia is not None
    assert made.inertia.mass == pytest.approx(solid.mass, rel=1e-14)
    assert made.inertia.moments == pytest.approx(solid.moments, rel=1e-14)


def test_mass_takes_precedence_over_density_of_shape_and_body(load: Load) -> None:
    own, both = "float physics:density = 20", {"density": 10.0}
    stated: list[tuple[float, tuple[str, ...], dict[str, float]]] = [
        (1000.0, (), {}),
        (10.0, (), both),
        (3.0, (), {"mass": 3.0} | both),
        (20.0, (own,), both),
        (7.0, ("float physics:mass = 7", own), both),
    ]
    bodies = [body(f"b{k}", shape("Cube", "c", *on, size=1.0), **of) for k, (_, on, of) in enumerate(stated)]
    masses = [
        made.inertia.mass for made in load(stage(*bodies)).bodies if isinstance(made, sf.RigidBody) and made.inertia
    ]
    assert masses == [mass for mass, *_ in stated]


def test_mass_properties_of_shapes_are_those_that_usd_computes(load: Load, tmp_path: Path) -> None:
    """Mass, centre and moments that a shape states of itself, beside one that states none; a mesh states all it has."""
    own = ("float physics:mass = 3", "point3f physics:centerOfMass = (0.1, 0.2, -0.3)")
    own += ("float3 physics:diagonalInertia = (0.3, 0.4, 0.5)", "quatf physics:principalAxes = (0.8, 0.6, 0, 0)")
    turned = ("double3 xformOp:translate = (1, 2, 3)", "quatf xformOp:orient = (0.6, 0, 0.8, 0)")
    turned += ('uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]',)
    schemas = ("PhysicsCollisionAPI", "PhysicsMassAPI")
    for kind in ("Cube", "Mesh"):
        first = prim(kind, "first", *own, *turned, schemas=schemas)
        text = stage(body("b", first, shape("Cube", "second", size=0.5)))
        (made,) = load(text).bodies
        assert isinstance(made, sf.RigidBody) and made.inertia is not None
        mass, moments, center, axes = _computed(text, tmp_path)
        assert made.inertia.mass == pytest.approx(mass, rel=1e-6)
        assert made.inertia.center_of_mass == pytest.approx(center, rel=1e-6)
        xx, yy, zz, xy, xz, yz = made.inertia.moments
        stated = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        np.testing.assert_allclose(stated, axes @ np.diag(moments) @ axes.T, rtol=1e-5)


def _computed(text: str, folder: Path) -> tuple[float, Array, Array, Array]:
    """Mass, principal moments, centre and axes of body b by OpenUSD itself, in single precision."""
    from pxr import Gf, Usd, UsdGeom, UsdPhysics

    (folder / "computed.usda").write_text(text)
    opened = Usd.Stage.Open(str(folder / "computed.usda"))
    robot, places = opened.GetPrimAtPath("/robot/b"), UsdGeom.XformCache()

    def of_shape(shape: Any) -> Any:
        """Mass properties of a cube of unit density: the first one states its own."""
        size, known = (0.5 if shape.GetName() == "second" else 1.0), UsdPhysics.RigidBodyAPI.MassInformation()
        moment = size**5 / 6.0
        place = places.ComputeRelativeTransform(shape, robot)[0]
        known.volume, known.inertia = size**3, Gf.Matrix3f(moment, 0, 0, 0, moment, 0, 0, 0, moment)
        known.centerOfMass, known.localPos = Gf.Vec3f(0.0), Gf.Vec3f(place.ExtractTranslation())
        known.localRot = Gf.Quatf(place.ExtractRotationQuat())
        return known

    mass, moments, center, turn = UsdPhysics.RigidBodyAPI(robot).ComputeMassProperties(of_shape)
    return mass, np.array(moments), np.array(center), np.array(Gf.Matrix3d(Gf.Quatd(turn))).T


@pytest.mark.parametrize("axis", "XYZ")
@pytest.mark.parametrize("kind", ["Cylinder", "Capsule", "Cone"])
def test_integrals_of_revolution_match_sums_over_slices(kind: str, axis: str) -> None:
    r, h, n = 0.3, 0.8, 200_001
    half = h / 2 + (r if kind == "Capsule" else 0.0)
    z = np.linspace(-half, half, n)
    if kind == "Cone":
        radius = r * (0.5 - z / h)
    elif kind == "Capsule":
        radius = np.sqrt(np.maximum(r * r - np.maximum(np.abs(z) - h / 2, 0.0) ** 2, 0.0))
    else:
        radius = np.full(n, r)
    area = math.pi * radius**2
    volume = np.trapezoid(area, z)
    center = np.trapezoid(area * z, z) / volume
    across = np.trapezoid(area * radius**2 / 4.0, z)
    along = np.trapezoid(area * (z - center) ** 2, z)
    extent = _unit_shape(kind, {"radius": r, "height": h, "axis": axis})
    assert extent is not None
    k = "XYZ".index(axis)
    assert extent.size == pytest.approx(volume, rel=1e-9) and extent.center[k] == pytest.approx(center, abs=1e-9)
    assert np.diag(extent.E) == pytest.approx(np.where(np.arange(3) == k, along, across), rel=1e-8)


def test_shapes_scale_shift_and_add_up(load: Load) -> None:
    """Two halves of a box, one of them scaled from a cube, are the box."""
    halves = (shape("Cube", f"c{k}", *placed((x, 0, 0), scale=(1, 2, 3)), size=1.0) for k, x in enumerate((-0.5, 0.5)))
    (made,) = load(stage(body("arm", *halves))).bodies
    whole = sf.solids.box(1000.0, 2.0, 2.0, 3.0)
    assert isinstance(made, sf.RigidBody) and made.inertia is not None
    assert made.inertia.mass == pytest.approx(whole.mass) and made.inertia.moments == pytest.approx(whole.moments)


def test_bodies_without_joints_are_fixed_or_floating(load: Load) -> None:
    text = stage(
        body("table", at=(0, 0, 1), kinematicEnabled=True, **ARM),
        body("ball", at=(0, 0, 2), velocity=(1, 0, 0), **ARM),
        joint("Revolute", "off", "table", "ball", jointEnabled=False),
    )
    system = load(text)
    kinds = {b.name: b.joint.kind for b in system.bodies if b.joint is not None}
    assert kinds == {"table": "fixed", "ball": "free"}
    notes = " ".join(system.notes)
    for words in ("kinematic or not enabled", "float", "velocities of bodies ignored", "not enabled ignored: 1 joint"):
        assert words in notes


def test_prims_get_the_shortest_unique_names() -> None:
    paths = ("/a/arm/link", "/b/arm/link", "/b/hand", "/world")
    assert names_of(paths) == dict(zip(paths, ("a_arm_link", "b_arm_link", "hand", "world_"), strict=True))


@pytest.mark.parametrize("stated", [0.089159, 0.1, 1.3877788e-17, 0.70710677, 3.0, -12.5])
def test_single_precision_numbers_read_as_their_text(stated: float) -> None:
    single = float(np.float32(stated))
    assert shortest(single, True) == pytest.approx(stated, rel=0.0, abs=0.0)
    assert shortest(single, False) == single


def test_layers_of_other_folders_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret.usda").write_text(stage(body("arm", **ARM)))
    inside = tmp_path / "model"
    inside.mkdir()
    file = inside / "robot.usda"
    file.write_text("#usda 1.0\n(\n    subLayers = [@../secret.usda@]\n)\n")
    with pytest.raises(sf.DescriptionError, match="files of other folders"):
        sf.load(file)
    (inside / "own.usda").write_text(stage(body("arm", **ARM)))
    file.write_text("#usda 1.0\n(\n    subLayers = [@./own.usda@]\n)\n")
    assert sf.load(file).bodies[0].name == "arm"


@pytest.mark.parametrize(
    "data", [b"", b"#usda 1.0\n(", b"PXR-USDC" + bytes(200), b"PK\x03\x04" + bytes(50), b"\x00" * 99]
)
def test_damaged_usd_files_are_refused(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "robot.usd"
    file.write_bytes(data)
    with pytest.raises(sf.DescriptionError, match="OpenUSD can't read|no rigid body"):
        sf.load(file)


def test_faults_of_a_stage_name_its_line_and_no_place_in_openusd(tmp_path: Path) -> None:
    """The line in the file stood behind names of OpenUSD's own functions and files."""
    file = tmp_path / "robot.usda"
    file.write_text('#usda 1.0\ndef Xform "a" { double mass = 2 double other = 3 }\n')
    with pytest.raises(sf.DescriptionError, match=r"found: .*robot\.usda:2:") as caught:
        sf.load(file)
    assert "pxrInternal" not in str(caught.value) and "u0009" not in str(caught.value)


def test_a_missing_or_slow_usd_reader_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "robot.usda"
    file.write_text(stage(body("arm", **ARM)))
    monkeypatch.setattr(usd_stage, "_answer", lambda _: {"absent": "usd-core"})
    with pytest.raises(sf.DescriptionError, match=r"symofros\[usd\]"):
        sf.load(file)
    monkeypatch.undo()
    monkeypatch.setattr(usd_stage, "TIMEOUT", 0.001)
    with pytest.raises(sf.DescriptionError, match=r"longer than 0.001 s"):
        sf.load(file)


def test_visual_shapes_become_placed_solids(load: Load) -> None:
    color = "color3f[] primvars:displayColor = [(1, 0, 0)]"
    ball = prim("Sphere", "s", "double radius = 0.5", color, *placed((1, 2, 3)))
    system = load(stage(body("arm", ball, at=(5, 5, 5), **ARM)))
    (seen,) = system.visuals["arm"]
    assert (seen.kind, seen.size, seen.position, seen.color) == ("sphere", (0.5,), (1.0, 2.0, 3.0), (255, 0, 0))
