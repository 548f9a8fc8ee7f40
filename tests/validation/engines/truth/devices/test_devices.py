"""Small models of MJCF: MuJoCo's answers, and an answer that is off."""

from __future__ import annotations

import numpy as np
import pytest

from validation.engines.interface import Slot
from validation.engines.matrix import SEED, Judged, Truths, asked, judged
from validation.engines.models import single
from validation.engines.plugins import OWN
from validation.engines.plugins.mujoco.devices import together
from validation.engines.proving.pieces import Layout
from validation.engines.truth.devices import COMPILED
from validation.engines.truth.devices import DEVICES as GROUPS
from validation.engines.truth.dynamics import random_state
from validation.engines.verdicts import judge
from validation.engines.workers import Job

_TREES = single.trees()
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREES["drives"], _LAYOUT, 3)
# What MuJoCo does otherwise than it documents (causes/stated/mujoco.yaml).
_OFF = {"tendon_clipped_with_gear", "tendon_clipped_sensor_with_gear", "compiled_dof_invweight0"}


def _judged(group: str) -> dict[str, Judged]:
    pytest.importorskip("mujoco")
    plugin = OWN["mujoco"]
    names = tuple(name for name in asked(plugin, _TREES[group]) if ":" not in name)
    return {one.cell.function: one for one in judged(plugin, Job("mujoco", _TREES[group], names, SEED), Truths())}


@pytest.mark.parametrize("group", GROUPS | COMPILED)
def test_mujoco_does_as_it_documents(group: str) -> None:
    found = _judged(group)
    assert set(found) == set((GROUPS | COMPILED)[group])
    assert {name for name, one in found.items() if one.cell.verdict != "right"} <= _OFF


@pytest.mark.parametrize("group", GROUPS)
@pytest.mark.parametrize("engine", ["mujoco", "mjx", "mujoco-warp"])
def test_engines_are_asked_by_text_that_compiles(engine: str, group: str) -> None:
    plugin, tree = OWN[engine], _TREES[group]
    written = plugin.write(tree)  # type: ignore[attr-defined]
    names = asked(plugin, tree)
    assert len(names) > 5 and not tree.demands - set(plugin.demands)  # type: ignore[attr-defined]
    for name in names:
        compile(written.script((plugin.ways[name], _STATE)), name, "exec")  # type: ignore[attr-defined]


def test_models_of_one_set_of_options_are_put_together() -> None:
    made: dict[str, object] = {}
    exec(together("drives", GROUPS["drives"]).partition("def joined")[0], made)
    lots = made["LOTS"]
    assert isinstance(lots, list) and max(map(len, lots)) > 15
    assert sum(map(len, lots)) == len({one.model for one in GROUPS["drives"].values()})
    assert all(len(lot) == 1 for lot in lots if "<flag" in lot[0])


def test_unknown_devices_of_a_release_leave_the_others_together() -> None:
    mujoco = pytest.importorskip("mujoco")
    made: dict[str, object] = {"mj": mujoco}
    exec(together("springs and dampers", GROUPS["springs and dampers"]), made)
    first, second = made["LOTS"][0][:2]  # type: ignore[index]

    def prepared(m: object) -> object:
        if m.jnt_stiffnesspoly.any():  # type: ignore[attr-defined]
            raise NotImplementedError("polynomials")
        return m

    known = next(x for x in made["LOTS"][0] if made["known"](x, prepared))  # type: ignore[index, operator]
    whole, places = made["found"](known, prepared)  # type: ignore[operator]
    assert whole.nv > 1 and places("qpos").stop <= whole.nq
    with pytest.raises(NotImplementedError, match="polynomials"):
        made["found"](next(x for x in (first, second) if x != known), prepared)  # type: ignore[operator]


def test_an_answer_that_is_off_is_wrong() -> None:
    for name, one in _judged("drives").items():
        assert one.want is not None and isinstance(one.answer.value, np.ndarray)
        off = one.answer.value + 0.01
        assert judge("planted", _TREES["drives"], name, off, one.want).verdict == "wrong", name
