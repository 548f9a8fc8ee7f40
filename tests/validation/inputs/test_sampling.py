import numpy as np

from tests.validation.subjects import every_kind
from validation.inputs.sampling import FAST, SPEED, neutral, sample
from validation.mechanics.assembly import assemble

ASSEMBLY = assemble(every_kind().system)


def test_the_same_seed_gives_the_same_states() -> None:
    a, b, c = sample(ASSEMBLY, 2, 20, 1), sample(ASSEMBLY, 2, 20, 1), sample(ASSEMBLY, 2, 20, 2)
    assert np.array_equal(a.q, b.q) and np.array_equal(a.u, b.u)
    assert not np.allclose(a.q[10:], c.q[10:])


def test_states_lie_on_the_manifold() -> None:
    states = sample(ASSEMBLY, 3, 200)
    assert states.q.shape == (200, ASSEMBLY.nq) and states.v.shape == (200, ASSEMBLY.nv) and states.u.shape == (200, 3)
    for mover in ASSEMBLY.movers:
        if mover.kind in ("ball", "free"):
            norms = np.linalg.norm(states.q[:, mover.q.stop - 4 : mover.q.stop], axis=1)
            assert np.abs(norms - 1).max() < 1e-15 * 4


def test_special_states_come_first() -> None:
    states = sample(ASSEMBLY, 0, 50)
    assert np.array_equal(states.q[0], neutral(ASSEMBLY)) and not states.v[0].any()
    assert np.array_equal(states.q[1], neutral(ASSEMBLY)) and states.v[1].any()
    assert not states.v[2].any()
    revolute = [m.q.start for m in ASSEMBLY.movers if m.kind == "revolute"]
    assert np.abs(states.q[3, revolute]).max() > np.pi
    ball = next(m for m in ASSEMBLY.movers if m.kind == "ball")
    assert states.q[4, ball.q].tolist() == [0.6, 0.0, 0.8, 0.0]
    assert SPEED < np.abs(states.v[6]).max() <= FAST


def test_a_later_part_has_states_of_its_own_and_no_special_ones() -> None:
    whole, part, again = sample(ASSEMBLY, 0, 20), sample(ASSEMBLY, 0, 20, first=20), sample(ASSEMBLY, 0, 20, first=20)
    assert np.array_equal(part.q, again.q) and np.array_equal(part.v, again.v)
    assert not np.isclose(part.v, whole.v).any() and (part.v != 0.0).all()
    assert not np.isclose(part.v, sample(ASSEMBLY, 0, 20, first=40).v).any()
