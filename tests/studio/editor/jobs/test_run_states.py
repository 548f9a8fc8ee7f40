"""Runs read back from what the page holds: with speeds, states of forces and parameters that a run sets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.yaml import write_yaml
from symofros.studio.editor.jobs.operations import simulate
from symofros.studio.editor.jobs.run_states import states_of, trajectory_of
from symofros.studio.editor.server.document_viewer import DocumentViewer


def skidding() -> sf.System:
    """A ball that slides on the ground until it rolls, and a block that bristles hold."""
    ball = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    ground = sf.Contact("ground", ("ball", None), ("world", None), restitution=0.0, radius=0.1, friction=0.3)
    block = sf.RigidBody("block", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(0.5))
    way = sf.Contact(
        "way",
        ("block", None),
        ("world", None),
        1e4,
        radius=1e-3,
        friction=0.5,
        bristle_stiffness=1e4,
        bristle_damping=10.0,
    )
    return sf.System("skidding", [ball, block], connections=[ground, way])


def simulated(system: sf.System, **options: Any) -> dict[str, Any]:
    """In this process; a worker does the same."""
    return simulate({"file": "model.yaml", "text": write_yaml(system), "options": options}, lambda *_: None)


def test_a_run_is_read_back_and_its_forces_are_drawn() -> None:
    system = skidding()
    model = sf.compile(system)
    start = model.neutral()
    start[model.names.q.index("free.pz")], start[model.names.q.index("free.px")] = 0.1, 2.0
    v = dict.fromkeys(model.names.v, 0.0) | {"free.wx": 1.0, "x": 0.1}
    run = sf.simulate(model, start, list(v.values()), 0.1, output=0.01)
    assert run.changes and model.nz
    result = simulated(
        system, t_end=0.1, points=10, q0={"free.pz": 0.1, "free.px": 2.0}, v0={"dfree.wx": 1.0, "dx": 0.1}
    )
    read = trajectory_of(model, result)
    assert read is not None
    for name in ("t", "q", "v", "u", "z", "par_over_time", "a", "lam"):
        np.testing.assert_allclose(getattr(read, name), getattr(run, name), rtol=1e-6, atol=1e-8, err_msg=name)
    np.testing.assert_array_equal(np.asarray(states_of(result).par), read.par_over_time)
    assert (
        trajectory_of(model, {**result, "series": [each for each in result["series"] if each["kind"] != "v"]}) is None
    )
    view = DocumentViewer(lambda kind, data: None)
    try:
        view.follow(system)
        viewer = view._viewer
        assert viewer is not None and view.pose({})["legend"] == []

        def arrows() -> Any:
            return viewer._server.scene.get_handle_by_name("/mechanism/forces")

        shown = view.pose({"forces": True, "moments": True})
        assert shown["forces"] and "simulate" in shown["legend"][0] and arrows() is None
        assert view.seek(result, 0.05)["legend"][0].startswith("forces (red)") and arrows().visible
        tails = np.array(arrows().points)[:, 0]
        assert np.abs(tails - run.frames["ball"][0][5] + [0.0, 0.0, 0.1]).max(axis=1).min() < 1e-4
        first = view.pose({"q": {"x": 0.3}})
        assert "simulate" in first["legend"][0] and not arrows().visible
        still = {**result, "series": [each for each in result["series"] if each["kind"] != "v"]}
        assert "no speeds" in view.seek(still, 0.05)["legend"][0] and not arrows().visible
        view.seek(result, 0.05)
        assert view.pose({"forces": False, "moments": False})["legend"] == [] and not arrows().visible
    finally:
        view.close()


def test_states_after_a_run_that_diverged_are_left_out() -> None:
    model = sf.compile(skidding())
    result = simulated(skidding(), t_end=0.02, points=4, q0={"free.pz": 0.1})
    for each in result["series"]:
        each["values"][3:] = [None, None]
    read = trajectory_of(model, result)
    assert read is not None and len(read) == len(read.par_over_time) == 3 and read.t[-1] == pytest.approx(0.01)
