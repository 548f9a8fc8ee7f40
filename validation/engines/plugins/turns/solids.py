"""Solids: their moments, distances of two, rays that meet them, in each engine's own words.

Quaternions and placements are as in each engine's rotations.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from ...truth.geometry.poses import MASS
from ...truth.geometry.shapes import BEYOND, DISTANCES, HALF, HEIGHT, INSIDE, MET, RADIUS, SCALES, SIDES, WITHIN
from ..writing.source import Way, ways_of

# Solid -> radius and half length, half sides or semi-axes; the same with whole lengths and sides.
_HALVES = {
    "ball": (RADIUS,),
    "capsule": (RADIUS, HALF),
    "cylinder": (RADIUS, HALF),
    "box": SIDES,
    "ellipsoid": SIDES,
}
_WHOLES = _HALVES | {
    "capsule": (RADIUS, 2 * HALF),
    "cylinder": (RADIUS, 2 * HALF),
    "box": tuple(2 * side for side in SIDES),
}
_BEYOND = f"tau + {list(BEYOND)}"
# Sizes of the solids that moments are asked of.
_X = "x = np.abs(v) + 0.5\n"


def _texts(form: str, sizes: Mapping[str, tuple[float, ...]], solids: str, between: str = ", ") -> dict[str, str]:
    """Solids' texts by a form with places for the name and the sizes; without balls called Sphere, as all call them."""
    names = {"ball": "sphere"}
    return {one: form.format(names.get(one, one), between.join(map(repr, sizes[one]))) for one in solids.split()}


def _distances(native: str, solids: Mapping[str, str], text: str, name: str = "") -> dict[str, Way]:
    """Distances of the pairs of an engine's solids.

    Args:
        native: What the engine calls them.
        solids: Solid -> its text.
        text: Code with ONE and OTHER for both texts.
        name: Name of a second way.
    """
    return {
        f"distance_{one}_{other}{name}": Way(native, text.replace("ONE", solids[one]).replace("OTHER", solids[other]))
        for one, other in DISTANCES
        if one in solids and other in solids
    }


def _overlaps(
    native: str, solids: Mapping[str, str], text: str, name: str = "", pairs: Iterable[tuple[str, str]] = INSIDE
) -> dict[str, Way]:
    """Signed distances of an engine's solids that overlap: code with ONE and OTHER, and PLACE for where ONE is."""
    return {
        f"distance_{one}_in_{other}{name}": Way(
            native,
            text.replace("ONE", solids[one]).replace("OTHER", solids[other]).replace("PLACE", f"{INSIDE[one, other]}"),
        )
        for one, other in pairs
        if one in solids and other in solids
    }


def _floors(native: str, solids: Mapping[str, str], text: str, name: str = "") -> dict[str, Way]:
    """Signed distances of an engine's solids and a floor: code with SOLID."""
    return {
        f"distance_{one}_to_floor{name}": Way(native, text.replace("SOLID", solids[one]))
        for one in MET
        if one in solids
    }


def _rays(
    native: str, solids: Mapping[str, str], text: str, name: str = "", starts: Iterable[str] = "ow"
) -> dict[str, Way]:
    """Rays that meet an engine's solids.

    Args:
        native: What the engine calls them.
        solids: Solid -> its text.
        text: Code with SOLID for its text and START for the ray's origin, after R: o, or w within the solid.
        name: Name of a second way.
        starts: The origins that it is asked for.
    """
    return {
        f"ray_{'to' if start == 'o' else 'out_of'}_{one}{name}": Way(
            native, text.replace("SOLID", solids[one]).replace("START", start)
        )
        for start in starts
        for one in MET
        if one in solids
    }


def _allowing(ways: Mapping[str, Way], slacks: Mapping[str, float]) -> dict[str, Way]:
    """Ways with what an engine documents that they may be off by: patterns of their names -> part of the value."""
    allowed = {name: slack for pattern, slack in slacks.items() for name in ways if re.fullmatch(pattern, name)}
    return {name: way._replace(slack=allowed.get(name, way.slack)) for name, way in ways.items()}


# Origin o, point w within the solid, unit direction u of the ray, from R.
_LINE = f"o, w = {_BEYOND}, a + R @ {list(WITHIN)}\nu = (w - o) / np.linalg.norm(w - o)\n"

# MuJoCo: geoms of bodies that are placed at run time.
_GEOMS = _texts('type="{}" size="{}"', _HALVES, "ball capsule cylinder box ellipsoid", " ")
_BODY = '<body mocap="true"><geom name="{}" {}/></body>'
_R = "R = np.zeros(9)\nmj.mju_quat2Mat(R, q)\nR = R.reshape(3, 3)\n"


def _mujoco_two(one: str, other: str, poses: str) -> str:
    bodies = _BODY.format("g", one) + _BODY.format("h", other)
    sensor = '<sensor><distance geom1="g" geom2="h" cutoff="100"/></sensor>'
    return (
        f"m = mj.MjModel.from_xml_string('<mujoco><worldbody>{bodies}</worldbody>{sensor}</mujoco>')\n"
        f"d = mj.MjData(m)\nd.mocap_pos[:], d.mocap_quat[:] = {poses}\nmj.mj_forward(m, d)\n"
    )


_APART = _mujoco_two("ONE", "OTHER", f"[a, {_BEYOND}], [q, q2]")
_INSIDE = _R + _mujoco_two("ONE", "OTHER", "[a + R @ PLACE, a], [q, q]")
# Contacts are of bodies that move.
_FREE = "<body><freejoint/><geom {}/></body>"
_CONTACT = (
    "m = mj.MjModel.from_xml_string('<mujoco><worldbody>{}</worldbody></mujoco>')\n"
    "d = mj.MjData(m)\nd.qpos[:] = {}\nmj.mj_forward(m, d)\nvalue = [min(one.dist for one in d.contact)]"
)
_CONTACTS = _R + _CONTACT.format(_FREE.format("ONE") + _FREE.format("OTHER"), "[*a + R @ PLACE, *q, *a, *q]")
_ON_FLOOR = _CONTACT.format('<geom type="plane" size="0 0 1"/>' + _FREE.format("SOLID"), f"[*a[:2], {HEIGHT}, *q]")
_GEOM_DISTANCE = "value = [mj.mj_geomDistance(m, d, 0, 1, 100.0, None)]"
# Size and type, as mju_rayGeom takes them.
_SIZED = {
    one: f"np.array({[*sizes, 0.0, 0.0][:3]}), START, u, mj.mjtGeom.mjGEOM_{'SPHERE' if one == 'ball' else one.upper()}"
    for one, sizes in _HALVES.items()
}
_CAST = (
    f"{_R}{_LINE}m = mj.MjModel.from_xml_string("
    f"'<mujoco><worldbody>{_BODY.format('g', 'SOLID')}</worldbody></mujoco>')\n"
    "d = mj.MjData(m)\nd.mocap_pos[:], d.mocap_quat[:] = [a], [q]\nmj.mj_forward(m, d)\n"
    "value = [3 * mj.mj_ray(m, d, START, 3 * u, None, 1, -1, np.zeros(1, np.int32))]"
)
_COMPILED = (
    f"{_X}m = mj.MjModel.from_xml_string("
    f"f'<mujoco><worldbody><body><freejoint/><geom mass=\"{MASS}\" SOLID/></body></worldbody></mujoco>')\n"
    "R = np.zeros(9)\nmj.mju_quat2Mat(R, m.body_iquat[1])\nR = R.reshape(3, 3)\n"
    "value = np.diag(R @ np.diag(m.body_inertia[1]) @ R.T)"
)
_OF_SIZES = {
    "box": 'type="box" size="{x[0] / 2} {x[1] / 2} {x[2] / 2}"',
    "ellipsoid": 'type="ellipsoid" size="{x[0]} {x[1]} {x[2]}"',
    "ball": 'type="sphere" size="{x[0]}"',
    "shell": 'type="sphere" size="{x[0]}" shellinertia="true"',
    "cylinder": 'type="cylinder" size="{x[0]} {x[1] / 2}"',
    "capsule": 'type="capsule" size="{x[0]} {x[1] / 2}"',
}
# The tetrahedron of `tetrahedron_volume`, by its faces from outside, the last opposite the origin. Vertices of meshes
# are of single precision (mjModel.mesh_vert).
FACES = (0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3)
_FACES = " ".join(map(str, FACES))
_AS_OBJ = " ".join(f"f {' '.join(str(k + 1) for k in FACES[3 * n : 3 * n + 3])}\\n" for n in range(4))
_MESH = (
    'm = mj.MjModel.from_xml_string(f\'<mujoco><asset><mesh name="t" scale="SCALE" {stated}/></asset>'
    '<worldbody><body><freejoint/><geom type="mesh" mesh="t" density="8"/></body></worldbody></mujoco>\', files)\n'
    "R = np.zeros(9)\nmj.mju_quat2Mat(R, m.mesh_quat[0])\nR = R.reshape(3, 3)\n"
)
_STATED = f'{_X}files = {{}}\nstated = f\'vertex="0 0 0 {{x[0]}} 0 0 0 {{x[1]}} 0 0 0 {{x[2]}}" face="{_FACES}"\'\n'
_OF_FILE = (
    f"{_X}text = f'v 0 0 0\\nv {{x[0]}} 0 0\\nv 0 {{x[1]}} 0\\nv 0 0 {{x[2]}}\\n{_AS_OBJ}'\n"
    "files, stated = {'t.obj': text.encode()}, 'file=\"t.obj\"'\n"
)
_OF_MESHES = {
    "volume_of_tetrahedron": "value = [m.body_mass[1] / 8]",
    "centre_of_tetrahedron": "value = m.body_ipos[1]",
    "face_of_tetrahedron": "p, q, r = m.mesh_vert[m.mesh_face[3]] @ R.T\nvalue = np.cross(q - p, r - p) / 2",
}
_WITH_NORMALS = (
    f"{_STATED}n = v + [4.0, 8.0, 8.0]\nstated += ' normal=\"' + ' '.join(map(repr, [*map(float, n)] * 4)) + '\"'\n"
)


def _mujoco_meshes() -> dict[str, Way]:
    ways = {}
    for name, factors in SCALES.items():
        made = _MESH.replace("SCALE", " ".join(map(str, factors)))
        for function, text in _OF_MESHES.items():
            ways[function + name] = Way("mesh vertex, face, scale", _STATED + made + text, slack=1e-6)
            ways[f"{function}{name}:file"] = Way("mesh file, scale", _OF_FILE + made + text, slack=1e-6)
        normal = "value = R @ m.mesh_normal[m.mesh_facenormal[3][0]]"
        ways[f"normal_of_mesh{name}"] = Way("mesh normal, scale", _WITH_NORMALS + made + normal, slack=1e-6)
    return ways


_SYMMETRIC = "d = 1 + v**2 / (1 + v**2)\nA = R @ np.diag(d) @ R.T\nA = (A + A.T) / 2\n"
MUJOCO = (
    _distances("mj_geomDistance", _GEOMS, _APART + _GEOM_DISTANCE)
    | _overlaps("mj_geomDistance", _GEOMS, _INSIDE + _GEOM_DISTANCE)
    | _distances("sensor distance", _GEOMS, f"{_APART}value = d.sensordata", ":sensor")
    | _overlaps("sensor distance", _GEOMS, f"{_INSIDE}value = d.sensordata", ":sensor")
    | _overlaps("mj_collision, contact.dist", _GEOMS, _CONTACTS, ":contact")
    | _floors("mj_collision, contact.dist", _GEOMS, _ON_FLOOR)
    | _mujoco_meshes()
    | _rays("mju_rayGeom", _SIZED, f"{_R}{_LINE}value = [mj.mju_rayGeom(a, R.ravel(), SOLID)]")
    | _rays("mj_ray", _GEOMS, _CAST, ":mj_ray")
    | {
        f"ray_normal_{one}": Way(
            "mju_rayGeom",
            f"{_R}{_LINE}value = np.zeros(3)\nmj.mju_rayGeom(a, R.ravel(), {_SIZED[one].replace('START', 'o')}, value)",
        )
        for one in ("ball", "ellipsoid")
    }
    | {
        f"moments_{one}": Way("geoms that a model is compiled of", _COMPILED.replace("SOLID", text))
        for one, text in _OF_SIZES.items()
    }
    | {
        "principal_moments": Way(
            "mju_eig3",
            f"{_R}{_SYMMETRIC}value = np.zeros(3)\n"
            "mj.mju_eig3(value, np.zeros(9), np.zeros(4), A.ravel())\nvalue = np.sort(value)",
        )
    }
)

# Pinocchio: geometry objects on the world, by coal.
_COAL = {one: text.title() for one, text in _texts("{}({})", _WHOLES, "ball capsule cylinder box ellipsoid").items()}
_PAIR = (
    "import coal\ng = pin.GeometryModel()\n"
    "for name, X, shape in (('one', X, coal.ONE), ('other', Y, coal.OTHER)):\n"
    "    g.addGeometryObject(pin.GeometryObject(name, 0, X, shape))\n"
    "g.addCollisionPair(pin.CollisionPair(0, 1))\ng, n = pin.GeometryData(g), g\n"
    "pin.updateGeometryPlacements(m, d, n, g, pin.neutral(m))\n"
    "pin.computeDistances(n, g)\nvalue = [g.distanceResults[0].min_distance]"
)
_TURN = "R, Q = pin.Quaternion(q).matrix(), pin.Quaternion(q2).matrix()\n"
PINOCCHIO = (
    _distances("computeDistances", _COAL, f"{_TURN}X, Y = pin.SE3(R, a), pin.SE3(Q, {_BEYOND})\n{_PAIR}")
    | _overlaps("computeDistances", _COAL, f"{_TURN}X, Y = pin.SE3(R, a + R @ PLACE), pin.SE3(R, a)\n{_PAIR}")
    | _floors(
        "computeDistances",
        _COAL,
        f"{_TURN}X, Y = pin.SE3(R, np.array([*a[:2], {HEIGHT}])), pin.SE3.Identity()\n"
        + _PAIR.replace("ONE", "SOLID").replace("OTHER", "Halfspace(0.0, 0.0, 1.0, 0.0)"),
    )
    | {
        f"moments_{one}": Way(
            f"Inertia.From{of.partition('(')[0]}", f"{_X}value = np.diag(pin.Inertia.From{of}.inertia)"
        )
        for one, of in {
            "box": f"Box({MASS}, *x)",
            "ellipsoid": f"Ellipsoid({MASS}, *x)",
            "ball": f"Sphere({MASS}, x[0])",
            "cylinder": f"Cylinder({MASS}, x[0], x[1])",
            "capsule": f"Capsule({MASS}, x[0], x[1])",
        }.items()
    }
    | {
        f"moments_{one}:coal": Way(
            "computeMomentofInertiaRelatedToCOM, computeVolume",
            f"import coal\n{_X}shape = coal.{of}\n"
            f"value = {MASS} * np.diag(shape.computeMomentofInertiaRelatedToCOM()) / shape.computeVolume()",
        )
        for one, of in {
            "box": "Box(*x)",
            "ellipsoid": "Ellipsoid(*x)",
            "ball": "Sphere(x[0])",
            "cylinder": "Cylinder(x[0], x[1])",
            "capsule": "Capsule(x[0], x[1])",
        }.items()
    }
)

# Drake: geometries of a scene that stand in the world; moments by unit inertias.
_DRAKE = {one: text.title() for one, text in _texts("{}({})", _WHOLES, "ball capsule cylinder box ellipsoid").items()}
_SCENE = (
    "scene = drake.SceneGraph()\nsource = scene.RegisterSource('s')\n"
    "def placed(name, X, shape):\n"
    "    made = scene.RegisterGeometry(source, scene.world_frame_id(), drake.GeometryInstance(X, shape, name))\n"
    "    scene.AssignRole(source, made, drake.ProximityProperties())\n    return made\n"
)
_QUERY = "query = scene.get_query_output_port().Eval(scene.CreateDefaultContext())\n"
_SIGNED = f"{_QUERY}value = [query.ComputeSignedDistancePairClosestPoints(one, other).distance]"
_TO_POINT = (
    f"other = placed('other', Y, drake.OTHER)\n{_QUERY}"
    f"value = [query.ComputeSignedDistanceToPoint(p)[0].distance - {RADIUS}]"
)
_OF_TWO = "one, other = placed('one', X, drake.ONE), placed('other', Y, drake.OTHER)\n"
_AT = "X, Y = drake.RigidTransform(drake.Quaternion(q), a), drake.RigidTransform(drake.Quaternion(q2), {})\n"
_WITHIN = (
    "Y = drake.RigidTransform(drake.Quaternion(q), a)\np = Y @ np.array(PLACE)\n"
    "X = drake.RigidTransform(drake.Quaternion(q), p)\n"
)
# Table 4 of QueryObject.ComputeSignedDistancePairwiseClosestPoints, of solids of another size.
_OBSERVED = {"distance_capsule_capsule": 2e-5, "distance_capsule_box": 3e-6}
_OBSERVED_INSIDE = {"distance_capsule_in_capsule": 2e-5, "distance_capsule_in_box": 2e-5, "distance_box_in_box": 2e-5}
DRAKE = (
    _allowing(
        _distances(
            "ComputeSignedDistancePairClosestPoints", _DRAKE, f"{_SCENE}{_AT.format(_BEYOND)}{_OF_TWO}{_SIGNED}"
        ),
        _OBSERVED,
    )
    | {
        f"distance_ball_{other}:point": Way(
            "ComputeSignedDistanceToPoint",
            f"{_SCENE}{_AT.format(_BEYOND)}p = a\n{_TO_POINT.replace('OTHER', _DRAKE[other])}",
        )
        for other in ("capsule", "cylinder", "box")
    }
    | _allowing(
        _overlaps("ComputeSignedDistancePairClosestPoints", _DRAKE, _SCENE + _WITHIN + _OF_TWO + _SIGNED)
        | _floors(
            "ComputeSignedDistancePairClosestPoints",
            {"ball": _DRAKE["ball"]},  # Table 4: with half spaces, spheres alone.
            f"{_SCENE}X = drake.RigidTransform([*a[:2], {HEIGHT}])\nY = drake.RigidTransform()\n"
            + _OF_TWO.replace("ONE", "SOLID").replace("OTHER", "HalfSpace()")
            + _SIGNED,
        ),
        _OBSERVED_INSIDE,
    )
    | _overlaps(
        "ComputeSignedDistanceToPoint",
        _DRAKE,
        _SCENE + _WITHIN + _TO_POINT,
        ":point",
        [pair for pair in INSIDE if pair[0] == "ball"],
    )
    | {
        f"moments_{one}": Way(
            f"UnitInertia.{of.partition('(')[0]}", f"{_X}value = {MASS} * drake.UnitInertia.{of}.get_moments()"
        )
        for one, of in {
            "box": "SolidBox(*x)",
            "ellipsoid": "SolidEllipsoid(*x)",
            "ball": "SolidSphere(x[0])",
            "shell": "HollowSphere(x[0])",
            "cylinder": "SolidCylinder(x[0], x[1], [0, 0, 1])",
            "capsule": "SolidCapsule(x[0], x[1], [0, 0, 1])",
        }.items()
    }
    | ways_of(f"""
== principal_moments | CalcPrincipalMomentsOfInertia
R = drake.Quaternion(q).rotation()
{_SYMMETRIC}I = drake.RotationalInertia(*np.diag(A), A[0, 1], A[0, 2], A[1, 2])
value = I.CalcPrincipalMomentsOfInertia()
""")
)

# DART: frames with shapes, by FCL: its own detector knows no distances, and this one no capsules, as it says.
_DART = {
    "ball": f"SphereShape({RADIUS})",
    "cylinder": f"CylinderShape({RADIUS}, {2 * HALF})",
    "box": f"BoxShape({list(_WHOLES['box'])})",
}
_GROUP = (
    "group, frames = dart.collision.FCLCollisionDetector().createCollisionGroup(), []\n"
    "for X, shape in ((X, dart.dynamics.ONE), (Y, dart.dynamics.OTHER)):\n"
    "    frames.append(dart.dynamics.SimpleFrame(dart.dynamics.Frame.World(), f'f{len(frames)}', X))\n"
    "    frames[-1].setShape(shape)\n    group.addShapeFrame(frames[-1])\n"
    "result = dart.collision.DistanceResult()\n"
    "group.distance(dart.collision.DistanceOption(False, -100.0), result)\nvalue = [result.unclampedMinDistance]"
)
_TOUCHING = _GROUP.replace("FCL", "KIND").partition("result = ")[0] + (
    "result = dart.collision.CollisionResult()\n"
    "group.collide(dart.collision.CollisionOption(True, 100), result)\n"
    "value = [-max(one.penetrationDepth for one in result.getContacts())]"
)
_DART_R = "R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))\n"
DART = (
    _distances(
        "CollisionGroup.distance",
        _DART,
        f"{_DART_R}X, Y = dart.math.Isometry3(R, a), dart.math.Isometry3(Q, {_BEYOND})\n{_GROUP}",
    )
    | {
        f"distance_ball_in_box:{name}": Way(
            f"{name}CollisionDetector, CollisionGroup.collide",
            f"{_DART_R}X, Y = dart.math.Isometry3(R, a + R @ {INSIDE['ball', 'box']}), dart.math.Isometry3(R, a)\n"
            + _TOUCHING.replace("ONE", _DART["ball"]).replace("OTHER", _DART["box"]).replace("KIND", name),
        )
        for name in ("DART", "Bullet", "FCL", "Ode")
    }
    | {
        f"moments_{one}": Way(
            f"{of.partition('(')[0]}.computeInertia", f"{_X}value = np.diag(dart.dynamics.{of}.computeInertia({MASS}))"
        )
        for one, of in {
            "box": "BoxShape(x)",
            "ellipsoid": "EllipsoidShape(2 * x)",
            "ball": "SphereShape(x[0])",
            "cylinder": "CylinderShape(x[0], x[1])",
            "capsule": "CapsuleShape(x[0], x[1])",
        }.items()
    }
)

# PyBullet: bodies in a world of their own.
_BULLET = {
    "ball": f"p.GEOM_SPHERE, radius={RADIUS}",
    "capsule": f"p.GEOM_CAPSULE, radius={RADIUS}, height={2 * HALF}",
    "cylinder": f"p.GEOM_CYLINDER, radius={RADIUS}, height={2 * HALF}",
    "box": f"p.GEOM_BOX, halfExtents={list(SIDES)}",
}
_PLACED = "p.createMultiBody(0, p.createCollisionShape({}), -1, {}, {})"
_BULLET_R = "R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))\n"
_WORLD = "if not p.isConnected(): p.connect(p.DIRECT)\np.resetSimulation()\n"
_CLOSEST = "value = [p.getClosestPoints(one, other, 100.0)[0][8]]"
_DEEPEST = "value = [min(point[8] for point in p.getClosestPoints(one, other, 100.0))]"
# The margin of 0.001 is within a box or a cylinder and rounds its edges (Bullet's manual, "Collision Margin"); rays end
# where what is left has a square below 0.0001 (epsilon of btSubSimplexConvexCast.cpp).
_MARGINS = {"distance_.*(box|cylinder)(_to_floor)?": 1e-3, "ray_.*": 3e-3}
PYBULLET = _allowing(
    _distances(
        "getClosestPoints",
        _BULLET,
        f"{_WORLD}one, other = {_PLACED.format('ONE', 'a', 'q')}, {_PLACED.format('OTHER', _BEYOND, 'q2')}\n{_CLOSEST}",
    )
    | _overlaps(
        "getClosestPoints",
        _BULLET,
        f"{_WORLD}{_BULLET_R}one = {_PLACED.format('ONE', 'a + R @ PLACE', 'q')}\n"
        f"other = {_PLACED.format('OTHER', 'a', 'q')}\n{_DEEPEST}",
    )
    | _floors(
        "getClosestPoints",
        _BULLET,
        f"{_WORLD}one = {_PLACED.format('SOLID', f'[*a[:2], {HEIGHT}]', 'q')}\n"
        f"other = {_PLACED.format('p.GEOM_PLANE', '[0, 0, 0]', '[0, 0, 0, 1]')}\n{_DEEPEST}",
    )
    | _rays(
        "rayTest",
        _BULLET,
        f"{_WORLD}{_BULLET_R}{_LINE}p.createMultiBody(0, p.createCollisionShape(SOLID), -1, a, q)\n"
        "value = [16 * p.rayTest(START, START + 16 * u)[0][2]]",
        starts="o",
    ),
    _MARGINS,
)

# Exudyn: moments of bodies by density or by mass.
EXUDYN = {
    f"moments_{one}": Way(f"Inertia{of.partition('(')[0]}", f"{_X}value = np.diag(rbu.Inertia{of}.inertiaTensor)")
    for one, of in {
        "box": f"Cuboid({MASS} / np.prod(x), x)",
        "ball": f"Sphere({MASS}, x[0])",
        "shell": f"HollowSphere({MASS}, x[0])",
        "cylinder": f"Cylinder({MASS} / (np.pi * x[0] ** 2 * x[1]), x[1], x[0], 2)",
    }.items()
}
