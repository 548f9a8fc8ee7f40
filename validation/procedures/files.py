"""One robot in the formats that hold it, written here by hand: what the readers make of each is the same mechanism."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import symofros as sf

from ..contract.quantities import ROUNDING
from .scene import Cell, Scene, off

# Poses in links, in joints' frames and in frames of their own; an inertia that is turned; an axis along another frame;
# a link that is welded; a joint in the middle of its child.
SDF = """<sdf version="1.9"><model name="arm">
  <frame name="mast"><pose>0.1 0.2 0.5 0.3 -0.2 0.4</pose></frame>
  <link name="upper"><pose relative_to="shoulder"/>
    <inertial><mass>2</mass><pose>0.2 0.05 -0.03 0.3 0.1 -0.2</pose>
      <inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz><ixy>0.01</ixy><ixz>-0.02</ixz><iyz>0.005</iyz></inertia>
    </inertial></link>
  <joint name="shoulder" type="revolute"><pose relative_to="mast">0.05 0 0 0 0.5 0</pose>
    <parent>world</parent><child>upper</child><axis><xyz expressed_in="mast">0 0.6 0.8</xyz></axis></joint>
  <link name="lower"><pose relative_to="upper">0.4 0 0.1 0 0 0.7</pose>
    <inertial><mass>1.2</mass><pose>0.1 -0.02 0.04 0 0 0</pose>
      <inertia><ixx>0.05</ixx><iyy>0.06</iyy><izz>0.07</izz></inertia></inertial></link>
  <joint name="elbow" type="prismatic"><pose>0.02 0.01 0 0.2 0 0</pose>
    <parent>upper</parent><child>lower</child><axis><xyz>1 0 0</xyz></axis></joint>
  <link name="tool"><pose relative_to="lower">0.3 0 0 0 0.4 0</pose>
    <inertial><mass>0.3</mass><inertia><ixx>0.01</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial></link>
  <joint name="weld" type="fixed"><parent>lower</parent><child>tool</child></joint>
</model></sdf>"""


def native() -> sf.System:
    """The same arm, stated by our nouns."""
    mast = sf.RigidBody(
        "mast", sf.Joint("m", "fixed", position=(0.1, 0.2, 0.5), rotation=sf.Rotation.rpy(0.3, -0.2, 0.4))
    )
    turn = np.array([[np.cos(0.5), 0.0, -np.sin(0.5)], [0.0, 1.0, 0.0], [np.sin(0.5), 0.0, np.cos(0.5)]])
    x, y, z = map(float, turn @ [0.0, 0.6, 0.8])  # Of the mast, along the joint's own axes.
    shoulder = sf.Joint(
        "shoulder", "revolute", "mast", position=(0.05, 0, 0), rotation=sf.Rotation.rpy(0, 0.5, 0), axis=(x, y, z)
    )
    upper = sf.Inertia(
        2.0, (0.2, 0.05, -0.03), (0.1, 0.2, 0.25, 0.01, -0.02, 0.005), rotation=sf.Rotation.rpy(0.3, 0.1, -0.2)
    )
    # The joint is placed in its child, and moves along an axis of its own frame there.
    elbow = sf.Joint(
        "elbow", "prismatic", "upper", position=(0.4, 0, 0.1), rotation=sf.Rotation.rpy(0, 0, 0.7), axis=(1.0, 0.0, 0.0)
    )
    weld = sf.Joint("weld", "fixed", "lower", position=(0.3, 0, 0), rotation=sf.Rotation.rpy(0, 0.4, 0))
    return sf.System(
        "arm",
        (
            mast,
            sf.RigidBody("upper", shoulder, upper),
            sf.RigidBody("lower", elbow, sf.Inertia(1.2, (0.1, -0.02, 0.04), (0.05, 0.06, 0.07))),
            sf.RigidBody("tool", weld, sf.Inertia(0.3, moments=(0.01, 0.02, 0.02))),
        ),
    )


def read(_: Scene) -> Iterator[Cell]:
    """M, h and the place of the last link, of SDF."""
    functions = sf.Options(("mass_matrix", "bias", "frame_pose"), ("tool",), backend="interpreter")
    ours = sf.compile(native(), functions)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "arm.sdf")
        file.write_text(SDF, encoding="utf-8")
        theirs = sf.compile(sf.load(file), functions)
    rng, worst = np.random.default_rng(12), 0.0
    for _k in range(5):
        q, v = rng.uniform(-1.0, 1.0, (2, 2))
        for one, other in (
            (theirs.mass_matrix(q), ours.mass_matrix(q)),
            (theirs.bias(q, v), ours.bias(q, v)),
            (theirs.frame_pose("tool", q)[0], ours.frame_pose("tool", q)[0]),
            (theirs.frame_pose("tool", q)[1], ours.frame_pose("tool", q)[1]),
        ):
            worst = max(worst, off(one, other))
    yield Cell("an arm read from SDF", worst, ROUNDING)
