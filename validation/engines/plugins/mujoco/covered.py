"""Scenes of features (`models.covering`) in what promises MuJoCo's numbers: every field of the data, after one step.

MuJoCo's C of the same release steps the same scene; it says by itself how far roundings go: it is asked again where all
numbers that are set are off by the other's roundings.
"""

from __future__ import annotations

from collections.abc import Collection
from importlib.metadata import version

from ...functions.devices import FIELDS
from ...interface import Slot, Tree, Unsupported
from ...models.covering import mjcf
from ..writing.source import Source, Way

_SLOTS = ((Slot("free wxyz, linear before and angular after", (0, 1, 2, 3, 4, 5, 6), (0, 1, 2, 3, 4, 5)),),)
# Fields that are asked of scenes at rest, too: what an engine has wrong at speeds hides nothing else there.
_AT_REST = ("qfrc_constraint", "qacc", "sensordata:ACC", "qpos", "qvel")
_STATE = ("scene_qpos", "scene_qvel", "scene_act", "scene_time")
# Roundings that a field may be off by: of the largest entry, and of what is set, as they move each entry.
_ROUNDINGS = 256
# What iterations leave of accelerations under constraints, as part of the largest.
_SOLVED = 1e-3
# `stepped(m, given)` of the engine: the field of a name.
_COMPARED = f"""m = mj.MjModel.from_xml_string(TEXT)
def set_to(numbers):
    d = mj.MjData(m)
    sizes = dict(qvel=m.nv, ctrl=m.nu, act=m.na, qfrc_applied=m.nv)
    given = {{name: np.resize(numbers[k:], n) for k, (name, n) in enumerate(sizes.items())}}
    mj.mj_integratePos(m, d.qpos, np.resize(numbers[4:], m.nv), 0.5)
    xfrc = np.resize(numbers[5:], (m.nbody, 6))
    return dict(given, qpos=np.array(d.qpos), xfrc_applied=xfrc * (np.arange(m.nbody) > 0)[:, None])
def in_c(given, m=m):
    d = mj.MjData(m)
    for name, values in given.items(): getattr(d, name)[:] = values
    mj.mj_step(m, d)
    return d
def near(given, seed):
    draw = np.random.default_rng(seed)
    def off(x): return x + 2.0**-23 * np.maximum(np.abs(x), 1.0) * draw.choice([-1.0, 1.0], x.shape)
    return {{name: off(x) for name, x in given.items()}}
def part(name, of):
    field, _, stage = name.partition(':')
    x = np.ravel(np.asarray(of(field), float))
    if not stage: return x
    return x[np.repeat(m.sensor_needstage, m.sensor_dim) == getattr(mj.mjtStage, 'mjSTAGE_' + stage)]
asked = {{}}
def agrees(name, *state, at_rest=False):
    numbers = np.concatenate(state)
    if (key := (numbers.tobytes(), at_rest)) not in asked:
        given = set_to(numbers)
        if at_rest: given['qvel'] = 0 * given['qvel']
        other = [in_c(near(given, seed)) for seed in range(4)]
        asked[key] = in_c(given), other, stepped(m, given)
    d, other, engine = asked[key]
    x, y = part(name, lambda field: getattr(d, field)), part(name, engine)
    moved = [np.abs(part(name, lambda field: getattr(one, field)) - x) for one in other]
    allowed = {_ROUNDINGS} * ROUNDOFF * (np.max(moved, axis=0) * 2.0**23 + np.max(np.abs(x), initial=1e-3))
    # MuJoCo Warp, from 3.10.0.2 on: M qacc - qfrc_smooth, which is off by their roundings without constraints, too.
    if name == 'qfrc_constraint': allowed += {_ROUNDINGS} * ROUNDOFF * np.max(np.abs(d.qfrc_smooth), initial=0.0)
    if d.nefc:
        if name in ('qacc', 'qfrc_constraint', 'sensordata:ACC'): allowed += {_SOLVED} * np.max(np.abs(x), initial=0.0)
        if name in ('qpos', 'qvel'): allowed += {_SOLVED} * m.opt.timestep * np.max(np.abs(d.qacc))
    if x.shape != y.shape: return np.inf
    return 1.0 + max((abs(a - b) / c for a, b, c in zip(x, y, allowed) if not abs(a - b) <= c), default=0.0)"""


def ways(without: Collection[str] = ()) -> dict[str, Way]:
    """A way of each field that an engine has."""
    made = {
        name: Way(native, f"value = agrees({field!r}, q, v, a, tau)") for name, (field, native, _) in FIELDS.items()
    }
    made |= {
        f"{name}:at rest": Way(native, f"value = agrees({field!r}, q, v, a, tau, at_rest=True)")
        for name, (field, native, _) in FIELDS.items()
        if field in _AT_REST
    }
    return {name: way for name, way in made.items() if name.partition(":")[0] not in without}


def _is_of_one_release(package: str) -> bool:
    """Whether the MuJoCo beside it is of its release, or of one before or after: that is whose numbers it promises."""
    own, other = ([int(one) for one in version(name).split(".")[:2]] for name in (package, "mujoco"))
    return own[0] == other[0] and abs(own[1] - other[1]) <= 1


def by_scenes() -> Unsupported:
    """What is said of trees of features, which MuJoCo itself is asked about."""
    return Unsupported("pairs of features are asked by scenes", offered=False)


def write(tree: Tree, package: str, roundoff: float, lines: str) -> Source | Unsupported:
    """Text that answers of a scene.

    Args:
        tree: The tree that stands for it.
        package: The engine's package.
        roundoff: Unit roundoff of the engine's numbers.
        lines: Statements that define `stepped`.
    """
    if not _is_of_one_release(package):
        return Unsupported(f"MuJoCo {version('mujoco')} is beside it, of another release", offered=False)
    own = _COMPARED.replace("ROUNDOFF", repr(roundoff))
    # MuJoCo leaves it at zero then, which its documentation does not say.
    lacks: tuple[str, ...] = ("scene_actuator_velocity",) if "no actuation" in tree.features else ()
    if "RK4" in tree.features:  # Of which of its stages the other fields are, no documentation says.
        lacks = tuple(name for name in ways() if name.partition(":")[0] not in _STATE)
    return Source(
        (
            "import numpy as np",
            "import mujoco as mj",
            f"TEXT = {mjcf(tree.features)!r}",
            *lines.split("\n"),
            *own.split("\n"),
        ),
        _SLOTS,
        7,
        6,
        lacks=lacks,
    )
