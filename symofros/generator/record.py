"""SpanningTree -> ModelRecord: what a model is besides its functions."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

from symofros.base.events import Event
from symofros.base.names import TIME
from symofros.base.options import Options
from symofros.description.constraints import AXES, Closure, acts_on_bodies
from symofros.description.forces import Friction, Stop
from symofros.description.system import System
from symofros.description.values import Value, symbols
from symofros.expr.expression import Expression, always_quoted, evaluate
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.dynamics.constraints.measures import measures_of
from symofros.mechanics.kinematics.joint import neutral_coordinates
from symofros.mechanics.topology.coordinates import angles, joint_sizes
from symofros.mechanics.topology.formulas import stated_values
from symofros.mechanics.topology.rigid_contacts import rigid_balls
from symofros.mechanics.topology.sticking import sticking_coordinates
from symofros.mechanics.topology.switches import offset_names, rotation_names, switches_of
from symofros.mechanics.topology.tree import (
    SpanningTree,
    ball_names,
    frame_of,
    joint_names,
    prescribed_speeds,
    section_names,
)
from symofros.runtime.record import (
    ClosureRecord,
    JointLimit,
    ModelRecord,
    RigidContactRecord,
    Segment,
    StickingRecord,
    SwitchRecord,
)

GENERATOR = "symofros 0.1.0"


def model_record(tree: SpanningTree, options: Options) -> ModelRecord:
    """Sizes, names, defaults and limits of the model of a tree."""
    names = tree.coordinates
    lower: list[float] = []
    upper: list[float] = []
    neutral: list[float] = []
    periodic: list[bool] = []
    driven: list[float] = []
    quaternions: list[int] = []
    for link in tree.links:
        limits, n = link.joint.limits, link.q[1]
        if link.joint.prescribed:
            nq, nv = joint_sizes(link.joint)
            if nq > nv:
                quaternions.append(names.efforts + len(driven) + nq - 4)
            driven += (*neutral_coordinates(link.joint, nq), *(0.0,) * (2 * nv))
            continue
        if link.tip_of is not None:
            sizes = theory_of(link.tip_of).sizes(evaluate(link.tip_of.length, tree.system.parameter_values()))
            lower += [-size for size in sizes]
            upper += sizes
            neutral += (0.0,) * n
            periodic += (False,) * n
            continue
        lower += [-float("inf") if limits is None or limits.lower is None else limits.lower] * n
        upper += [float("inf") if limits is None or limits.upper is None else limits.upper] * n
        neutral += neutral_coordinates(link.joint, n)
        periodic += angles(link.joint)
    idle = len(names.states)
    lower, upper = lower + [-math.inf] * idle, upper + [math.inf] * idle
    neutral, periodic = neutral + [0.0] * idle, periodic + [False] * idle
    return ModelRecord(
        name=tree.system.name,
        hash=_hash(tree.system, options),
        q_names=names.q,
        v_names=names.v,
        u_names=names.u,
        par_names=names.par,
        frame_names=tuple(frame.name for frame in tree.frames),
        frame_aliases={frame.qualified: frame.name for frame in tree.frames},
        u_default=(0.0,) * names.efforts + tuple(driven),
        par_default=names.par_default,
        q_neutral=tuple(neutral),
        q_lower=tuple(lower),
        q_upper=tuple(upper),
        segments=_segments(tree),
        periodic=tuple(periodic),
        constraint_names=tuple(name for item in tree.system.constraints for name in item.conditions),
        constraint_owners=tuple(item.name for item in tree.system.constraints for _ in item.conditions),
        speed_conditions=tuple(name for item in tree.system.constraints for name in item.on_speeds),
        wrench_names=tuple(acts_on_bodies(tree.system.constraints)),
        joint_names=joint_names(tree),
        link_names=tuple(link.name for link in tree.links),
        section_names=section_names(tree),
        prescribed_names=prescribed_speeds(tree),
        closures=tuple(_closure(tree, item) for item in tree.system.constraints if isinstance(item, Closure)),
        driven=len(driven),
        quaternion_inputs=tuple(quaternions),
        measures=measures_of(tree),
        timed=any(TIME in symbols(stated.value) for stated in stated_values(tree.system)),
        joint_limits=joint_limits(tree),
        friction_speeds=_friction_speeds(tree),
        contact_names=ball_names(tree),
        switches=_switches(tree),
        sticking=_sticking(tree),
        rigid_contacts=_rigid_contacts(tree),
        state_names=names.states,
        events={name: _as_texts(event) for name, event in tree.system.events.items()},
    )


def _as_texts(event: Event) -> Event:
    """An event of the description with its formulas as texts that nothing reads otherwise."""
    rests, action = event.rests, event.action
    return replace(
        event,
        formula=_text(event.formula),
        action=None if action is None else {name: _set_to(value) for name, value in action.items()},
        rests=None if rests is None else _text(rests),
    )


def _set_to(value: Value) -> str | float:
    return _text(value) if isinstance(value, Expression) else value


def _switches(tree: SpanningTree) -> tuple[SwitchRecord, ...]:
    switches, names, first, records = switches_of(tree.system), tree.coordinates.par, 0, []
    for item in tree.system.constraints:
        rows = range(first, first := first + len(item.conditions))
        switch = switches.get(item.name)
        if switch is None:
            continue
        moment = switch.pose == "moment"
        offsets = offset_names(item) if moment else {}
        offset_places = tuple(
            (row, names.index(offsets[name]))
            for row, name in zip(rows, item.conditions, strict=True)
            if name in offsets
        )
        rotation = tuple(map(names.index, rotation_names(item) if moment else ()))
        anchors = (item.first, item.second) if isinstance(item, Closure) else ()
        frames = tuple(frame_of(tree, *anchor).name for anchor in anchors)
        records.append(SwitchRecord(item.name, str(switch.engaged), moment, offset_places, rotation, frames))
    return tuple(records)


def _sticking(tree: SpanningTree) -> tuple[StickingRecord, ...]:
    conditions = [name for item in tree.system.constraints for name in item.conditions]
    return tuple(
        StickingRecord(
            one.coordinate,
            link.q[0] + one.number,
            link.v[0] + one.number,
            tree.coordinates.par.index(one.mode),
            conditions.index(one.condition),
            _text(one.breakaway),
            _text(one.watch),
        )
        for link in tree.links
        for one in sticking_coordinates(link.joint)
    )


def _rigid_contacts(tree: SpanningTree) -> tuple[RigidContactRecord, ...]:
    conditions = [name for item in tree.system.constraints for name in item.conditions]
    place = tree.coordinates.par.index
    records = []
    for ball in rigid_balls(tree.system):
        friction, restitution = _text(ball.contact.friction), _text(ball.contact.restitution or 0.0)
        rows = tuple(map(conditions.index, ball.conditions))
        first, second = map(_text, ball.watched)
        pushes, way = (tuple(map(place, names)) for names in (ball.pushes, ball.way))
        held_by = ball.normal.name, ball.across.name
        pole = -1 if ball.contact.surface == "plane" else place(ball.pole)
        places = place(ball.mode), pushes, way, place(ball.apart), pole, rows
        records.append(RigidContactRecord(ball.name, *places, held_by, friction, restitution, (first, second)))
    return tuple(records)


def _text(value: Value) -> str:
    """A formula as text that nothing reads otherwise."""
    return value.text(always_quoted) if isinstance(value, Expression) else repr(value)


def joint_limits(tree: SpanningTree) -> tuple[JointLimit, ...]:
    """Limits of joints that no stop keeps. Zero is no limit of speed or effort: files of kinematics alone state it."""
    inputs = {name: i for i, name in enumerate(tree.coordinates.u)}
    stated = []
    for link in tree.links:
        limits = link.joint.limits
        if limits is None or link.joint.prescribed:
            continue
        speeds = range(link.v[0], sum(link.v))
        stopped = any(isinstance(element, Stop) for element in link.joint.elements)
        if (limits.lower is not None or limits.upper is not None) and not stopped:
            lower = -math.inf if limits.lower is None else limits.lower
            upper = math.inf if limits.upper is None else limits.upper
            stated += [JointLimit("q", i, lower, upper) for i in range(link.q[0], sum(link.q))]
        if limits.velocity:
            stated += [JointLimit("v", i, -limits.velocity, limits.velocity) for i in speeds]
        if limits.effort and link.joint.actuated and not link.joint.effort:
            places = (inputs[tree.coordinates.v[i]] for i in speeds)
            stated += [JointLimit("u", i, -limits.effort, limits.effort) for i in places]
    return tuple(stated)


def _friction_speeds(tree: SpanningTree) -> tuple[int, ...]:
    """Indices of the speeds that have friction."""
    return tuple(
        link.v[0] + element.coordinate
        for link in tree.links
        if not link.joint.prescribed and link.tip_of is None
        for element in link.joint.elements
        if isinstance(element, Friction) and not element.sticks
    )


def _closure(tree: SpanningTree, closure: Closure) -> ClosureRecord:
    first, second = (frame_of(tree, *anchor).name for anchor in (closure.first, closure.second))
    return ClosureRecord(closure.name, first, second, tuple(AXES.index(axis) for axis in closure.rotations))


def _segments(tree: SpanningTree) -> tuple[Segment, ...]:
    segments: list[Segment] = []
    for link in tree.links:
        if link.joint.prescribed:
            continue
        kind = link.joint.traits.manifold
        if kind == "linear" and segments and segments[-1].kind == "linear":
            segments[-1] = segments[-1]._replace(size=segments[-1].size + link.q[1])
        else:
            segments.append(Segment(kind, link.q[0], link.v[0], link.q[1]))
    names = tree.coordinates
    if n := len(names.states):
        segments.append(Segment("linear", len(names.q) - n, len(names.v) - n, n))
    return tuple(segments)


def _hash(system: System, options: Options) -> str:
    """Identity of a description under these options: dataclasses print every field, in order."""
    return hashlib.sha256(repr((system, options, GENERATOR)).encode()).hexdigest()[:16]
