"""From the neutral tree to the system: massless carriers, roots, passive efforts, stops and notes, for all formats."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from symofros.base.sources import Source
from symofros.description.forces import Damper, Friction, JointElement
from symofros.description.imported.stops import with_stops
from symofros.description.imported.tree import ImportedBody, ImportedJoint, ImportedTree
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.reading import Reading, fresh_name
from symofros.description.system import RigidBody, System
from symofros.errors import DescriptionError, Problem

_DAMPING = 'damping of joints ignored (dissipation="viscous" of load, or --dissipation viscous, keeps it)'
_FRICTION = 'dry friction of joints ignored (dissipation="all" of load, or --dissipation all, keeps it)'
_SMOOTHED = (
    f"dry friction of joints smoothed below {Friction(0.0).minimum_velocity:g} rad/s or m/s, "
    "so that what it holds at rest creeps"
)
_DATA = 'limits kept as data, without a stop (limits="stops" of load, or --limits stops, makes stops of them)'


def reading_of(tree: ImportedTree, sources: tuple[Source, ...] = (), notes: tuple[str, ...] = ()) -> Reading:
    """The outcome of reading a file that is read whole or not at all.

    Args:
        tree: The file.
        sources: Files that it was made of.
        notes: Notes that are no remarks, behind those.

    Raises:
        DescriptionError: With the problems of the tree.
    """
    system = system_of(tree)
    if tree.problems:
        raise DescriptionError(tree.problems)
    return Reading(replace(system, notes=(*system.notes, *notes)), sources=sources)


def system_of(tree: ImportedTree) -> System:
    """The System of an imported tree; faults are added to the problems of the tree."""
    _float_root(tree)
    bodies = tuple(_Builder(tree).bodies())
    if tree.options.limits == "stops":
        bodies = with_stops(bodies, tree.remarks)
    if tree.exact.changed:
        text = f"numbers within {tree.exact.tolerance:g} of exact ones made exact"
        tree.remarks.add(text, "number", f"{tree.exact.changed} of them")
    return System(
        tree.name,
        bodies,
        inputs=tree.inputs,
        gravity=tree.gravity,
        constraints=tree.constraints,
        notes=tree.remarks.notes(),
        origin=tree.origin,
        visuals=tree.visuals,
    )


def _float_root(tree: ImportedTree) -> None:
    """Let the one body float that stands on the ground, where that is asked for and none floats as it is."""
    roots = [body for body in tree.bodies if body.parent == WORLD]
    if not tree.options.floating_base or any(_is_free(body) for body in roots):
        return
    standing = [body for body in roots if body.is_held]
    if len(standing) == 1 and standing[0].name != WORLD:
        body = standing[0]
        body.joints, body.placement, body.is_ground, body.floats = (), None, False, True
        return
    if tree.problems:  # What can't be read may be the root.
        return
    if not roots:
        found = f"each {tree.noun} has a parent"
    elif any(body.name == WORLD for body in standing):
        found = f"the root {tree.noun} is '{WORLD}', which is the ground"
    elif standing:
        found = f"several stand on the ground: {', '.join(body.name for body in standing[:5])}"
    else:
        found = f"the root {tree.noun} '{roots[0].name}' moves on joint '{roots[0].joints[0].joint.name}'"
    what, rule = f"no root {tree.noun} that could float", f"a floating robot has one root {tree.noun} that stands still"
    tree.problems.append(Problem(what, found, rule, "drop floating_base", tree.where))


def _is_free(body: ImportedBody) -> bool:
    """Whether a body floats by the file itself."""
    return body.floats or any(stated.joint.kind == "free" for stated in body.joints)


class _Builder:
    def __init__(self, tree: ImportedTree) -> None:
        self.tree = tree
        self.body_names = {WORLD, *(body.name for body in tree.bodies)}
        self.joint_names = {stated.joint.name for body in tree.bodies for stated in body.joints}

    def bodies(self) -> Iterator[RigidBody]:
        """The bodies, each after the massless ones that carry it."""
        if WORLD in self.tree.frames and all(body.name != WORLD for body in self.tree.bodies):
            yield RigidBody(WORLD, frames=tuple(self.tree.frames[WORLD]))
        for body in self.tree.bodies:
            yield from self.chain(body)

    def chain(self, body: ImportedBody) -> Iterator[RigidBody]:
        """A body, after a massless one at each joint that does not move the body's own frame."""
        inertia, frames = body.inertia, tuple(self.tree.frames.get(body.name, ()))
        if body.is_ground:
            if inertia is not None:
                self.tree.remarks.add("inertia of the base dropped, it never moves", self.tree.noun, body.name)
            yield RigidBody(body.name, frames=frames)
            return
        joints = [replace(stated.joint, elements=tuple(self.elements(stated))) for stated in body.joints]
        # A body that moves about a point that is not its origin, or with other axes, is fixed to a massless one.
        own = joints.pop() if joints and body.placement is None else None
        parent = body.parent
        for joint in joints:
            carrier = fresh_name(f"{body.name}_at_{joint.name}", self.body_names)
            yield RigidBody(carrier, replace(joint, parent=parent))
            parent = carrier
        moving = replace(own, parent=parent) if own is not None else self.held(body, parent)
        yield RigidBody(body.name, moving, inertia, frames, loads=body.loads)

    def held(self, body: ImportedBody, parent: str) -> Joint:
        """The joint of a body that the file states none for."""
        if body.floats:
            name = fresh_name(self.tree.floating_joint.format(body.name), self.joint_names)
            self.tree.origin.setdefault(("joint", name), self.tree.origin.get(("body", body.name), self.tree.where))
            return Joint(name, "free", WORLD)
        name = fresh_name(f"{body.name}_fixed", self.joint_names)
        return Joint(name, "fixed", parent, None, *(body.placement or ()))

    def elements(self, stated: ImportedJoint) -> Iterator[JointElement]:
        """Springs of a joint, and the dampers and friction that the options keep."""
        joint, remarks, keeps = stated.joint, self.tree.remarks, self.tree.keeps
        if self.tree.limits_act and joint.limits is not None and self.tree.options.limits == "data":
            remarks.add(_DATA, "joint", joint.name)
        for k, resistance in enumerate(stated.resistances):
            if resistance.spring is not None:
                yield replace(resistance.spring, coordinate=k)
            damped = resistance.damping or resistance.quadratic
            if damped and keeps == "none":
                remarks.add(_DAMPING, "joint", joint.name)
            elif damped and self.is_coefficient(resistance.damping, "damping", joint.name):
                yield Damper(resistance.damping, resistance.quadratic, k)
            if resistance.friction and keeps not in ("all", "stiction"):
                remarks.add(_FRICTION, "joint", joint.name)
            elif resistance.friction and self.is_coefficient(resistance.friction, "friction", joint.name):
                sticks = keeps == "stiction" and not joint.traits.quasi_velocities
                if not sticks:
                    remarks.add(_SMOOTHED, "joint", joint.name)
                yield Friction(resistance.friction, coordinate=k, sticks=sticks)

    def is_coefficient(self, value: float, what: str, joint: str) -> bool:
        """Whether a number is a coefficient, negative ones only by the format's default; a problem is noted if not."""
        if value >= 0.0 or (value < 0.0 and self.tree.options.dissipation is None):
            return True
        rule, remedy = "a finite number that is not negative", 'mend it, or leave it out by dissipation="none"'
        where = self.tree.origin.get(("joint", joint), self.tree.where)
        problem = Problem(f"joint '{joint}': its {what} is no coefficient", f"{value:g}", rule, remedy, where)
        self.tree.problems.append(problem)
        return False
