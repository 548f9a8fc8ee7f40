"""Found by `python -m validation adversary --attack step_sizes`: a run that exploded was "finished" without a note.

Claim: a run of fixed steps without a note errs by less than three tenths.
Route: the eighth-order method at 1e-10.
Then: speeds of 1e119, since the explosion itself was the measure of the motion that modes have a share in.
"""

from validation.adversary.catalogue import ATTACKS

SCENE = {
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
}


def test_step_sizes_explosion() -> None:
    verdict = ATTACKS["step_sizes"].verdict(SCENE)
    assert verdict.sound, verdict.said
