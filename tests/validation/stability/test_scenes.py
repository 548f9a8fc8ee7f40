"""The stability atlas: every scene on a coarse grid, that verdicts follow from the maps, and closed forms."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import symofros as sf
from validation.__main__ import app
from validation.reporting.command import Run
from validation.reporting.findings import Finding
from validation.stability import heatmap
from validation.stability.catalogue import SCENES
from validation.stability.report import TOPIC, compose, measure
from validation.stability.scene import Cell, Grid, Limit, Map, Maps, Scene, Subject, Verdict, cell, decades, survey
from validation.stability.scenes import baumgarte, beams, four_bars, light_bodies, spin, stick_slip


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("reports")
    done = CliRunner().invoke(app, ["stability", "--quick", "--json", "--report", str(folder)])
    data = json.loads(done.stdout)
    missed = [(c["what"], c["found"]) for s in data["scenes"].values() for c in s["checks"] if not c["ok"]]
    assert done.exit_code == 0, (missed, data["failures"])
    return folder, data


@pytest.fixture(scope="module")
def maps() -> dict[str, Maps]:
    """Coarse maps of scenes that take less than a second."""
    names = ("baumgarte", "redundant", "stiff_beam", "damped_beam", "light_link", "stick_slip", "spin", "deflection")
    return {name: survey(SCENES[name], quick=True) for name in names}


def test_the_catalogue_is_whole() -> None:
    assert len(SCENES) >= 14
    for name, scene in SCENES.items():
        assert scene.question.endswith("?") and scene.advice.endswith(".") and scene.sources, name
        assert scene.bound > 0 and re.search(r"\[.+\]$", scene.quantity), name
        for grid in (scene.x, scene.y):
            assert re.search(r"\[.+\]$", grid.name), f"{name}: an axis has its unit"
            assert list(grid.values) == sorted(set(grid.values)) and len(grid.few) >= 2, name
        assert len({subject.name for subject in scene.subjects}) == len(scene.subjects)


def test_every_claim_holds_on_a_coarse_grid(quick: tuple[Path, dict[str, Any]]) -> None:
    _, data = quick
    assert data["ok"] and data["quick"] and not data["failures"] and not data["unfinished"]
    assert list(data["scenes"]) == list(SCENES)
    for name, scene in data["scenes"].items():
        assert scene["checks"] and re.search(r"\d", scene["verdict"]), f"{name}: a verdict has figures"
        for found in scene["maps"].values():
            ended, values = np.array(found["ended"]), np.array(found["values"], dtype=object)
            assert values.shape == (len(found["y"]), len(found["x"]))
            # Nothing is silently wrong: what has no number has an outcome.
            assert all(
                (v is None) == (e not in ("finished", "event"))
                for v, e in zip(values.ravel(), ended.ravel(), strict=True)
            ), name


def test_the_page_is_whole_and_self_contained(quick: tuple[Path, dict[str, Any]]) -> None:
    folder, data = quick
    page, summary = ((folder / f"stability.{kind}").read_text() for kind in ("html", "md"))
    assert page.count("<figcaption>") == len(SCENES)
    assert page.count('role="img"') == sum(len(scene["maps"]) for scene in data["scenes"].values())
    assert not re.search(r'(src|href)="(?!#)', page) and "<script" not in page and "nan" not in page.lower().split()
    for name in SCENES:
        assert f"python -m validation stability --scene {name} --quick" in page and f"--scene {name}" in summary


@pytest.mark.parametrize("name", ["baumgarte", "stiff_beam", "damped_beam", "light_link", "spin", "deflection"])
def test_a_verdict_follows_from_its_maps(maps: dict[str, Maps], name: str) -> None:
    """Maps without a bad run have no edge: words change, and a claim about the edge is missed."""
    scene = SCENES[name]
    flat = {
        key: replace(one, cells=tuple(tuple(Cell(scene.bound / 2) for _ in row) for row in one.cells))
        for key, one in maps[name].items()
    }
    verdict, other = scene.judge(maps[name]), scene.judge(flat)
    assert other.statement != verdict.statement and all(finding.ok for finding in verdict.findings)
    assert not all(finding.ok for finding in other.findings) or name == "deflection"


# Closed forms, written here a second time.
@pytest.mark.parametrize(("method", "bound"), [("rk4", 2 * math.sqrt(2)), ("semi_implicit_euler", 2.0)])
@pytest.mark.parametrize("modes", [1, 3])
def test_explicit_steps_hold_up_to_the_closed_form(method: str, bound: float, modes: int) -> None:
    k = [1.8751040687, 4.6940911330, 7.8547574382][modes - 1]
    omega = k**2 * math.sqrt(beams.EI / beams.RHO_A)
    below, above = (beams.ring(modes, method, share * bound / omega) for share in (0.997, 1.003))
    assert below.outcome.ok and beams.growth(below) < beams.BOUND
    assert not above.outcome.ok or beams.growth(above) > beams.BOUND


def test_overdamped_modes_bound_the_step_by_the_damping() -> None:
    omega, c = float(beams.frequencies(3)[-1]), 1.0
    assert beams.closed_form(c) == pytest.approx(2.7852936 / (c * omega**2), rel=1e-3)
    assert beams.closed_form(1e-9) == pytest.approx(2 * math.sqrt(2) / omega, rel=1e-3)


@pytest.mark.parametrize(("method", "bound"), [("rk4", 2.7852936), ("euler", 2.0)])
def test_gains_hold_up_to_the_closed_form(method: str, bound: float) -> None:
    h = 1e-4
    held, lost = (baumgarte.swing(method, h, share * bound / h, 1.0) for share in (0.98, 1.01))
    assert held.outcome.ok and baumgarte.violation(held) < baumgarte.BOUND
    assert lost.outcome.kind == "diverged" and "smaller dt" in lost.outcome.advice


def test_growth_without_foreshortening() -> None:
    assert spin.rate(5.0) == pytest.approx(math.sqrt(25.0 - 3.5160152685**2), rel=1e-3)


def test_a_light_link_rings_as_the_model_says() -> None:
    m = light_bodies.pendulum(light_bodies.STIFFNESS).with_parameters(m2=1e-4)
    found = sf.modes(m, np.zeros(2)).frequencies[-1]
    assert light_bodies.fastest(1e-4, light_bodies.STIFFNESS) == pytest.approx(float(found), rel=1e-9)


def test_exact_stick_slip_is_a_motion() -> None:
    """Continuous, never backwards, and with the force balance m x'' = k e - F while it slips."""
    t = np.linspace(0.0, 4.0, 400001)
    x = stick_slip.exact(t)
    v = np.gradient(x, t)
    assert np.abs(np.diff(x)).max() < 1e-5 and v.min() > -1e-6
    slipping = (v[2:-2] > 0.01) & (v[:-4] > 0.01) & (v[4:] > 0.01)
    force = stick_slip.SPRING * (stick_slip.PULL * t - x) - stick_slip.DYNAMIC
    np.testing.assert_allclose(np.gradient(v, t)[2:-2][slipping], force[2:-2][slipping], atol=2e-3)


def test_the_row_of_four_bars_keeps_its_energy() -> None:
    (angle, speed), J = four_bars.START, four_bars.inertia(2)
    later = four_bars.exact(2, (0.0, 3.0))[:, -1]
    energy = [J[0] / 2 * w**2 + J[1] * math.sin(a) for a, w in ((angle, speed), later)]
    assert energy[1] == pytest.approx(energy[0], rel=1e-11)


def a_map(values: list[list[float]], bound: float = 1.0, limits: tuple[Limit, ...] = ()) -> Map:
    cells = tuple(tuple(Cell(v) if math.isfinite(v) else Cell(v, "diverged", "why") for v in row) for row in values)
    x, y = 10.0 ** np.arange(len(values[0])), 10.0 ** np.arange(len(values))
    return Map(Subject("s", lambda x, y: Cell(0.0), limits), x, y, cells, bound)


class TestMaps:
    FOUND = a_map([[0.1, 0.1, 0.1], [0.1, 0.1, 5.0], [0.1, math.nan, 7.0]])

    def test_what_is_good_wrong_and_stopped(self) -> None:
        assert (int(self.FOUND.good.sum()), self.FOUND.wrong, self.FOUND.stopped) == (6, 2, 1)

    def test_edges(self) -> None:
        assert self.FOUND.edge("y") == [(10.0, 10.0, 100.0), (100.0, 1.0, 10.0)]
        assert self.FOUND.edge("x") == [(10.0, 10.0, 100.0), (100.0, 1.0, 10.0)]

    @pytest.mark.parametrize(("limit", "missed"), [(20.0, 2.0), (10.0, 1.0), (200.0, 20.0), (5.0, 2.0)])
    def test_how_far_a_closed_form_misses_the_edge(self, limit: float, missed: float) -> None:
        assert self.FOUND.miss("y", lambda x: limit) == pytest.approx(missed)

    def test_no_edge_misses_every_bound(self) -> None:
        assert not Finding("", a_map([[0.1, 0.1]]).miss("x", lambda y: 1.0), 100.0).ok

    def test_a_run_that_ends_without_a_number_is_refused(self) -> None:
        with pytest.raises(ArithmeticError, match="has no number"):
            Cell(math.nan)

    def test_a_run_that_stops_keeps_its_reason(self) -> None:
        run = baumgarte.swing("rk4", 1e-2, 1e4)
        found = cell(run, baumgarte.violation)
        assert found.ended == "diverged" and "fastest speed" in found.note and math.isnan(found.value)

    def test_picture(self) -> None:
        grid = Grid("p [-]", (1.0, 10.0, 100.0), (1.0, 100.0))
        found = a_map(
            [[0.1, 0.1, 0.1], [0.1, 0.1, 5.0], [0.1, math.nan, 7.0]],
            limits=(Limit("one", np.array([1.0, 100.0]), np.array([10.0, 10.0])),),
        )
        drawing = heatmap.draw(found, grid, grid, "a < b [m]")
        svg = drawing.svg
        cells: Counter[str] = Counter()
        for kind, boxes in re.findall(r'<path class="([a-z-]+)"[^>]* d="([^"]*)"', svg):
            cells[kind] += boxes.count("M")
        assert cells == {"good-cell": 6, "bad-cell": 2, "ended": 1}
        # The edge: below the two bad columns, left of the middle and of the right one.
        assert svg.count('class="edge"') == 4 and drawing.note.endswith("a < b [m]")
        assert [name for _, name in drawing.legend] == [
            "at most 1",
            "more",
            "ended before (×)",
            "edge as measured",
            "one",
        ]
        (points,) = re.findall(r'class="form f0" points="([^"]*)"', svg)
        heights = {float(pair.split(",")[1]) for pair in points.split()}
        # The closed form at 10 runs through the middle row.
        (middle,) = {round(h, 1) for h in heights}
        assert middle == pytest.approx((heatmap.HEIGHT - 52 + 12) / 2, abs=0.2)


def test_decades() -> None:
    assert decades(0.1, 10.0, 1) == (0.1, 1.0, 10.0)


def test_a_missed_bound_fails_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    missed = replace(SCENES["spin"], judge=lambda maps: Verdict("1.", "2.", (Finding("zero", 1.0, 0.0),)))
    monkeypatch.setitem(SCENES, "spin", missed)
    done = CliRunner().invoke(app, ["stability", "--scene", "spin", "--quick", "--report", str(tmp_path)])
    assert done.exit_code == 1 and "1 miss their bounds" in done.stdout
    # One scene has a folder of its own, and leaves the whole atlas as it is.
    assert "**missed** 1" in (tmp_path / "stability" / "stability.md").read_text()


def test_a_scene_that_can_not_be_done_keeps_no_other_from_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(x: float, y: float) -> Cell:
        raise ArithmeticError("no")

    scene = SCENES["spin"]
    monkeypatch.setitem(SCENES, "spin", replace(scene, subjects=(Subject("s", broken),)))
    atlas = measure(Run(TOPIC), ["spin", "redundant"], quick=True)
    assert (
        not atlas["ok"] and atlas["failures"] == {"spin": "ArithmeticError: no"} and atlas["scenes"]["redundant"]["ok"]
    )


def test_ctrl_c_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(x: float, y: float) -> Cell:
        raise KeyboardInterrupt

    monkeypatch.setitem(SCENES, "spin", replace(SCENES["spin"], subjects=(Subject("s", interrupted),)))
    atlas = measure(Run(TOPIC), ["redundant", "spin", "deflection"], quick=True)
    assert list(atlas["scenes"]) == ["redundant"] and atlas["unfinished"] == ("spin", "deflection") and not atlas["ok"]
    assert "Interrupted: spin, deflection" in compose(atlas).summary


def test_ctrl_c_within_a_run_ends_the_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run itself makes an outcome of it, with the part before it kept."""

    def stopped(*given: Any, **settings: Any) -> sf.Trajectory:
        run = whole(*given, **settings)
        return replace(run, outcome=sf.Outcome("interrupted", 0.0, "Ctrl-C; the part up to here is kept"))

    whole = sf.simulate
    monkeypatch.setattr(sf, "simulate", stopped)
    assert measure(Run(TOPIC), ["deflection", "redundant"], quick=True)["unfinished"] == ("deflection", "redundant")


def test_an_unknown_scene_is_refused() -> None:
    done = CliRunner().invoke(app, ["stability", "--scene", "spinn"])
    assert done.exit_code == 2 and "no scene 'spinn'" in done.output


def test_progress_is_told_of_every_run() -> None:
    told: list[int] = []
    scene: Scene = SCENES["spin"]
    survey(scene, True, lambda: told.append(1))
    assert len(told) == scene.runs(True)
