"""The page in a real browser: what it shows, and that it moves. `--browser`; Chromium with software rendering.

`$CHROMIUM` names its program; otherwise it is looked for under its usual names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.studio.pictures import shot
from tests.studio.waiting import PATIENCE, at_rest, until

pytestmark = pytest.mark.browser

WIDTH, HEIGHT = 800, 500
PATIENCE_MS = 1000 * PATIENCE
Open = Callable[[str], Any]


@pytest.fixture
def open_page(chromium: Any) -> Iterator[Open]:
    """Opens a page, and waits until it draws; at the end no page may have had an error."""
    errors: list[str] = []
    contexts = []

    def opened(url: str) -> Any:
        contexts.append(chromium.new_context(viewport={"width": WIDTH, "height": HEIGHT}))
        page = contexts[-1].new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(url)
        page.wait_for_selector("canvas", timeout=PATIENCE_MS)
        until(page, lambda: (shot(page) < 200).any(axis=2).sum() > 200)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not errors


def test_the_page_has_a_scale_units_and_the_preferred_colours(chromium: Any) -> None:
    with sf.Viewer(MODELS["planar_robot"], port=0) as viewer:
        context = chromium.new_context(viewport={"width": WIDTH, "height": HEIGHT}, color_scheme="dark")
        page = context.new_page()
        page.goto(viewer.url)
        bar = page.get_by_role("img", name="Scale: ")
        bar.wait_for(timeout=PATIENCE_MS)

        def agrees() -> bool:  # The bar follows the page's camera, which reaches its place in a few messages.
            number, unit = bar.text_content().split()
            length = float(number) * {"m": 1.0, "cm": 0.01}[unit]
            box, canvas = bar.bounding_box(), page.locator("canvas").first.bounding_box()
            return box["width"] == pytest.approx(length * canvas["height"] / viewer.picture_height, rel=0.05)

        until(page, agrees)
        page.get_by_text("q1 [rad]").first.wait_for(timeout=PATIENCE_MS)
        assert page.title() == "planar_robot - SYMOFROS"
        until(page, lambda: page.locator("html").get_attribute("data-mantine-color-scheme") == "dark")
        until(page, lambda: np.median(shot(page)) < 100)
        # Two pages have two cameras: there is no one scale.
        other = context.new_page()
        other.goto(viewer.url)
        until(page, lambda: not bar.is_visible())
        context.close()


@pytest.mark.tools
def test_a_replay_simulates_on_without_a_server(open_page: Open, tmp_path: Path) -> None:
    """The flexible robot: its reader changes a coordinate, and its end is that of `sf.simulate`, to rounding."""
    model, dt = sf.compile(MODELS["planar_robot"]), 1 / 1200  # Whole steps in a picture of a sixtieth of a second.
    inputs = dict(zip(model.names.u, (0.5, -0.1, 0.02), strict=True))
    run = sf.simulate(model, model.neutral(), np.zeros(model.nv), 0.5, u=inputs, method="rk4", dt=dt)
    file = sf.record(MODELS["planar_robot"], run, tmp_path / "m.html", rate=10, simulate={"dt": dt})
    page = open_page(file.as_uri())
    page.context.set_offline(True)
    page.get_by_role("button", name="Simulate on from here").click()
    simulation = page.frame_locator("#onward iframe")
    instant = simulation.get_by_role("slider", name="Instant that is shown")

    def state() -> tuple[np.ndarray, np.ndarray]:
        fields = simulation.locator("#state input")
        until(page, lambda: fields.first.get_attribute("title") is not None)
        numbers = np.array(fields.evaluate_all("(all) => all.map((one) => Number(one.title))"))
        return numbers[: model.nq], numbers[model.nq :]

    def count() -> int:
        return int(instant.get_attribute("max") or 0)

    until(page, lambda: count() > 5)
    simulation.get_by_text("State", exact=True).click()
    simulation.get_by_role("spinbutton", name="q2", exact=True).fill("0.3")
    simulation.get_by_role("spinbutton", name="q2", exact=True).press("Enter")
    until(page, lambda: count() == 0)
    q0, v0 = state()
    assert q0[model.names.q.index("q2")] == 0.3
    assert simulation.get_by_role("slider", name="q1", exact=True).input_value() == "0.5"
    simulation.get_by_role("button", name="Go on").click()
    # A quarter of a second of it: later a joint that sticks lets go a step sooner or later by a matter of rounding.
    until(page, lambda: count() > 15)
    simulation.get_by_role("button", name="Pause").click()
    instant.fill("15")
    page.frames[-1].evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    q, v = state()
    native = sf.simulate(model, q0, v0, 0.25, u=inputs, method="rk4", dt=dt)
    np.testing.assert_allclose(q, native.q[-1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(v, native.v[-1], rtol=1e-9, atol=1e-10)
    page.get_by_role("button", name="Back to the replay").click()
    until(page, lambda: not page.locator("#onward").is_visible())


def swung() -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(0.0, 2.0, 21)
    return t, np.sin(t)[:, None] * np.linspace(0.5, 0.1, 10)


def click_at(plot: Any, share: float) -> None:
    box = at_rest(plot)
    plot.click(position={"x": 1 + share * (box["width"] - 2), "y": box["height"] / 2})


def test_a_click_into_the_plot_of_a_replay_moves_its_time(open_page: Open, tmp_path: Path) -> None:
    t, q = swung()
    extra = {"twice <t>": 2.0 * t}
    file = sf.record(MODELS["planar_robot"], (t, q), tmp_path / "m.html", rate=10, signals=extra)
    page = open_page(file.as_uri())
    page.locator("details.plot summary").click()
    page.get_by_label("Over time").select_option("q1 [rad]")
    plot = page.locator("canvas.over-time")
    click_at(plot, 0.75)
    shown = page.locator("#replay p").first
    until(page, lambda: shown.text_content() == "t = 1.500 s")
    legend = page.locator("ul.over-time")
    until(page, lambda: legend.text_content().endswith(f"q1 = {0.5 * np.sin(1.5):.4g}"))
    plot.press("ArrowLeft")
    plot.press("Home")
    until(page, lambda: shown.text_content() == "t = 0.000 s")
    plot.press("End")
    until(page, lambda: shown.text_content() == "t = 2.000 s")
    page.get_by_label("Over time").select_option("twice <t>")
    until(page, lambda: legend.text_content().endswith("twice <t> = 4.000"))


def test_a_click_into_the_plot_of_a_view_moves_its_time(open_page: Open) -> None:
    with sf.Viewer(MODELS["planar_robot"], port=0) as viewer:
        viewer.play(swung())
        viewer.toggle()
        page = open_page(viewer.url)
        page.get_by_text("Plot", exact=True).click()
        page.get_by_role("combobox", name="over time").click()
        page.get_by_role("option", name="q1 [rad]").click()
        plot = page.locator("canvas.over-time")
        plot.wait_for(timeout=PATIENCE_MS)
        click_at(plot, 0.25)
        until(page, lambda: abs(viewer._player.time - 0.5) < 0.02)
        np.testing.assert_allclose(viewer.state.q[0], 0.5 * np.sin(viewer._player.time), atol=1e-3)
        viewer.seek(1.0)
        until(page, lambda: plot.get_attribute("aria-valuenow") == "1.000")


def test_a_camera_is_kept_when_its_page_is_loaded_again_and_follows_a_body(open_page: Open) -> None:
    with sf.Viewer(MODELS["planar_robot"], port=0) as viewer:
        viewer.play(swung())
        viewer.toggle()
        viewer.seek(0.0)
        page = open_page(viewer.url)
        until(page, lambda: viewer.picture_height is not None)
        (client,) = viewer._server.get_clients().values()
        client.camera.position = client.camera.position + np.array([0.3, 0.1, 0.2])
        kept = np.array(client.camera.position)
        page.wait_for_timeout(1000)
        page.reload()

        def shown() -> bool:
            pages = list(viewer._server.get_clients().values())
            if len(pages) != 1 or pages[0].client_id == client.client_id or viewer.picture_height is None:
                return False
            return bool(np.allclose(pages[0].camera.position, kept, atol=1e-3))

        until(page, shown)
        page.get_by_role("combobox", name="camera follows").click()
        body = viewer.mechanism.tree.links[-1].name
        page.get_by_role("option", name=body, exact=True).click()
        until(page, lambda: viewer._camera_follow is not None)
        before = viewer._scene_state.posture.p[-2]
        viewer.seek(1.5)
        moved = viewer._scene_state.posture.p[-2] - before
        (client,) = viewer._server.get_clients().values()
        until(page, lambda: np.allclose(client.camera.position, kept + moved, atol=5e-3))
