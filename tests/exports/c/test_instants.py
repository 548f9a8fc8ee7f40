"""Packages step through what their formulas of time do within a step, as sf.simulate does, whoever cuts the run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import packaged, run
from tests.pulses import END, SHAPES, cart, drawn

# What the methods leave between two instants, at the default bounds; rk4 of a bell, about which instants are half a
# width apart in the middle and several at its ends.
BOUND = {"dopri5": 1e-4, "rk4": 4e-3}
# Lengths of a call: the run at once, parts of it, and parts that share no instant with the pulses.
CALLS = (END, 0.1, 0.0130723)
MAIN = Path(__file__).with_name("instants.c").read_text()


Speeds = Callable[..., list[float]]


@pytest.fixture(scope="module")
def speeds(tmp_path_factory: pytest.TempPathFactory) -> Speeds:
    """Last speeds of a package of a force and a method, by length of a call and pulses; each package is built once."""
    built: dict[tuple[str, str, float], Path] = {}

    def last(force: str, method: str, span: float, pulses: list[tuple[float, float]], dt: float = 0.01) -> list[float]:
        key = force, method, dt
        if key not in built:
            given = {"method": method, "dt": dt, "functions": ["dynamics"]}
            built[key] = packaged(cart(force), tmp_path_factory.mktemp("cart") / "c", MAIN, **given)
        words = [repr(number) for pulse in pulses for number in pulse]
        lines = run(built[key], repr(span), *words, cwd=built[key].parent).splitlines()
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


def test_a_pulse_at_the_end_of_a_search_gives_its_impulse_in_calls_of_a_step(speeds: Speeds) -> None:
    """Instants are sought 1024 steps ahead: one whose middle lies just behind has begun before."""
    force, impulse = SHAPES["bell"]
    dt, width = 1e-3, 1e-4
    pulses = [(512 * k * dt + side * width, width) for k in range(2, 6) for side in (-0.5, 0.3, 1.5)]
    np.testing.assert_allclose(speeds(force, "rk4", dt, pulses, dt), impulse, rtol=BOUND["rk4"])


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
