"""Ghosts: other runs beside the one that plays, at the same times."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import ShapeError, SymofrosError
from symofros.studio.viewer.drawing.poses import Mechanism, beam_sweep
from tests.studio.viewer.replays.unpacking import messages_of

SYSTEM = MODELS["planar_robot"]
T = np.linspace(0.0, 1.0, 11)


def motion(share: float, t: np.ndarray = T) -> tuple[np.ndarray, np.ndarray]:
    return t, share * t[:, None] * np.linspace(0.5, 0.1, 10)


def test_a_replay_has_ghosts_where_their_runs_are(tmp_path: Path) -> None:
    """At each picture that a ghost's run has a state at; hidden at the others."""
    mechanism = Mechanism(SYSTEM)
    late = motion(-1.0, np.linspace(0.3, 0.7, 5))
    runs = {"slow": motion(0.5), "<late>": late}
    page = sf.record(SYSTEM, motion(1.0), tmp_path / "m.html", ghosts=runs, exaggeration=2.0, rate=10).read_text()
    assert "slow" in page and "&lt;late&gt;" in page and "<late>" not in page
    messages = messages_of(page)
    drawing = mechanism.drawing()
    link = drawing.parts[-1].link
    for k, (t, q) in enumerate(runs.values()):
        where: dict[str, np.ndarray] = {}
        shown, seen = True, []
        beams: dict[tuple[str, int], np.ndarray] = {}
        for now in sorted({time for time, _ in messages if time < 1.05}):
            for time, message in messages:
                if time == now and message.get("name", "").startswith(f"/ghosts/{k}"):
                    if message["type"] == "SetPositionMessage":
                        where[message["name"]] = np.array(message["position"])
                    elif message["type"] == "SetBonePositionMessage":
                        beams[message["name"], message["bone_index"]] = np.array(message["position"])
                    elif message["type"] == "SetSceneNodeVisibilityMessage" and message["name"] == f"/ghosts/{k}":
                        shown = message["visible"]
            assert shown == (t[0] - 1e-9 <= now <= t[-1] + 1e-9)
            if shown:
                seen.append(now)
                at = np.array([np.interp(now, t, column) for column in q.T])
                posture = mechanism.posture(at, exaggeration=2.0)
                np.testing.assert_allclose(where[f"/ghosts/{k}/link{link}"], posture.p[link], atol=1e-4)
                sweep = beam_sweep(drawing.beams[0], posture)
                np.testing.assert_allclose(beams[f"/ghosts/{k}/tubes/0", 16], sweep.points[16], atol=1e-4)
        assert len(seen) == len(t)


def test_a_viewer_shows_ghosts_at_the_time_of_the_motion() -> None:
    with sf.Viewer(SYSTEM, port=0) as viewer:
        viewer.play(motion(1.0), ghosts={"short": motion(0.5, T[:6])})
        viewer.toggle()
        scene, link = viewer._server.scene, viewer.mechanism.drawing().parts[-1].link
        viewer.seek(0.4)
        root, node = (scene.get_handle_by_name(name) for name in ("/ghosts/0", f"/ghosts/0/link{link}"))
        posture = viewer.mechanism.posture(0.5 * motion(0.4, np.ones(1))[1][0])
        np.testing.assert_allclose(node.position, posture.p[link], atol=1e-12)
        assert root.visible
        tube = scene.get_handle_by_name("/ghosts/0/tubes/0")
        viewer.set_layer("bodies", False)
        assert not tube.visible
        viewer.set_layer("bodies", True)
        bent = np.array(tube.bones[16].position)
        viewer.exaggeration = 5.0
        assert not np.allclose(tube.bones[16].position, bent, atol=1e-3)
        viewer.seek(0.6)
        assert not root.visible
        viewer.seek(0.5)
        assert root.visible
        viewer.set_system(SYSTEM)
        assert not root.visible and scene.get_handle_by_name(f"/ghosts/0/link{link}") is None


def test_ghosts_that_cannot_be_shown_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SymofrosError, match="6 ghosts at most"):
        sf.record(SYSTEM, motion(1.0), tmp_path / "m.html", ghosts={str(k): motion(1.0) for k in range(7)})
    with pytest.raises(SymofrosError, match="ghosts are for .html"):
        sf.record(SYSTEM, motion(1.0), tmp_path / "m.gif", ghosts={"a": motion(0.5)})
    with pytest.raises(SymofrosError, match="ghosts of no motion"):
        sf.view(SYSTEM, ghosts={"a": motion(0.5)}, port=0, browser=False)
    with pytest.raises(ShapeError):
        sf.record(SYSTEM, motion(1.0), tmp_path / "m.html", ghosts={"a": (T, np.zeros((11, 3)))})
    assert not list(tmp_path.iterdir())
