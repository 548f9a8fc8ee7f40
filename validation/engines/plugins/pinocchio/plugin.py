"""Pinocchio: every joint model of its own API, and its readers."""

from __future__ import annotations

from ...interface import Convention, Statement, Tree, Unsupported
from ..writing.numbering import is_depth_first, numbered
from ..writing.source import Source, SourcePlugin
from ..writing.urdf import UNIT_AXIS
from . import again, algebra, constraints, data, functions, objects, poses
from .model import CLOSING, MODELS, write


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has Pinocchio read a file."""
    read = {
        # Before mimicking joints there was no argument for them.
        "urdf": (
            "try: m = pin.buildModelFromXML(TEXT, mimic=True)",
            "except TypeError: m = pin.buildModelFromXML(TEXT)",
        ),
        "mjcf": (
            "import tempfile",
            "file = tempfile.NamedTemporaryFile('w', suffix='.xml')",
            "print(TEXT, file=file, flush=True)",
            "m = pin.buildModelFromMJCF(file.name)",
        ),
        "urdf written": (
            "written, m = pin.buildModelFromXML(TEXT, mimic=True), pin.Model()",
            "m.loadFromString(written.saveToString())",
        ),
    }[form]
    made = numbered(tree, {key: model[1] for key, model in MODELS.items()})
    if isinstance(made, Unsupported):
        return made
    if form == "urdf written" and any(joint.mimics for link in tree.links for joint in link.joints):
        return Unsupported("mimicking joints that are read again hold what is not set", offered=False)
    slots, nq, nv = made
    names = [link.name for link in tree.links]
    lines = ("import numpy as np", "import pinocchio as pin", f"TEXT = {text!r}", *read)
    optional = {"fs": (f"fs = [m.getFrameId(name, pin.FrameType.BODY) for name in {names!r}]",)}
    if tree.sensors:
        optional["sensed"] = (f"sensed = [m.getFrameId(f'o{{k}}') for k in range({len(tree.sensors)})]",)
    return Source(lines, slots, nq, nv, optional, closing=CLOSING)


PLUGIN = SourcePlugin(
    name="pinocchio",
    package="pin",
    extra="pin",
    conventions=(
        Convention("quaternion", "x, y, z, w"),
        Convention("free joint", "linear and angular velocity in the axes of the body"),
        Convention(
            "constraints", "force on the first joint's body, along its frame; anchors' Jacobians have the other sign"
        ),
        Convention("armature", "m.armature; rotorInertia and rotorGearRatio have no effect on rnea, crba, aba"),
    ),
    kinds={},
    ways=functions.WAYS | again.WAYS | objects.WAYS | constraints.WAYS | poses.WAYS | algebra.WAYS | data.WAYS,
    write=write,
    constraints=constraints.KINDS,
    demands={
        "locked": "buildReducedModel",
        "attached": "appendModel",
        "sensors": "frames",
        "turns": "Quaternion, exp3, log3",
        "changed mass": "inertias",
        "changed inertia": "inertias",
        "changed frame": "jointPlacements",
        "changed gravity": "gravity",
    },
    formats=("urdf", "mjcf", "urdf written"),
    write_reading=write_reading,
    statements=(
        Statement(
            "precondition",
            "joints need to be added to the tree in a depth-first order",
            "pinocchio 4.1, src/multibody/model.hxx:394; https://github.com/stack-of-tasks/pinocchio/issues/1897",
            holds=lambda tree, text: not text and not is_depth_first(tree),
        ),
        Statement(
            "precondition",
            "computeCoriolisMatrix does not support mimic joints: asserted, which wheels are built without",
            "pinocchio 4.1, src/algorithm/rnea.hxx:732: assert(model.check(MimicChecker()))",
            "coriolis_forces|coriolis_symmetry",
            lambda tree, text: any(joint.mimics for link in tree.links for joint in link.joints),
        ),
        Statement(
            "precondition",
            "z of a frame from end to end is from the first towards the second point, as MJCF's page says; MuJoCo's "
            "own compiler takes the opposite",
            "https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-geom, fromto; "
            "https://github.com/newton-physics/newton/pull/3667",
            "frame_poses",
            lambda tree, text: "<site" in text and "fromto" in text,
        ),
        UNIT_AXIS,
    ),
)
