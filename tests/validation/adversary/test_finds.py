"""What `python -m validation adversary` found, shrunk, and what became of it: all scenes but one are sound now."""

from __future__ import annotations

import pytest

from validation.adversary.attack import Scene
from validation.adversary.catalogue import ATTACKS

# Attack, scene, what was mended.
FINDS: list[tuple[str, Scene, str]] = [
    (
        "closed_dynamics",
        {
            "mechanism": "four_bar",
            "form": "multipliers",
            "L": 0.1,
            "m1": 1e-08,
            "m2": 1e-08,
            "m3": 100000000.0,
            "J": 1.0,
            "angles": [0.1, 3.141592653589793, 0.1, 0.5, 0.5, 0.5],
            "speed": 1.0,
        },
        "the adversary's: rounding of entries of G that cancel counts now",
    ),
    (
        "closed_dynamics",
        {
            "mechanism": "four_bar",
            "form": "null_space",
            "L": 1e-05,
            "m1": 1.0,
            "m2": 1.0,
            "m3": 1.0,
            "J": 1.0,
            "angles": [0.5, 3.141592653589793, 0.5, 0.5, 0.5, 0.5],
            "speed": 0.1,
        },
        "the adversary's: rounding of entries of G that cancel counts now",
    ),
    (
        "closed_dynamics",
        {
            "mechanism": "held",
            "form": "null_space",
            "L": 1.0,
            "m1": 1.0,
            "m2": 1e-09,
            "m3": 1000.0,
            "J": 1e-05,
            "angles": [0.5, 0.5, 0.5, 0.5, 0.0, 0.5],
            "speed": 1.0,
        },
        "the adversary's: rounding of entries of G that cancel counts now",
    ),
    (
        "loop_runs",
        {
            "L": 0.001,
            "m": 1.0,
            "a": 1.0,
            "angle": -1.0,
            "speed": -3.0,
            "method": "dopri5",
            "step": 1.0,
            "records": 7,
            "span": 3.0,
        },
        "postures are looked at between steps, too: a long one leaps over a singular one",
    ),
    (
        "loop_runs",
        {
            "L": 1.0,
            "m": 1.0,
            "a": 0.9999,
            "angle": -1.0,
            "speed": -3.0,
            "method": "generalized_alpha",
            "step": 0.1,
            "records": 7,
            "span": 1.0,
        },
        "postures are looked at between steps, too: a long one leaps over a singular one",
    ),
    (
        "loop_runs",
        {
            "L": 1.0,
            "m": 1.0,
            "a": 0.9,
            "angle": 1.2,
            "speed": 10.0,
            "method": "rk4",
            "step": 0.01,
            "records": 7,
            "span": 1.0,
        },
        "postures are looked at between steps, too: a long one leaps over a singular one",
    ),
    (
        "loop_runs",
        {
            "L": 0.001,
            "m": 10.0,
            "a": 1.0,
            "angle": 2.5,
            "speed": 0.0,
            "method": "rodas4",
            "step": 1.0,
            "records": 7,
            "span": 3.0,
        },
        "postures are looked at between steps, too: a long one leaps over a singular one",
    ),
    (
        "loop_runs",
        {
            "L": 1.0,
            "m": 1.0,
            "a": 0.5,
            "angle": 0.01,
            "speed": 10.0,
            "method": "semi_implicit_euler",
            "step": 0.001,
            "records": 7,
            "span": 1.0,
        },
        "energy is judged whatever is recorded",
    ),
    (
        "rolling_runs",
        {
            "r": 0.1,
            "m": 1.0,
            "tilt": 1.2,
            "spin": 20.0,
            "turn": 0.0,
            "method": "generalized_alpha",
            "step": 0.01,
            "span": 3.0,
        },
        "shares of modes in the norm of the kinetic energy",
    ),
    (
        "rolling_runs",
        {"r": 0.0001, "m": 1e-05, "tilt": 0.7, "spin": 5.0, "turn": 5.0, "method": "rodas4", "step": 1.0, "span": 1.0},
        "implicit methods scale their equations before pivots are judged",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "rodas4",
            "step": 1.0,
            "steps": 10,
            "mass": 100.0,
            "size": 1.0,
            "damping": 0.0,
            "scale": 1.0,
            "start": [1.0, 0.0],
            "speed": [0.0, 2.0],
        },
        "power of motions much faster than the step is judged",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "rodas4",
            "step": 1.0,
            "steps": 100,
            "mass": 1e-06,
            "size": 1.0,
            "damping": 0.0,
            "scale": 0.01,
            "start": [0.0, 1.0],
            "speed": [0.0, 0.0],
        },
        "short runs are repeated with half the step",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "dopri5",
            "step": 0.1,
            "steps": 100,
            "mass": 100.0,
            "size": 1000.0,
            "damping": 0.0,
            "scale": 1.0,
            "start": [1.0, 0.0],
            "speed": [0.0, 0.0],
        },
        "runs that amplify errors are repeated, too",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "generalized_alpha",
            "step": 0.1,
            "steps": 100,
            "mass": 1000.0,
            "size": 0.01,
            "damping": 0.0,
            "scale": 1.0,
            "start": [1.0, 0.0],
            "speed": [0.0, 0.0],
        },
        "short runs are repeated with half the step",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "rk4",
            "step": 3.0,
            "steps": 100,
            "mass": 1e-05,
            "size": 10000.0,
            "damping": 0.0,
            "scale": 0.1,
            "start": [0.0, 1.0],
            "speed": [0.0, 0.0],
        },
        "short runs are repeated with half the step",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "rodas4",
            "step": 0.1,
            "steps": 100,
            "mass": 1.0,
            "size": 1.0,
            "damping": 0.0,
            "scale": 1.0,
            "start": [1.0, 0.0],
            "speed": [0.0, 0.0],
        },
        "runs that amplify errors are repeated, too",
    ),
    (
        "step_sizes",
        {
            "mechanism": "masses",
            "method": "generalized_alpha",
            "step": 3.0,
            "steps": 10,
            "mass": 1000.0,
            "size": 100.0,
            "damping": 100.0,
            "scale": 1.0,
            "start": [1.0, 0.0],
            "speed": [1.0, 0.0],
        },
        "repetitions compare energies, too",
    ),
    (
        "step_sizes",
        {
            "mechanism": "pendulum",
            "method": "dopri5",
            "step": 0.3,
            "steps": 10,
            "mass": 0.01,
            "size": 0.01,
            "damping": 100.0,
            "scale": 0.01,
            "start": [0.0, 1.0],
            "speed": [1.0, 0.0],
        },
        "an explosion is no measure of the motion",
    ),
    (
        "beam_runs",
        {
            "rho": 1.0,
            "EI": 0.01,
            "L": 100.0,
            "step": 0.1,
            "w": 0.0001,
            "span": 2.0,
            "F": 0.0,
            "method": "dopri5",
            "P": -1.79,
        },
        "an absolute tolerance beyond the speeds is noted where it harms",
    ),
    (
        "loop_runs",
        {
            "L": 1.0,
            "m": 1.0,
            "a": 0.9999,
            "angle": 1.2,
            "speed": -3.0,
            "method": "semi_implicit_euler",
            "step": 0.1,
            "records": 7,
            "span": 1.0,
        },
        "states of the diagnosis do not depend on what is recorded",
    ),
]


@pytest.mark.parametrize(
    ("attack", "scene"), [find[:2] for find in FINDS], ids=[f"{find[0]}-{find[2]}" for find in FINDS]
)
def test_a_find_is_mended(attack: str, scene: Scene) -> None:
    verdict = ATTACKS[attack].verdict(scene)
    assert verdict.sound, verdict.said


@pytest.mark.xfail(strict=True, reason="the pivot is the wheel's: the slider's entry counts as rounding beside 1")
def test_a_rod_within_1e_8_of_a_dead_centre_has_the_force_of_its_light_slider() -> None:
    """Open: the entries of the rod's row are 5e-9 by wheel and slider, and its force is off by 0.16 %."""
    scene: Scene = {
        "mechanism": "held",
        "form": "null_space",
        "L": 1.0,
        "m1": 1.0,
        "m2": 1000.0,
        "m3": 1e-07,
        "J": 1000.0,
        "angles": [0.5, 0.5, 0.5, 1.5707963267948966, 1e-08, 0.5],
        "speed": 1.0,
    }
    verdict = ATTACKS["closed_dynamics"].verdict(scene)
    assert verdict.sound, verdict.said
