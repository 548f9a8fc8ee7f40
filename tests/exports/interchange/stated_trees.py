"""Random trees with noise in what is stated, and all that joints may have: limits, springs, dampers, friction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from tests.description.hostile.hostile_names import HOSTILE

# What URDF and MJCF hold; repeated: drawn more often.
SERIES = ("revolute", "prismatic", "continuous", "universal", "cylindrical", "planar", "fixed")
WITH_BALLS = (*SERIES, "ball", "ball")
NOISES = (0.0, 1e-16, 1e-12, 1e-9, 1e-7, 1e-6)
# Blanks at an end are lost in attributes of XML; "world" is the ground.
NAMES = [name for name in HOSTILE if name == name.strip()]


def stated_tree(seed: int, kinds: Sequence[str] = SERIES) -> sf.System:
    """A tree whose joints have all that a joint may have, some of its bodies without mass; equal seeds, equal trees."""
    rng = np.random.default_rng(seed)
    tree = random_tree(seed, 5, kinds, noisy=True)
    names = [str(name) for name in rng.permutation(NAMES)]
    called = {body.name: names.pop() for body in tree.bodies}
    parents = [body.joint.parent for body in tree.bodies if body.joint is not None]
    bodies = []
    for body in tree.bodies:
        assert isinstance(body, sf.RigidBody)
        joint = body.joint
        if joint is None:
            bodies.append(replace(body, name=called[body.name]))
            continue
        series = joint.kind not in ("ball", "free")
        joint = replace(
            joint,
            name=names.pop(),
            parent=called[joint.parent],
            actuated=bool(joint.actuated and joint.kind != "fixed"),
            limits=_limits(rng),
            armature=float(rng.choice([0.0, 0.3])),
            elements=tuple(_elements(rng, joint.traits.nv, series)),
        )
        if joint.kind == "fixed":
            joint = replace(joint, armature=0.0)
        carries = parents.count(body.name) == 1 and series and rng.random() < 0.4
        bodies.append(
            replace(body, name=called[body.name], joint=joint, inertia=None if carries else _noisy(rng, body))
        )
    return replace(tree, name="stated", bodies=tuple(bodies))


def _noisy(rng: np.random.Generator, body: sf.RigidBody) -> sf.Inertia | None:
    """Moments with noise; now and then those of a thin rod, for which two principal moments add up to the third."""
    inertia = body.inertia
    if inertia is None:
        return None
    noise = 1.0 + float(rng.choice(NOISES)) * rng.uniform(-1.0, 1.0, 6)
    if rng.random() < 0.3:
        across = 0.2 * noise[0]
        return replace(inertia, moments=(0.0, across, across, 0.0, 0.0, 0.0), about="center_of_mass")
    return replace(inertia, moments=tuple((np.array(inertia.moments) * noise).tolist()))


def _limits(rng: np.random.Generator) -> sf.Limits | None:
    """Any of the four numbers, zero and one place among them."""
    if rng.random() < 0.2:
        return None
    lower, upper = sorted(rng.uniform(-2.0, 2.0, 2).tolist())
    if rng.random() < 0.1:
        upper = lower
    speed, effort = (float(rng.choice([0.0, 1.5, 40.0])) for _ in range(2))
    kept = rng.random(4) < 0.6
    stated = [x if keep else None for x, keep in zip((lower, upper, speed, effort), kept, strict=True)]
    return sf.Limits(*stated)


def _elements(rng: np.random.Generator, nv: int, series: bool) -> list[sf.Spring | sf.Damper | sf.Friction]:
    """Springs with a rest and dampers, linear ones often; friction now and then."""
    made: list[sf.Spring | sf.Damper | sf.Friction] = []
    for k in range(nv):
        if rng.random() < 0.5:
            made.append(sf.Damper(float(rng.uniform(0.1, 2.0)), float(rng.choice([0.0, 0.0, 0.4])), k))
        for _ in range(int(rng.integers(0, 3)) if series else 0):
            stiffness, rest = rng.uniform(1.0, 9.0), rng.uniform(-1.0, 1.0)
            made.append(sf.Spring(float(stiffness), float(rest), float(rng.choice([0.0, 0.0, 0.7])), k))
        if rng.random() < 0.15:
            made.append(sf.Friction(0.2, coordinate=k))
    return made
