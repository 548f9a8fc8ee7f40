"""Exudyn's joints: every body in coordinates of its own, every joint and closure a connector of Exudyn's.

The plug-in `exudyn-joints` of the matrix makes the bodies and the joints, solves for accelerations and says how. Here
the closures of a description are added: `ObjectJointGeneric`, which blocks any directions, and for rods
`ObjectConnectorDistance`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import symofros as sf

from ...contract.interface import States, Subject, Unsupported
from ...engines.plugins.loops.exudyn import PLUGIN, write
from ...engines.plugins.writing.source import SourceModel, Way
from ...mechanics.assembly import BASE, Assembly, FrameSite, anchor_name
from ...mechanics.geometry import Array
from ...mechanics.joint_kinds import PartKind
from ..charted import ChartedEngine, chart_of
from ..closed import AXES
from ..reach import armature, unrepresented
from ..stated import stated

NAME = "exudyn-loops"
CAPABILITIES = frozenset({"forward_dynamics", "closure_gap", "frame_response"})
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "ball", "free"})
# The step of the difference along the motion: its sixth power is what is left for rods.
_SOLVED = "a = s.solved(q, v, tau, 4e-3)[0]\n"
_WAYS = {
    "forward_dynamics": Way("ObjectJointGeneric", f"{_SOLVED}value = a"),
    "closure_gap": Way(
        "ComputeAlgebraicEquations",
        "x = s.coordinates(q, v)[0]\ns.set(x, 0 * x)\ns.solver.ComputeAlgebraicEquations(s.mbs)\n"
        "value = np.abs(np.array(s.solver.GetSystemResidual())[len(x):]).max()",
    ),
    "frame_response": Way("Acceleration, AngularAcceleration", f"{_SOLVED}value = response(s, q, v, a)"),
}
_RESPONSE = """def response(s, q, v, a):
    x, D, second = s.coordinates(q, v)
    s.set(x, D @ v)
    now, types = exu.ConfigurationType.Current, (exu.OutputVariableType.Acceleration,
        exu.OutputVariableType.AngularAcceleration)
    s.mbs.systemData.SetODE2Coordinates_tt(D @ a + second, configuration=now)
    def one(body, place): return np.concatenate([s.mbs.GetObjectOutputBody(body, kind, place, now) for kind in types])
    return [one(s.bodies[k], place) if k >= 0 else np.zeros(6) for k, place in sites]"""


@dataclass(frozen=True)
class JointedEngine(ChartedEngine):
    """An Exudyn system with a node of Euler parameters for every moving body of a description."""

    def closure_gap(self, states: States) -> Array:
        """Largest residual of Exudyn's constraints (N,), those of the tree's joints included."""
        return self.asked("closure_gap", states)

    def frame_response(self, states: States) -> Array:
        """Constrained accelerations of the frames' origins, (linear; angular), in world axes (N, F, 6)."""
        return self.asked("frame_response", states)


def build(subject: Subject) -> JointedEngine | Unsupported:
    """Exudyn's system of a description with closures and rods."""
    assembly, system = subject.assembly, subject.system
    obstacle = unrepresented(system, assembly, _JOINTS) or _obstacle(system, assembly)
    if obstacle is not None:
        return obstacle
    described = stated(replace(subject, frames=()), whole=False, merged=True)
    source = write(described.tree)
    if isinstance(source, Unsupported):
        return source
    sites = [assembly.frames[name] for name in subject.frames]
    given = {
        "closing": [_connector(assembly, system, item) for item in system.constraints],
        "sites": [(site.mover if site.mover != BASE else -1, site.X_BF.p) for site in sites],
    }
    source = replace(source, lines=(*source.lines, _RESPONSE), closing=("s = System('EP', generic + closing)",))
    model = SourceModel(source, _WAYS, given)
    return JointedEngine(NAME, PLUGIN.version(), model, chart_of(model, described), capabilities=CAPABILITIES)


def _obstacle(system: sf.System, assembly: Assembly) -> Unsupported | None:
    for mover in assembly.movers:
        if armature(system, mover):
            return Unsupported(f"joint '{mover.joint.name}': an armature, which bodies by themselves do not feel")
    for item in system.constraints:
        if not isinstance(item, sf.Closure | sf.Rod):
            return Unsupported(f"'{item.name}': no {type(item).__name__} among the connectors used")
        if isinstance(item, sf.Closure) and len(item.rotations) == 1:
            return Unsupported(f"closure '{item.name}': one blocked rotation is an angle to Exudyn, not a right angle")
    return None


def _connector(assembly: Assembly, system: sf.System, item: sf.Constraint) -> tuple[str, list[Any], dict[str, Any]]:
    """Class, ends and arguments of the Exudyn connector for a closure or a rod."""
    assert isinstance(item, sf.Closure | sf.Rod)
    ends = [_end(assembly.frames[anchor_name(assembly, anchor) or "world"]) for anchor in (item.first, item.second)]
    if isinstance(item, sf.Rod):
        length = float(sf.evaluate(item.length, system.parameter_values()))
        return "ObjectConnectorDistance", ends, {"distance": length}
    axes = [int(axis in blocked) for blocked in (item.translations, item.rotations) for axis in AXES]
    return "ObjectJointGeneric", ends, {"constrainedAxes": axes}


def _end(site: FrameSite) -> tuple[int, Array, Array]:
    return site.mover if site.mover != BASE else -1, site.X_BF.R, site.X_BF.p
