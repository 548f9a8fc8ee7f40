"""USD in, by UsdPhysics: rigid bodies that joints connect, whose roots float unless a joint holds them.

Coordinates are zero where the two frames of a joint are one, wherever the stage places the bodies. Numbers of single
precision are read as the shortest decimals that stand for them.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from symofros.description.constraints import Constraint
from symofros.description.frames import IDENTITY_POSE, Frame, Pose
from symofros.description.imported.building import reading_of
from symofros.description.imported.geometry import Exact
from symofros.description.imported.options import DEFAULT_OPTIONS, ImportOptions
from symofros.description.imported.tree import ImportedBody, ImportedTree
from symofros.description.joints.joint import WORLD
from symofros.description.reading import Reading, fresh_name
from symofros.description.remarks import Remarks
from symofros.description.usd.check import faults
from symofros.description.usd.joints import JointMaker, UsdJoint, motion_of, number
from symofros.description.usd.masses import Masses, Units
from symofros.description.usd.placement import affine, turn
from symofros.description.usd.stage import stage_of
from symofros.description.usd.tree import Edge, spanning_tree
from symofros.description.usd.visuals import visual
from symofros.description.visual import MAX_VISUALS, Visual
from symofros.errors import DescriptionError, Problem

# Gravity where none is stated [m/s^2], along the downward axis of the stage.
_GRAVITY = 9.81
_DOWN = {"Y": (0.0, -1.0, 0.0), "Z": (0.0, 0.0, -1.0)}
# API schemas that are read, or that say nothing of the mechanics of a body or joint.
_KNOWN = frozenset(
    {"PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysicsArticulationRootAPI", "PhysicsCollisionAPI"}
    | {"PhysicsMeshCollisionAPI", "PhysicsFilteredPairsAPI", "PhysicsDriveAPI", "PhysicsLimitAPI"}
    | {"MaterialBindingAPI", "GeomModelAPI", "CollectionAPI", "SemanticsAPI", "SemanticsLabelsAPI", "VisibilityAPI"}
    | {"PhysxJointAPI", "PhysxArticulationAPI", "PhysxCollisionAPI", "PhysxLimitAPI", "NewtonJointAPI"}
    | {"NewtonMassAPI", "NewtonArticulationRootAPI", "NewtonCollisionAPI", "NewtonMeshCollisionAPI"}
)
# Poses of the stage that differ by more from those at zero are another posture [m, and entries of rotations].
_POSTURE = 1e-5


def read_usd(path: str | os.PathLike[str], options: ImportOptions = DEFAULT_OPTIONS) -> Reading:
    """Read a USD file.

    Args:
        path: Root layer: .usd, .usda, .usdc, .usdz.
        options: How it is read.

    Returns:
        The system, and every problem.

    Raises:
        DescriptionError: The file can't be read.
    """
    file = os.fspath(path)
    stage = stage_of(path)
    bad = tuple(
        Problem(f"{name} of <{prim}> can't be read", f"{value!r:.80}", rule, "mend the value", f"{file}:<{prim}>")
        for prim, name, value, rule in faults(stage)
    )
    if bad:
        raise DescriptionError(bad)
    return reading_of(_Importer(file, stage, options).tree(), notes=tuple(_notes(stage["warnings"])))


def _notes(warnings: Sequence[str]) -> Iterator[str]:
    """Note of OpenUSD's first warning while it read the file, and of the number of others."""
    if warnings:
        more = f" (and {len(warnings) - 1} more)" if len(warnings) > 1 else ""
        yield f"OpenUSD warns: {warnings[0]:.300}{more}"


class _Importer:
    def __init__(self, file: str, stage: Mapping[str, Any], options: ImportOptions) -> None:
        self.file, self.stage, self.options = file, stage, options
        self.units = Units(float(stage["meters"]), float(stage["kilograms"]))
        self.exact, self.remarks = Exact(options.snap_tol), Remarks()
        for layer, name, value in stage["other units"]:
            what = f"{name} of layers that the stage is made of ignored, OpenUSD converts no units"
            self.remarks.add(what, "layer", f"{layer}, {value}")
        self.problems: list[Problem] = []
        placements = stage["placements"]
        self.placements = {path: affine(rows, self.units.meters) for path, rows in placements.items()}
        self.bodies: dict[str, Mapping[str, Any]] = {body["path"]: body for body in stage["bodies"]}
        self.names = names_of(self.bodies)
        self.masses = Masses(self.units, self.placements, self.remarks, self.problems)
        drives = any(joint["drives"] for joint in stage["joints"])
        self.maker = JointMaker(self.units, self.exact, self.remarks, drives)

    def where(self, path: str) -> str:
        """Place in the file."""
        return f"{self.file}:<{path}>"

    def tree(self) -> ImportedTree:
        """The bodies of the stage; problems are noted on the way.

        Raises:
            DescriptionError: There is no body, or some have no frame.
        """
        if not self.bodies:
            rule, remedy = "a mechanism has prims with PhysicsRigidBodyAPI", "apply UsdPhysics to the stage"
            raise DescriptionError("there is no rigid body", "no such prim", rule, remedy, self.file)
        for path, name in self.names.items():
            self._remark_body(self.bodies[path], name)
            if not self.placements[path].is_rigid:
                rule = "the transform of a rigid body turns, shifts, and scales along its axes"
                stated, remedy = "sheared, mirrored, or without extent", "move the scale into its shapes"
                what = f"body '{name}' has no frame"
                self.problems.append(Problem(what, stated, rule, remedy, self.where(path)))
        if self.problems:
            raise DescriptionError(self.problems)
        joints = list(self._joints())
        fixed = [path for path, body in self.bodies.items() if body["enabled"] is False or body["kinematic"]]
        edges, closing = spanning_tree(list(self.bodies), joints, fixed, self._roots())
        frames: dict[str, list[Frame]] = {}
        constraints = tuple(self._constraints(closing, frames))
        bodies = list(self._bodies(edges, fixed, self._shapes()))
        self._remark_posture(edges)
        origin: dict[tuple[str, ...], str] = {("body", name): self.where(path) for path, name in self.names.items()}
        origin |= {(what, joint.name): joint.where for joint in joints for what in ("joint", "constraint")}
        return ImportedTree(
            self.stage["name"] or Path(self.file).stem,
            self.options,
            self.file,
            noun="body",
            remarks=self.remarks,
            exact=self.exact,
            bodies=bodies,
            frames=frames,
            gravity=self._gravity(),
            constraints=constraints,
            origin=origin,
            visuals=self._visuals(),
            problems=self.problems,
        )

    def _remark_body(self, body: Mapping[str, Any], name: str) -> None:
        self._remark_unread(body, "body", name)
        if any(velocity and any(velocity) for velocity in body["moving"]):
            self.remarks.add("velocities of bodies ignored: a run has its own start", "body", name)

    def _remark_unread(self, row: Mapping[str, Any], noun: str, name: str) -> None:
        for schema in row["schemas"]:
            if schema.partition(":")[0] not in _KNOWN:
                self.remarks.add(f"API schema {schema.partition(':')[0]:.60} ignored", noun, name)
        for stated in row["unread"]:
            self.remarks.add(f"property '{stated:.60}' ignored", noun, name)

    def _joints(self) -> Iterator[UsdJoint]:
        """The joints that bind something, in the order of the stage."""
        rows = {row["path"]: row for row in self.stage["joints"]}
        for path, name in names_of(rows).items():
            row = rows[path]
            self._remark_unread(row, "joint", name)
            if row["enabled"] is False:
                self.remarks.add("joints that are not enabled ignored", "joint", name)
                continue
            if any(math.isfinite(number(limit, math.inf)) for limit in row["breaks"]):
                self.remarks.add("breaking of joints ignored", "joint", name)
            ends = tuple(self.stage["carrier"].get(row[end], "") for end in ("body0", "body1"))
            missing = [row[end] for end in ("body0", "body1") if row[end] and row[end] not in self.placements]
            if missing or row["targets"] > 1 or ends[0] == ends[1]:
                stated = f"body0 <{row['body0']}>, body1 <{row['body1']}>"
                rule = "a joint joins two different rigid bodies, or one and the world, each by one active target"
                what, remedy = f"joint '{name}' joins no two bodies", "mend its relationships"
                self.problems.append(Problem(what, stated, rule, remedy, self.where(path)))
                continue
            motion = motion_of(row | {"limits": {}, "kind": "fixed"} if row["kind"] == "distance" else row)
            if isinstance(motion, str):
                rule = (
                    "fixed, revolute, prismatic, spherical and distance joints; PhysicsJoint that frees one direction, "
                    "all turns, one axis to turn about and slide along, or a plane"
                )
                what, remedy = f"joint '{name}' can't be read", "state it by several joints, with bodies between them"
                self.problems.append(Problem(what, motion, rule, remedy, self.where(path)))
                continue
            if motion[0] == "none":
                self.remarks.add("joints that bind nothing ignored", "joint", name)
                continue
            if motion[0] in ("ball", "cylindrical", "planar"):
                self._remark_several(row, name)
            frames = (self._frame(row, "0", ends[0]), self._frame(row, "1", ends[1]))
            yield UsdJoint(name, row, *motion, (ends[0], ends[1]), frames, self.where(path))

    def _remark_several(self, row: Mapping[str, Any], name: str) -> None:
        """Note limits and drives of a joint of several coordinates, which are ignored."""
        cones = any(cone is not None and number(cone, -1.0) >= 0.0 for cone in row["cones"])
        bounds = ((number(low, -math.inf), number(high, math.inf)) for low, high in row["limits"].values())
        if cones or any(low < high and (math.isfinite(low) or math.isfinite(high)) for low, high in bounds):
            self.remarks.add("limits of joints of several coordinates ignored", "joint", name)
        if row["drives"]:
            self.remarks.add("drives of joints of several coordinates ignored", "joint", name)

    def _frame(self, row: Mapping[str, Any], end: str, body: str) -> Pose:
        """The joint's frame in a body, or in the world."""
        target = row[f"body{end}"]
        p, R = np.array(row[f"position{end}"] or (0.0, 0.0, 0.0), dtype=float), turn(row[f"rotation{end}"])
        if not body and not target:
            return Pose(p * self.units.meters, R)
        placed = self.placements[target]
        if target == body:
            # The world's own matrices would cost digits.
            return Pose(p * placed.scale, R)
        in_world = Pose(placed.point(p), placed.pose.R @ R)
        return self.placements[body].pose.inverse() @ in_world if body else in_world

    def _roots(self) -> list[str]:
        """Bodies from which articulations are counted."""
        return [path for root in self.stage["roots"] for path in self.bodies if path == root]

    def _bodies(
        self, edges: Iterable[Edge], fixed: list[str], shapes: Mapping[str, list[Any]]
    ) -> Iterator[ImportedBody]:
        """The bodies, parents first."""
        for edge in edges:
            name = self.names[edge.child]
            inertia = self.masses.of(self.bodies[edge.child], name, shapes.get(edge.child, []), self.where(edge.child))
            if edge.joint is not None:
                joint, placement = self.maker.placed(edge.joint, edge.is_reversed)
                yield ImportedBody(name, inertia, self.names.get(edge.parent, WORLD), (joint,), placement)
            elif edge.child in fixed:
                self.remarks.add("bodies that are kinematic or not enabled are fixed to the world", "body", name)
                pose = self.placements[edge.child].pose
                yield ImportedBody(name, inertia, placement=self.exact.placement(pose.p, pose.R))
            else:
                self.remarks.add("bodies without a joint to the world float", "body", name)
                yield ImportedBody(name, inertia, floats=True)

    def _constraints(self, closing: Iterable[UsdJoint], frames: dict[str, list[Frame]]) -> Iterator[Constraint]:
        """Constraints for the joints that close loops; their frames are added to those of the bodies."""
        for joint in closing:
            names = (self.names.get(joint.ends[0], WORLD), self.names.get(joint.ends[1], WORLD))
            if joint.row["kind"] != "distance":
                yield self.maker.closing(joint, names, frames)
                continue
            least, most = (number(bound, -1.0) for bound in joint.row["distances"])
            if least == most > 0.0:
                yield self.maker.rod(joint, names, most, frames)
            else:
                self.remarks.add("bounds of distances ignored", "joint", joint.name)

    def _shapes(self) -> dict[str, list[Any]]:
        """Collision shapes of each body."""
        shapes: dict[str, list[Any]] = {}
        for shape in self.stage["shapes"]:
            if shape["collides"]:
                shapes.setdefault(shape["body"], []).append(shape)
        return shapes

    def _visuals(self) -> dict[str, tuple[Visual, ...]]:
        """Visual shapes of each body: body name -> visuals."""
        seen: dict[str, list[Visual]] = {}
        for shape in self.stage["shapes"]:
            if not shape["seen"]:
                continue
            name, count = self.names[shape["body"]], sum(map(len, seen.values()))
            frame, placed = self.placements[shape["body"]].pose, self.placements[shape["path"]]
            drawn = visual(shape, frame, placed) if count < MAX_VISUALS else None
            if drawn is None:
                self.remarks.add("visual shapes that can't be drawn ignored", "body", name)
            else:
                seen.setdefault(name, []).append(drawn)
        return {name: tuple(shapes) for name, shapes in seen.items()}

    def _gravity(self) -> tuple[float, float, float]:
        """Acceleration of gravity [m/s^2]: the first scene's, or the earth's."""
        scenes = self.stage["scenes"]
        if len(scenes) > 1:
            self.remarks.add("physics scenes after the first ignored", "scene", scenes[1]["path"])
        scene = scenes[0] if scenes else {}
        direction = scene.get("gravityDirection")
        down = direction if direction and any(direction) else _DOWN.get(self.stage["up"], _DOWN["Z"])
        stated = number(scene.get("gravityMagnitude"), -math.inf)
        magnitude = _GRAVITY if stated < 0.0 else stated * self.units.meters
        x, y, z = (magnitude * float(e) / math.hypot(*down) + 0.0 for e in down)
        return x, y, z

    def _remark_posture(self, tree: Iterable[Edge]) -> None:
        """Remark bodies that the stage does not place where joints' coordinates are zero."""
        for edge in tree:
            if edge.joint is None:
                continue
            first, second = (
                (self.placements[end].pose if end else IDENTITY_POSE) @ frame
                for end, frame in zip(edge.joint.ends, edge.joint.frames, strict=True)
            )
            if max(np.abs(first.p - second.p).max(), np.abs(first.R - second.R).max()) > _POSTURE:
                text = "the stage shows another posture than that of zero coordinates, at which joints' frames are one"
                self.remarks.add(text, "joint", edge.joint.name)


def names_of(paths: Iterable[str]) -> dict[str, str]:
    """A name of each path: its last part, and as many before it as tell it from others."""
    paths = list(paths)
    names: dict[str, str] = {}
    depth = 1
    while len(names) < len(paths):
        wanted: dict[str, list[str]] = {}
        for path in paths:
            wanted.setdefault("_".join(path.strip("/").split("/")[-depth:]), []).append(path)
        for name, matches in wanted.items():
            if len(matches) == 1 and matches[0] not in names and name not in names.values() and name != WORLD:
                names[matches[0]] = name
        depth += 1
        if depth > max(path.count("/") for path in paths) + 1:
            for path in paths:
                if path not in names:
                    names[path] = fresh_name("_".join(path.strip("/").split("/")), {*names.values(), WORLD})
    return {path: names[path] for path in paths}
