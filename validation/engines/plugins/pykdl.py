"""PyKDL: Orocos' kinematics and dynamics of chains, by its API."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np

from ..interface import Convention, Rows, Slot, Tree, Unsupported, Vector
from .writing.source import Source, SourcePlugin, ways_of

# Where Debian's package for the system's Python puts it.
SYSTEM = Path("/usr/lib/python3/dist-packages")
_TYPES = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}
_HELPERS = """def jnt(values):
    array = K.JntArray(len(values))
    for k, value in enumerate(values):
        array[k] = value
    return array
def flat(array): return [array[k] for k in range(array.rows())]
def matrix(M): return np.array([[M[i, j] for j in range(M.columns())] for i in range(M.rows())])
def rates(q, v, frame):
    solver = K.ChainJntToJacDotSolver(chain)
    solver.setRepresentation(frame)
    out = []
    for s in tips:
        J = K.Jacobian(n)
        assert solver.JntToJacDot(K.JntArrayVel(jnt(q), jnt(v)), J, s) == 0
        out.append(matrix(J))
    return out"""


def _forces(call: str, inputs: str) -> str:
    return f"tau_ = K.JntArray(n)\nassert K.ChainDynParam(chain, g).{call}({inputs}, tau_) == 0\nvalue = flat(tau_)"


def _newton_euler(rates: str) -> str:
    return (
        "tau_, solver = K.JntArray(n), K.ChainIdSolver_RNE(chain, g)\n"
        "none = [K.Wrench() for _ in range(chain.getNrOfSegments())]\n"
        f"assert solver.CartToJnt(jnt(q), jnt(v), {rates}, none, tau_) == 0\n"
        "value = flat(tau_)"
    )


WAYS = ways_of(f"""
== mass_matrix | ChainDynParam.JntToMass
M = K.JntSpaceInertiaMatrix(n)
assert K.ChainDynParam(chain, g).JntToMass(jnt(q), M) == 0
value = matrix(M)
== gravity | ChainDynParam.JntToGravity | {_forces("JntToGravity", "jnt(q)")}
== coriolis_forces | ChainDynParam.JntToCoriolis | {_forces("JntToCoriolis", "jnt(q), jnt(v)")}
== inverse_dynamics | ChainIdSolver_RNE.CartToJnt | {_newton_euler("jnt(a)")}
== bias | ChainIdSolver_RNE.CartToJnt | {_newton_euler("jnt(0 * v)")}
== link_poses | ChainFkSolverPos_recursive.JntToCart
value = []
for s in tips:
    X = K.Frame()
    assert K.ChainFkSolverPos_recursive(chain).JntToCart(jnt(q), X, s) >= 0
    value.append([*X.p, *(X.M[i, j] for i in range(3) for j in range(3))])
== link_jacobians | ChainJntToJacSolver.JntToJac
value = []
for s in tips:
    J = K.Jacobian(n)
    assert K.ChainJntToJacSolver(chain).JntToJac(jnt(q), J, s) == 0
    value.append(matrix(J))
== link_velocities | ChainFkSolverVel_recursive.JntToCart
value = []
for s in tips:
    X = K.FrameVel()
    assert K.ChainFkSolverVel_recursive(chain).JntToCart(K.JntArrayVel(jnt(q), jnt(v)), X, s) >= 0
    value.append([*X.p.v, *X.M.w])
== link_jacobian_rates | ChainJntToJacDotSolver, HYBRID | value = rates(q, v, K.ChainJntToJacDotSolver.HYBRID)
== jacobian_rate_local | ChainJntToJacDotSolver, BODYFIXED | value = rates(q, v, K.ChainJntToJacDotSolver.BODYFIXED)
== jacobian_rate_world | ChainJntToJacDotSolver, INERTIAL | value = rates(q, v, K.ChainJntToJacDotSolver.INERTIAL)
""")


def _vector(p: Vector) -> str:
    return f"K.Vector({', '.join(repr(float(x)) for x in p)})"


def _frame(R: Rows, p: Vector) -> str:
    entries = ", ".join(repr(float(x)) for row in R for x in row)
    return f"K.Frame(K.Rotation({entries}), {_vector(p)})"


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a chain."""
    lines = ["import sys", "import numpy as np", f"sys.path.append({str(SYSTEM)!r})", "import PyKDL as K"]
    lines.append("chain = K.Chain()")
    slots: list[tuple[Slot, ...]] = []
    tips: list[int] = []
    count = segments = 0
    for k, link in enumerate(tree.links):
        if link.parent != k - 1:
            return Unsupported("dynamics of chains only", offered=False)
        own: list[Slot] = []
        for joint in link.joints:
            lines.append(f"chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), {_frame(joint.R, joint.p)}))")
            segments += 1
            if joint.kind == "fixed":
                continue
            if joint.kind not in ("revolute", "prismatic") or joint.form or joint.mimics:
                return Unsupported(f"no joint type for {joint.kind} {joint.form}".strip(), offered=False)
            turns = joint.kind == "revolute"
            letter = _TYPES.get(joint.axis)
            kind = f"K.Joint.{'Rot' if turns else 'Trans'}{letter or 'Axis'}"
            inertia = joint.armature[0] if joint.armature else 0.0
            about = kind if letter else f"K.Vector(), {_vector(joint.axis)}, {kind}"
            lines.append(f"chain.addSegment(K.Segment(K.Joint({about}, 1, 0, {inertia!r})))")
            own.append(Slot("angle" if turns else "length", (count,), (count,)))
            count, segments = count + 1, segments + 1
        J = np.array(link.inertia)
        moments = ", ".join(repr(float(J[i, j])) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        lines.append(
            "chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(), "
            f"K.RigidBodyInertia({link.mass!r}, {_vector(link.com)}, K.RotationalInertia({moments}))))"
        )
        segments += 1
        tips.append(segments)
        slots.append(tuple(own))
    lines += [f"g, n, tips = {_vector(tree.gravity)}, {count}, {tips!r}", _HELPERS]
    return Source(tuple(lines), tuple(slots), nq=count, nv=count)


def version() -> str:
    """Version of Debian's package, or of one on Python's own path; "" for none."""
    known = importlib.util.find_spec("PyKDL")
    if known is not None and SYSTEM not in Path(known.origin or "").parents:
        return "on Python's path"
    tag = f"cpython-{sys.version_info.major}{sys.version_info.minor}"
    if not any(SYSTEM.glob(f"PyKDL.{tag}*.so")):
        return ""
    query = ["dpkg-query", "--showformat=${Version}", "--show", "python3-pykdl"]
    try:
        return subprocess.run(query, capture_output=True, text=True, check=True).stdout.partition("-")[0]
    except (OSError, subprocess.CalledProcessError):
        return "of the system"


PLUGIN = SourcePlugin(
    name="pykdl",
    package="python3-pykdl",
    extra="(Debian) python3-pykdl",
    conventions=(
        Convention("dynamics", "of chains; trees have kinematics only"),
        Convention("Jacobians", "linear, then angular, along the world's axes at the segment's tip"),
        Convention("armature", "inertia of a joint"),
        Convention("floating base", "none"),
    ),
    kinds={
        "revolute x": "RotX",
        "revolute y": "RotY",
        "revolute z": "RotZ",
        "revolute oblique": "RotAxis",
        "prismatic": "TransX",
        "prismatic oblique": "TransAxis",
    },
    ways=WAYS,
    write=write,
    find=version,
)
