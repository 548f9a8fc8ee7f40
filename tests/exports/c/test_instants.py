"""Packages step through what their formulas of time do within a step, as sf.simulate does, whoever cuts the run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import build, run, sources
from tests.pulses import END, SHAPES, cart, drawn

# What the methods leave between two instants, at the default bounds; rk4 of a bell, about which instants are half a
# width apart in the middle and several at its ends.
BOUND = {"dopri5": 1e-4, "rk4": 4e-3}
# Lengths of a call: the run at once, parts of it, and parts that share no instant with the pulses.
CALLS = (END, 0.1, 0.0130723)
MAIN = Path(__file__).with_name("instants.c").read_text()


Speeds = Callable[[str, str, float, list[tuple[float, float]]], list[float]]


@pytest.fixture(scope="module")
def speeds(tmp_path_factory: pytest.TempPathFactory) -> Speeds:
    """Last speeds of a package of a force and a method, by length of a call and pulses; each package is built once."""
    built: dict[tuple[str, str], Path] = {}

    def last(force: str, method: str, span: float, pulses: list[tuple[float, float]]) -> list[float]:
        if (force, method) not in built:
            folder = tmp_path_factory.mktemp("cart") / "c"
            sf.export(cart(force), "c", folder, method=method, dt=0.01, functions=["dynamics"])
            (folder / "main.c").write_text(MAIN)
            built[force, method] = build(folder, "../cart", *sources(folder))
        words = [repr(number) for pulse in pulses for number in pulse]
        lines = run(built[force, method], repr(span), *words, cwd=built[force, method].parent).splitlines()
        assert all(line.split()[0] == "1" for line in lines)
        return [float(line.split()[1]) for line in lines]

    return last


@pytest.mark.parametrize("method", BOUND)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_pulse_gives_its_impulse_in_calls_of_any_length(speeds: Speeds, shape: str, method: str) -> None:
    """A package whose steps do not end at instants leaves the cart at rest."""
    force, impulse = SHAPES[shape]
    pulses = drawn(12)
    for span in CALLS:
        for pulse, speed in zip(pulses, speeds(force, method, span, pulses), strict=True):
            assert speed == pytest.approx(impulse, rel=BOUND[method]), (span, pulse)


def test_more_instants_than_memory_holds_shorten_the_search(speeds: Speeds) -> None:
    """Three operands of a comb, with 9549 kinks in the run; each of its teeth counts."""
    force = "max(abs(sin(1000*t)), max(cos(1000*t), 0)) + 0*late*width"
    x = np.linspace(0.0, 1000.0 * END, 4_000_001)
    wanted = float(np.trapezoid(np.maximum(np.abs(np.sin(x)), np.cos(x)), x)) / 1000.0
    for span in (END, 0.1):
        assert speeds(force, "dopri5", span, [(5.0, 1e-3)]) == pytest.approx([wanted], rel=1e-5)


@pytest.mark.parametrize("target", ["sfunction", "cuda"])
def test_targets_that_cannot_locate_instants_note_formulas_of_time_that_jump(target: str, tmp_path: Path) -> None:
    force, _ = SHAPES["tent"]
    stated = sf.export(cart(force), target, tmp_path / "tent").notes
    assert any("formulas of time bend, jump or are narrow" in note for note in stated)
    smooth = sf.export(cart("sin(t) + late + width"), target, tmp_path / "smooth").notes
    assert not any("formulas of time" in note for note in smooth)
