"""Found by `python -m validation adversary --attack step_sizes`: energy grew from 1.9e3 to 2.7e14 J without a note.

Claim: a run of fixed steps without a note errs by less than three tenths.
Route: the eighth-order method at 1e-10.
Then: the power of the forces was a difference over a moment in which this motion turns many times.
"""

from validation.adversary.catalogue import ATTACKS

SCENE = {
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
}


def test_step_sizes_energy_of_a_fast_motion() -> None:
    verdict = ATTACKS["step_sizes"].verdict(SCENE)
    assert verdict.sound, verdict.said
