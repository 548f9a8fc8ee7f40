"""Motions: between states, and from files."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import ShapeError, SymofrosError
from symofros.mechanics.topology.tree import build_tree
from symofros.studio.viewer.playing import motion as motion_module
from symofros.studio.viewer.playing.motion import PlayedMotion, motion_of, read_motion
from symofros.studio.viewer.playing.player import Player
from symofros.studio.viewer.playing.signals import coordinate_units
from symofros.studio.viewer.playing.sliders import coordinates_of, sliders_of, values_of
from tests.late import require


@pytest.fixture(scope="module")
def pendulum() -> sf.Model:
    return sf.compile(MODELS["double_pendulum"], sf.Options(backend="interpreter"))


@pytest.fixture(scope="module")
def run(pendulum: sf.Model) -> sf.Trajectory:
    return sf.simulate(sf.compile(MODELS["double_pendulum"]), [1.0, 0.5], None, 0.5, dt=0.01)


def motion(model: sf.Model, t: object, q: object) -> PlayedMotion:
    return motion_of(model, (t, q))


def test_between_states_it_goes_straight(pendulum: sf.Model) -> None:
    q, u, _ = motion(pendulum, [0.0, 1.0, 3.0], [[0.0, 0.0], [1.0, 2.0], [0.0, 4.0]]).at([-1.0, 0.25, 2.0, 9.0])
    assert np.allclose(q, [[0.0, 0.0], [0.25, 0.5], [0.5, 3.0], [0.0, 4.0]]) and u.shape == (4, pendulum.nu)
    assert np.allclose(motion(pendulum, [3.0], [[0.1, 0.2]]).at([0.0, 9.0])[0], [[0.1, 0.2]] * 2)  # One stands.


def test_orientations_turn_on_the_shortest_way() -> None:
    body = sf.RigidBody("b", sf.Joint("j", "ball"), sf.Inertia(1.0, moments=(1.0, 1.0, 1.0)))
    model = sf.compile(sf.System("s", [body]), sf.Options(backend="interpreter"))
    start, end = [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, np.sin(0.5), np.cos(0.5)]
    q, *_ = motion(model, [0.0, 2.0], [start, end]).at(1.0)
    assert np.allclose(q, [0.0, 0.0, np.sin(0.25), np.cos(0.25)])


def test_two_states_at_one_time_are_before_and_after(pendulum: sf.Model) -> None:
    m = motion(pendulum, [0.0, 1.0, 1.0, 2.0], [[0, 0], [1, 1], [5, 5], [6, 6]])
    assert np.allclose(m.at([1.0 - 1e-9, 1.0])[0], [[1, 1], [5, 5]], atol=1e-6)


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".parquet"])
def test_files_that_trajectories_write_are_read(
    suffix: str, pendulum: sf.Model, run: sf.Trajectory, tmp_path: Path
) -> None:
    file = run.save(tmp_path / f"run{suffix}")
    if suffix == ".csv":  # Which may begin with a mark of the order of bytes.
        file.write_text(file.read_text(), encoding="utf-8-sig")
    found = read_motion(file, pendulum)
    assert np.array_equal(found.t, run.t) and np.array_equal(found.q, run.q) and found.u.shape == run.u.shape


def test_prescribed_motions_are_read(tmp_path: Path) -> None:
    joint = sf.Joint("lift", "prismatic", prescribed=True)
    swing = sf.Joint("swing", "revolute", "cart", axis=(0, 1, 0))
    bodies = [
        sf.RigidBody("cart", joint, sf.Inertia(1.0)),
        sf.RigidBody("rod", swing, sf.Inertia(1.0, (0, 0, -1), (1, 1, 1))),
    ]
    model = sf.compile(sf.System("s", bodies))
    run = sf.simulate(model, t_end=0.2, u={"lift": "sin(t)"}, dt=0.01)
    for suffix in (".npz", ".csv"):
        found = read_motion(run.save(tmp_path / f"run{suffix}"), model)
        assert np.allclose(found.u[:, 0], np.sin(run.t))


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.txt", "", r"can't read 'a.txt'\n  found:  .txt\n  rule:   one of .npz, .csv, .parquet"),
        ("a.csv", "t,q1\n0,1\n", r"does not fit the model\n  found:  columns t, q1\n.*\n  remedy: missing: q2"),
        ("b.csv", "t,q1,q2\n0,1,two\n", "'b.csv' is not a .csv file"),
        ("c.csv", "t,q1,q2\n0,1\n", "'c.csv' is not a .csv file"),
        ("d.csv", "t,q1,q2\n", r"no states\n  rule:   one finite state at least"),
        ("h.csv", "t,q1,q2,q1\n0,1,2,3\n", "several columns are called q1"),
        ("i.csv", "t,q1,q2\n0,1,2\nnan,1,2\n2,1,2\n", "time 1 of 3 is missing or not finite"),
        ("e.csv", "t,q1,q2\n1,0,0\n0,0,0\n", "times that fall"),
        ("f.npz", "not an archive", "'f.npz' is not a .npz file"),
        ("g.parquet", "not parquet", "'g.parquet' is not a .parquet file"),
    ],
)
def test_other_files_are_refused(name: str, text: str, expected: str, pendulum: sf.Model, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(SymofrosError, match=expected):
        read_motion(tmp_path / name, pendulum)


def test_quaternions_of_no_direction_and_sizes_that_overflow_end_a_motion() -> None:
    """Between such states there is no way."""
    body = sf.RigidBody("body", sf.Joint("j", "free"), sf.Inertia(1.0, moments=(1, 1, 1)))
    model = sf.compile(sf.System("s", (body,)), sf.Options(backend="interpreter"))
    still = model.neutral()
    turned_off, far, unset = still.copy(), still.copy(), still.copy()
    turned_off[3:], far[0], unset[6] = 0.0, 1e308, 1e-200
    for bad in (turned_off, far, unset):
        played = motion(model, [0, 1, 2, 3], [still, still, bad, still])
        assert len(played.t) == 2 and np.isfinite(played.at([0.0, 0.5, 1.0])[0]).all()
        with pytest.raises(ShapeError, match="the first not finite"):
            motion(model, [0, 1], [bad, still])


def test_archives_are_checked(pendulum: sf.Model, tmp_path: Path) -> None:
    for arrays, expected in (
        ({"q": [[0.0, 0.0]]}, "add t"),
        ({"t": [0.0], "q": [[0.0]]}, r"q \(1, 1\)"),
        ({"t": [0.0], "q": [[0.0, 0.0]], "names_q": ["a", "b"]}, "coordinates a, b"),
        ({"t": [0.0], "q": [[0.0, 0.0]], "par": [1.0]}, r"par \(1,\)"),
    ):
        np.savez(tmp_path / "m.npz", **{name: np.array(value) for name, value in arrays.items()})
        with pytest.raises(ShapeError, match=expected):
            read_motion(tmp_path / "m.npz", pendulum)


def test_pickles_in_archives_are_not_opened(pendulum: sf.Model, tmp_path: Path) -> None:
    np.savez(tmp_path / "m.npz", t=np.array([{"a": 1}], dtype=object), q=np.zeros((1, 2)))
    with pytest.raises(SymofrosError, match=r"is not a .npz file\n.*allow_pickle"):
        read_motion(tmp_path / "m.npz", pendulum)


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".parquet"])
def test_motion_files_beyond_the_display_limit_are_refused_without_unpacking_them(
    pendulum: sf.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """A few kilobytes can stand for gigabytes."""
    monkeypatch.setattr(motion_module, "MAX_NUMBERS", 50)
    columns = {"t": np.zeros(100), "q1": np.zeros(100), "q2": np.zeros(100)}
    if suffix == ".npz":
        np.savez_compressed(tmp_path / "m.npz", t=columns["t"], q=np.zeros((100, 2)))
    elif suffix == ".csv":
        (tmp_path / "m.csv").write_text("t,q1,q2\n" + "0,0,0\n" * 100)
    else:
        pa = require("pyarrow", "parquet")
        importlib.import_module("pyarrow.parquet").write_table(pa.table(columns), tmp_path / "m.parquet")
    with pytest.raises(SymofrosError, match=f"'m{suffix}' is too large") as caught:
        read_motion(tmp_path / f"m{suffix}", pendulum)
    assert ("50" if suffix == ".csv" else "100") in caught.value.problem.found
    (tmp_path / "m.csv").write_text("t" * 5000)  # Refused before it is read.
    with pytest.raises(SymofrosError, match="'m.csv' is too large"):
        read_motion(tmp_path / "m.csv", pendulum)


def test_a_run_of_another_system_is_refused(run: sf.Trajectory) -> None:
    other = sf.compile(MODELS["four_bar"], sf.Options(backend="interpreter"))
    with pytest.raises(ShapeError, match=r"coordinates q1, q2\n  rule:   the model's are q1, q2, q3"):
        motion_of(other, run)


def test_columns_of_parquet_have_one_name_and_times_are_stated(pendulum: sf.Model, tmp_path: Path) -> None:
    pa = require("pyarrow", "parquet")
    parquet = importlib.import_module("pyarrow.parquet")
    file, x = tmp_path / "a.parquet", pa.array([0.0, 1.0])
    parquet.write_table(pa.Table.from_arrays([x, x, x, x], ["t", "q1", "q1", "q2"]), file)
    with pytest.raises(SymofrosError, match="several columns are called q1"):
        read_motion(file, pendulum)
    parquet.write_table(pa.table({"t": pa.array([0.0, None]), "q1": x, "q2": x}), file)
    with pytest.raises(SymofrosError, match="time 1 of 2 is missing"):
        read_motion(file, pendulum)
    for odd in (np.arange(2).astype("datetime64[s]"), ["a", "b"], [None, None]):
        parquet.write_table(pa.table({"t": x, "q1": odd, "q2": x}), file)
        with pytest.raises(SymofrosError, match="q1 is not an array of numbers"):
            read_motion(file, pendulum)


def test_a_player_goes_forward_within_its_motion(pendulum: sf.Model) -> None:
    player = Player(motion(pendulum, [1.0, 3.0], [[0, 0], [1, 1]]), speed=0.5)
    assert player.advance(1.0) == 1.0  # It stands until it is started.
    player.start()
    assert player.advance(1.0) == 1.5
    for asked, found in ((2.2, 2.2), (0.0, 1.0), (9.0, 3.0)):
        player.seek(asked)
        assert player.time == found
    player.seek(1.0)
    assert player.advance(5.0) == pytest.approx(1.5) and player.playing  # It begins again,
    player.loop = False
    assert player.advance(9.0) == 3.0 and not player.playing  # or stops at the end.
    player.start()
    assert player.time == 1.0
    for speed in (0.0, -1.0, float("nan")):
        with pytest.raises(SymofrosError, match="speed is a finite number above 0"):
            Player(player.motion, speed)


def model(name: str) -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(backend="interpreter"))


@pytest.mark.parametrize("name", ["joint_zoo", "torque_free_body", "free_boom", "planar_robot"])
def test_slider_values_and_configurations_are_inverse(name: str, rng: np.random.Generator) -> None:
    m = model(name)
    for _ in range(5):
        q, _ = m.random_state(rng)
        again = coordinates_of(m, values_of(m, q))
        assert np.allclose(m.difference(q, again), 0.0, atol=1e-12)


def test_sliders_are_named_bounded_and_have_units() -> None:
    m = model("joint_zoo")
    sliders = sliders_of(m, (False,) * m.nq)
    assert tuple(slider.speed for slider in sliders) == m.names.v
    assert all(slider.low < slider.high for slider in sliders) and len({slider.label for slider in sliders}) == m.nv
    m = model("torque_free_body")
    assert [slider.unit for slider in sliders_of(m, (False,) * m.nq)] == ["", "", "", "rad", "rad", "rad"]
    system = MODELS["planar_robot"]
    units = coordinate_units(build_tree(system))
    sliders = sliders_of(model("planar_robot"), (False,) * 10, units)
    assert {slider.unit for slider in sliders if "bend" in slider.label} == {"m"}
    assert {slider.unit for slider in sliders if "bend" not in slider.label} == {"rad"}


def test_a_free_body_moves_along_the_axes_it_stands_in() -> None:
    m = model("torque_free_body")
    labels = [slider.label.rpartition(".")[2] for slider in sliders_of(m, (False,) * m.nq)]
    assert labels == ["px", "py", "pz", "turn_x", "turn_y", "turn_z"]
    q = coordinates_of(m, np.array([1.0, 2.0, 3.0, 0.0, 0.0, np.pi / 2]))
    assert np.allclose(q, [1, 2, 3, 0, 0, np.sqrt(0.5), np.sqrt(0.5)])
