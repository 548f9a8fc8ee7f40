"""Scenes of features: each pair is there, MuJoCo agrees with itself, and what is wrong is found and made small."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from tests.late import needs_extra
from validation.engines.functions.devices import FIELDS
from validation.engines.interface import DOUBLE, SINGLE, State, Tree
from validation.engines.matrix import cells
from validation.engines.models.covering import chains, scenes
from validation.engines.models.covering.scenes import CHAIN, OPTIONS, trees
from validation.engines.plugins import OWN
from validation.engines.plugins.mujoco import covered
from validation.engines.plugins.writing.source import Source, SourceModel
from validation.engines.proving.shrink import Case, smallest

_ITSELF = "def stepped(m, given):\n    d = in_c(given)\n    return lambda name: getattr(d, name)"
# Where springs are disabled, dampers are left out, too.
_WRONG = """def stepped(m, given):
    d = in_c(given)
    if m.opt.disableflags & mj.mjtDisableBit.mjDSBL_SPRING: d.qfrc_passive[:] -= d.qfrc_damper
    return lambda name: getattr(d, name)"""

# Forces of constraints as the rest of all others, in single precision.
_REST = """def stepped(m, given):
    d = in_c(given)
    forces = np.concatenate([d.qfrc_constraint + d.qfrc_smooth, d.qfrc_smooth]).astype(np.float32)
    d.qfrc_constraint[:] = forces[:m.nv] * np.float32(1.0 + 2.0**-22) - forces[m.nv:]
    return lambda name: getattr(d, name)"""


def _there() -> set[frozenset[str]]:
    """Pairs of features that some scene has, first features included."""
    pairs: set[frozenset[str]] = set()
    for features in scenes.scenes():
        options = [next((one for one in named if one in features), next(iter(named))) for named in OPTIONS.values()]
        for number in "012":
            own = [one[3:] for one in features if one.startswith(number)]
            chain = [next((one for one in named if one in own), next(iter(named))) for named in CHAIN.values()]
            pairs |= set(map(frozenset, combinations((*options, *chain), 2)))
    return pairs


def test_each_pair_of_features_is_in_some_scene() -> None:
    """Apart from constraints where there are to be none."""
    factors = [[one for one in named if one != "no chain"] for named in (*OPTIONS.values(), *CHAIN.values())]
    wanted = {frozenset((a, b)) for one, other in combinations(factors, 2) for a in one for b in other}
    missing = wanted - _there()
    assert missing == {frozenset(("unconstrained", one)) for one in CHAIN["bound"] if one != "unbound"}


def _excess(tree: Tree, function: str, lines: str, roundoff: float = DOUBLE) -> float:
    """How far a field of an engine, made by lines, is beyond what roundings explain."""
    source = covered.write(tree, "mujoco", roundoff, lines)
    assert isinstance(source, Source)
    numbers = np.random.default_rng(3).uniform(-1.0, 1.0, 7)
    state = State(numbers, *(numbers[k : k + 6] for k in (0, 1)), numbers[:6][::-1].copy(), numbers[:6], numbers)
    value = SourceModel(source, covered.ways()).call(function, state)
    assert isinstance(value, np.ndarray)
    return float(value) - 1.0


def test_mujoco_agrees_with_itself() -> None:
    """No field is beyond roundings."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    made = list(trees().values())[::4]
    assert [tree.name for tree in made if _excess(tree, "scene_qvel", _ITSELF) != 0.0] == []
    assert {_excess(_without_rk4()[0], name, _ITSELF) for name in FIELDS} == {0.0}


def _without_rk4() -> list[Tree]:
    return [tree for tree in trees().values() if "RK4" not in tree.features]


def test_forces_of_constraints_are_known_to_the_roundings_of_others() -> None:
    """Without constraints, too, where they are zero; what is more than roundings is found."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    made = [tree for tree in _without_rk4() if "unconstrained" in tree.features][:4]
    assert {_excess(tree, "scene_qfrc_constraint", _REST, SINGLE) for tree in made} == {0.0}
    wrong = _REST.replace("2.0**-22", "2.0**-8")
    assert all(_excess(tree, "scene_qfrc_constraint", wrong, SINGLE) > 0.0 for tree in made)


def test_a_fault_at_speeds_hides_nothing_at_rest() -> None:
    """Speeds that are taken twice are none at rest; forces that are taken twice are seen there."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    fast, pushed = (
        _ITSELF.replace("in_c(given)", f"in_c(dict(given, {name}=2.0 * given['{name}']))")
        for name in ("qvel", "xfrc_applied")
    )
    tree = next(tree for tree in _without_rk4() if "unconstrained" in tree.features)
    assert _excess(tree, "scene_qacc", fast) > 0.0 and _excess(tree, "scene_qacc:at rest", pushed) > 0.0
    at_rest = [name for name in covered.ways() if name.endswith(":at rest")]
    assert len(at_rest) == 5 and {_excess(tree, name, fast) for name in at_rest} == {0.0}


def test_a_fault_of_two_features_is_found_and_made_small() -> None:
    """Dampers without springs."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    red = [tree for tree in _without_rk4()[:30] if _excess(tree, "scene_qfrc_passive", _WRONG) > 0.0]
    assert red and all("no spring" in tree.features for tree in red)
    assert _excess(red[0], "scene_xpos", _WRONG) == 0.0
    small = smallest(Case(red[0], ()), lambda case: _excess(case.tree, "scene_qfrc_passive", _WRONG) > 0.0)
    (joint,) = (one for one in small.tree.features if one.endswith(tuple(CHAIN["joint"])))
    (damped,) = set(small.tree.features) - {joint, "no spring"}
    assert "damper" in damped or "tendon" in damped
    assert _excess(replace(small.tree, features=(joint, damped)), "scene_qfrc_passive", _WRONG) == 0.0


def test_runge_kutta_steps_are_asked_for_their_end_alone() -> None:
    """Their other fields are of a stage that no documentation states."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    tree = next(tree for tree in trees().values() if "RK4" in tree.features)
    source = covered.write(tree, "mujoco", DOUBLE, _ITSELF)
    assert isinstance(source, Source) and "scene_xpos" in source.lacks
    assert {_excess(tree, name, _ITSELF) for name in FIELDS if name not in source.lacks} == {0.0}


def test_each_kind_of_joint_is_in_chains_with_each_other_feature() -> None:
    """Trees of what fewer engines know come after those that all know; the same each time."""
    made = list(chains.trees().values())
    pairs = {frozenset(map(_plain, both)) for tree in made for both in combinations(tree.features, 2)}
    kinds = ("ball", "universal", "planar", "helical oblique", "cylindrical", "offset hinges", "ellipsoid")
    others = ("free base", "ball beyond", "prismatic oblique beyond", "turned", "spherical inertia", "armature")
    assert {(kind, other) for kind in kinds for other in others} == {
        (kind, other) for kind in kinds for other in others if frozenset((kind, other)) in pairs
    }
    first = [tree for tree in made if tree.name.startswith("chain")][:3]
    assert {joint.kind for tree in first for link in tree.links for joint in link.joints} <= {
        "revolute",
        "prismatic",
        "fixed",
        "free",
    }


def _plain(feature: str) -> str:
    return feature.partition(": ")[2] or feature


def test_chains_are_driven_held_and_sensed_together() -> None:
    """Trees of forces have tendons, actuators of each kind and sensors; what MuJoCo answers of one is right."""
    pytest.importorskip("mujoco", reason=needs_extra("engine-mjx", "mujoco"))
    made = [tree for name, tree in chains.trees().items() if name.startswith("forces")]
    assert {"tendons", "heavy tendons", "activations", "affine gains", "compensation"} <= set().union(
        *(tree.forces for tree in made)
    )
    tree = next(tree for tree in made if tree.sensors and tree.actuators and tree.tendons)
    found = cells(OWN["mujoco"], tree, ("wrench_sensors", "joint_wrenches", "accelerometers_driven"))
    assert {cell.verdict for cell in found} == {"right"}
