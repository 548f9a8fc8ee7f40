"""The viewer without a browser: what it serves, what is shown, what is dropped."""

from __future__ import annotations

import socket
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import ShapeError, SymofrosError, UnknownNameError

PATIENCE = 10.0  # Seconds that a thread may take on a busy machine.


def until(condition: object) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < deadline, "it did not come to pass"
        time.sleep(0.005)


@pytest.fixture
def viewer() -> Iterator[sf.Viewer]:
    with sf.Viewer(MODELS["planar_robot"], port=0) as made:
        yield made


def node(viewer: sf.Viewer, name: str) -> object:
    return viewer._server.scene.get_handle_by_name(f"/mechanism/{name}")


def test_the_viewer_listens_only_on_this_machine(viewer: sf.Viewer) -> None:
    assert viewer.host == "127.0.0.1" and viewer.url.startswith(f"http://127.0.0.1:{viewer.port}/")
    with socket.create_connection(("127.0.0.1", viewer.port), timeout=60):
        pass
    # Every address of 127.0.0.0/8 is this machine; a server that is bound to all of them would answer on another, too.
    with socket.socket() as other:
        other.settimeout(5)
        assert other.connect_ex(("127.0.0.2", viewer.port)) != 0


def test_section_forces_are_plotted_over_the_span_at_the_instant_shown() -> None:
    system = MODELS["spinning_beam"]
    model = sf.compile(system)
    run = sf.simulate(model, t_end=0.02, dt=1e-3)
    with sf.Viewer(system, port=0) as viewer:
        viewer.play(run)
        viewer.toggle()
        plot = viewer._panel.force_plot
        assert plot is not None
        choice = next(choice for choice in plot.choices if choice.endswith(": Mz"))
        plot.choose(choice)
        forces = run.section_forces(plot.choices[choice][0])
        for k in (0, 10, len(run) - 1):
            viewer.seek(float(run.t[k]))
            x, low, high, now = plot._plot.data
            np.testing.assert_allclose(now, forces["Mz"][k], atol=1e-12)
            np.testing.assert_array_equal((x, low, high), (forces.x, *(side[:, 5] for side in forces.envelope)))
        plot.choose("none")
        viewer.play((run.t, run.q))  # Coordinates alone have no forces.
        assert viewer._panel.force_plot is None


def test_an_invalid_address_or_a_port_in_use_is_refused(viewer: sf.Viewer) -> None:
    for host, port in (("127.0.0.1", 70000), ("192.0.2.1", 0)):
        with pytest.raises(SymofrosError, match="can't serve at"):
            sf.Viewer(MODELS["pendulum"], host=host, port=port)
    with pytest.raises(SymofrosError, match=rf"can't serve at 127.0.0.1:{viewer.port}\n(.*\n)*.*another port, or 0"):
        sf.Viewer(MODELS["pendulum"], port=viewer.port)


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(SymofrosError, match=r"viser is not installed\n(.*\n)*  remedy: pip install 'symofros\[view\]'"):
        sf.Viewer(MODELS["pendulum"])


def test_show_puts_links_where_the_model_has_them_and_beams_bend_by_their_bones(
    viewer: sf.Viewer, rng: np.random.Generator
) -> None:
    q, _ = viewer.mechanism.model.random_state(rng)
    viewer.show(q)
    posture = viewer.mechanism.posture(q)
    for i in range(len(viewer.mechanism.tree.links)):
        assert np.allclose(node(viewer, f"link{i}").position, posture.p[i])
    q = viewer.mechanism.model.neutral()
    q[viewer.mechanism.model.names.q.index("link1.bend_y[2]")] = 0.01
    viewer.show(q)
    bones = viewer._scene_state.scene._beams[0].bones
    plain = bones[-1].position[1]
    viewer.exaggeration = 8.0
    assert plain > 0.005 and bones[-1].position[1] == pytest.approx(8 * plain)


class TestPush:
    def test_the_newest_state_is_shown(self, viewer: sf.Viewer) -> None:
        nq = viewer.mechanism.model.nq
        for k in range(500):
            viewer.push(k / 500, np.full(nq, k / 500))
        until(lambda: viewer.painted + viewer.dropped == 500)
        assert viewer.state.q[0] == 499 / 500
        viewer.push(0.0, np.full(nq, np.nan))  # Not finite: the picture stays.
        until(lambda: viewer._wanted is None)
        with viewer._painting:
            assert viewer.state.q[0] == 499 / 500
        with pytest.raises(ShapeError, match=r"q has shape \(10,\)"):
            viewer.push(0.0, [0.0])

    def test_push_does_not_wait_for_drawing(self, viewer: sf.Viewer) -> None:
        q = viewer.mechanism.model.neutral()
        done = threading.Event()

        def loop() -> None:
            for k in range(100):
                viewer.push(k, q)
            q[:] = 0.5  # It has copied.
            done.set()

        with viewer._painting:  # As if the picture took for ever.
            threading.Thread(target=loop, daemon=True).start()
            assert done.wait(PATIENCE)
        assert viewer.dropped == 99
        until(lambda: viewer.painted == 1)
        assert np.all(viewer.state.q == 0.0)

    def test_the_newest_state_is_shown_after_a_delay(self, viewer: sf.Viewer) -> None:
        nq = viewer.mechanism.model.nq
        with viewer._painting:
            viewer.push(0.0, np.ones(nq))
            time.sleep(0.1)  # The worker wakes, and waits for the picture.
            viewer.show(np.full(nq, 0.5))
        time.sleep(0.1)
        assert np.all(viewer.state.q == 0.5)


class TestPlay:
    def test_playing_continues_until_paused(self, viewer: sf.Viewer) -> None:
        t = np.array([0.0, 1000.0])
        q = np.zeros((2, viewer.mechanism.model.nq))
        q[1, 0] = 1000.0
        viewer.play((t, q))
        until(lambda: viewer.state.q[0] > 0.1)
        viewer.toggle()
        stands = viewer.state.q[0]
        time.sleep(0.1)
        assert viewer.state.q[0] == stands
        viewer.seek(500.0)
        assert viewer.state.q[0] == pytest.approx(500.0)
        viewer.play((t / 10_000, q), loop=False)  # It ends.
        until(lambda: not viewer._is_playing())
        assert viewer.state.q[0] == pytest.approx(1000.0)

    def test_a_trajectory_brings_its_parameters(self, viewer: sf.Viewer) -> None:
        model = sf.compile(viewer.mechanism.system).with_parameters(L1=0.8)
        viewer.play(sf.simulate(model, t_end=0.01, dt=1e-3))
        assert viewer._scene_state.scene.drawing.beams[0].length == pytest.approx(0.8)


class TestMove:
    def test_named_coordinates_move_and_loops_close(self) -> None:
        with sf.Viewer(MODELS["four_bar"], port=0) as viewer:
            first, *others = (slider.label for slider in viewer.sliders)
            assert viewer.move({first: 1.2}) == ""
            values = dict(zip((slider.label for slider in viewer.sliders), viewer.values, strict=True))
            assert values[first] == pytest.approx(1.2)
            state = viewer.state
            assert np.abs(viewer.mechanism.model.constraint(state.q, par=state.par)).max() < 1e-9
            assert all(abs(values[other]) > 0.1 for other in others)

    @pytest.mark.parametrize(("values", "par"), [({"q11": 1.0}, {}), ({}, {"L11": 1.0})])
    def test_a_wrong_name_moves_nothing(
        self, viewer: sf.Viewer, values: dict[str, float], par: dict[str, float]
    ) -> None:
        with pytest.raises(UnknownNameError, match="did you mean"):
            viewer.move({"q1": 0.3, **values}, par)
        assert np.all(viewer.state.q == 0.0)
        before, index = viewer.state.par.copy(), viewer.mechanism.model.names.par.index("L1")
        viewer.move({}, {"L1": 0.8})  # Those that are not named stay.
        assert viewer.state.par[index] == 0.8 and np.flatnonzero(viewer.state.par != before).tolist() == [index]


def test_a_dragged_frame_is_followed_as_near_as_it_gets(viewer: sf.Viewer) -> None:
    """The tool goes to where its handle is; out of reach it points there; beams keep their bending."""
    moved: list[int] = []
    viewer.drag("tool", lambda: moved.append(viewer.painted))
    handle = viewer._handle
    assert handle is not None
    model = handle.model
    reach = float(np.linalg.norm(model.frame_pose("tool", model.neutral())[0]))
    bend = 0.01
    viewer.move({"link1.bend_y[2]": bend})
    for place in (np.array([0.5, 0.6, 0.0]) * reach, np.array([0.0, 3.0, 0.0]) * reach):
        handle._is_dragged = True
        handle.node.position = place
        viewer._dragged(False)
        tool = np.asarray(model.frame_pose("tool", viewer.state.q)[0])
        if np.linalg.norm(place) < reach:
            assert tool == pytest.approx(place, abs=1e-6)
        assert viewer.state.q[model.names.q.index("link1.bend_y[2]")] == bend
        assert tool @ place > 0.95 * np.linalg.norm(tool) * np.linalg.norm(place)
    assert len(moved) == 2 and np.asarray(handle.node.position) == pytest.approx(place)
    handle._is_dragged = False
    viewer._dragged(True)
    assert np.asarray(handle.node.position) == pytest.approx(tool, abs=1e-6)
    viewer.reset()
    assert np.asarray(handle.node.position) == pytest.approx([reach, 0.0, 0.0], abs=1e-6)
    viewer.set_system(MODELS["planar_robot"])
    assert viewer._handle is not None and viewer._handle.frame == "tool"
    viewer.set_system(MODELS["double_pendulum"])
    assert viewer._handle is None
    with pytest.raises(UnknownNameError):
        viewer.drag("nose")


def test_a_slider_leaves_the_picture_where_loops_cannot_be_closed() -> None:
    stop = sf.Rod("rod", ("world", None), ("b", "end"), 1.0)
    body = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0), (sf.Frame("end"),))
    with sf.Viewer(sf.System("s", [body], constraints=[stop]), port=0) as viewer:
        viewer.show([1.0])
        viewer.slide(0, 0.3)
        assert viewer.state.q[0] == 1.0


def test_only_visible_parameters_and_other_systems_redraw_the_scene(viewer: sf.Viewer) -> None:
    model, scene = viewer.mechanism.model, viewer._scene_state.scene
    q, par = model.neutral(), np.array(model.parameter_values)
    par[model.names.par.index("k1")] *= 2
    viewer.show(q, par=par)
    assert viewer._scene_state.scene is scene
    par[model.names.par.index("L2")] *= 2
    viewer.show(q, par=par)
    assert viewer._scene_state.scene is not scene
    assert viewer._scene_state.scene.drawing.beams[1].length == pytest.approx(0.8)
    before = viewer.mechanism
    with pytest.raises(sf.DescriptionError):
        viewer.set_system(sf.System("empty"))
    assert viewer.mechanism is before
    with viewer._painting:
        viewer.push(0.0, np.ones(model.nq))  # Forgotten.
        viewer.set_system(MODELS["four_bar"])
    assert viewer.mechanism.model.nq == 3 and node(viewer, "link7") is None and viewer.state.q.shape == (3,)
    viewer.show([1.2, -1.2, 1.2])
    assert viewer.state.q[0] == 1.2
    viewer.reset()
    assert np.all(viewer.state.q == 0.0)


def test_controls_follow_what_is_shown(viewer: sf.Viewer) -> None:
    with pytest.raises(sf.UnknownNameError, match=r"no layer 'frame'\n(.*\n)*  remedy: did you mean 'frames'\?"):
        viewer.set_layer("frame", True)
    viewer.set_layer("frames", True)
    viewer.exaggeration = 7.0
    viewer.show(np.full(10, 0.25))
    panel = viewer._panel
    assert panel._boxes["frames"].value and not panel._boxes["labels"].value
    assert panel._exaggeration.value == 7.0 and panel._sliders[0].value == 0.25


def test_a_state_that_bends_beams_beyond_a_per_cent_of_error_is_remarked_on(viewer: sf.Viewer) -> None:
    (beam, *_), panel = viewer.mechanism.model.beams(), viewer._panel
    q = viewer.mechanism.model.neutral()
    q[beam.q] = 0.01 * beam.length
    viewer.exaggeration = 40.0  # Of the picture, not of the beam.
    viewer.show(q)
    assert not panel._warning.content
    q[beam.q] = 0.2 * beam.length
    viewer.show(q)
    assert panel._warning.content.startswith(f"**Large bending:** beam '{beam.name}' bends by ")
    viewer.reset()
    assert not panel._warning.content


def test_closing_twice_is_allowed_and_frees_the_port(viewer: sf.Viewer) -> None:
    port = viewer.port
    viewer.close()
    viewer.close()
    with sf.Viewer(MODELS["pendulum"], port=port) as again:
        assert again.port == port


def test_view_opens_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    with sf.view(MODELS["pendulum"], q=[0.5], port=0) as viewer:
        assert opened == [viewer.url] and viewer.state.q[0] == 0.5
    before = threading.active_count()  # Nothing is served where it fails.
    with pytest.raises(ShapeError):
        sf.view(MODELS["pendulum"], q=[0.5, 1.0], port=0, browser=False)
    until(lambda: threading.active_count() <= before)
