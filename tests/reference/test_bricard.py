"""Bricard's mechanism: postures along its motion, and five conditions of rank four.

Source: IFToMM benchmark library A04. Figures: a chain by Pinocchio with multipliers of least norm, integrated with a
tolerance of 1e-12; each row is q, and the corner that the middle bars meet in.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

# Time, corner, q1 = q3 = q5, q2 = q4.
MOTION = (
    (0.0, (1.0, -1.0, 1.0), 0.0, 0.0),
    (0.5, (0.9682836791067777, -1.2246251594363335, 0.7501466094377667), 0.25252884052505253, -0.20126214560930697),
    (1.0, (0.5105014611872213, -1.6491675993948056, 0.14012311455318677), 1.0350284595180606, -0.4806211041771845),
    (1.5, (-0.517729491887155, -1.6465384128222764, 0.1444556275503487), 2.114991264555343, -0.47920581993510286),
    (2.0, (-0.9693403447776516, -1.221246894956317, 0.7542780107797769), 2.8933282059812933, -0.1985547377958622),
    (2.5, (-0.9999999998586301, -1.0000168147072075, 0.9999831851514258), 3.1415758387412183, -1.6814565840932898e-05),
    (3.0, (-0.9671998000486914, -1.2280202146742307, 0.7459831761757284), 2.8847616044588533, -0.20397399620940398),
    (3.5, (-0.5032159558227208, -1.6517631138393076, 0.1358393078799377), 2.098112566227575, -0.4820150301608999),
    (4.0, (0.5248995933913252, -1.643876001336066, 0.14883584611567358), 1.0181991818489429, -0.47776928207131175),
    (4.5, (0.9703702511016912, -1.2178857060298507, 0.758377203524086), 0.24403785148571241, -0.19585210120667332),
    (5.0, (0.9999999977380484, -1.000067257697878, 0.9999327400403237), 6.725995972710157e-05, -6.725543612969606e-05),
    (5.5, (0.9660882507600604, -1.231431773272971, 0.7417878938868931), 0.261171091166472, -0.20668996238874465),
    (6.0, (0.495873449943252, -1.6543245122736945, 0.13160520404520176), 1.051955962417925, -0.483387494839112),
    (6.5, (-0.532011330741307, -1.6411808153324166, 0.15326276569241215), 2.131770513906717, -0.476311596811135),
    (7.0, (-0.9713738492431988, -1.2145418748558603, 0.7624440171108059), 2.9017436214645373, -0.19315456546251727),
    (7.5, (-0.999999988548552, -1.0001513255791437, 0.999848662971141), 3.1414413165603565, -0.0001513141300054521),
    (8.0, (-0.9649485716701075, -1.2348595452295668, 0.7375609517777142), 2.8760436703925025, -0.20940971821593862),
    (8.5, (-0.48847443735126683, -1.656851354299623, 0.12742179487775268), 2.0811368832585386, -0.4847383967554195),
    (9.0, (0.5390642884947938, -1.638453308240376, 0.15773537835808416), 1.0014705600398264, -0.4748328719680965),
    (9.5, (0.9723515874196376, -1.2112156810412595, 0.766478286999879), 0.2356979683793275, -0.1904624613191796),
    (
        10.0,
        (0.999999963806349, -1.0002690126961582, 0.9997309511199272),
        0.00026904888331878615,
        -0.0002689765154871831,
    ),
)
# At rest in the shape of a cube.
ACCELERATION = 1.9580838323353325
SINGULAR_VALUES = (1.902113032590307, 1.9021130325903064, 1.1755705045849463, 1.1755705045849463)
SMALLEST = 1.1755705045849463


@cache
def model() -> sf.Model:
    return sf.compile(MODELS["bricard"])


def posture(odd: float, even: float) -> np.ndarray:
    return np.array([odd, even, odd, even, odd])


@pytest.mark.parametrize("row", MOTION, ids=lambda row: f"t={row[0]}")
def test_postures(row: tuple[float, tuple[float, float, float], float, float]) -> None:
    _, corner, odd, even = row
    m, q = model(), posture(odd, even)
    # The integration of the figures kept the conditions to some 1e-12.
    assert np.abs(m.constraint(q)).max() < 1e-11
    assert m.frame_pose("bar3.end", q)[0] == pytest.approx(corner, abs=1e-11)
    sizes = np.linalg.svd(m.constraint_jacobian(q), compute_uv=False)
    assert sizes[4] < 1e-11 and sizes[3] > SMALLEST - 1e-9


def test_at_rest_in_the_shape_of_a_cube() -> None:
    m, rest = model(), np.zeros(5)
    assert np.linalg.svd(m.constraint_jacobian(rest), compute_uv=False)[:4] == pytest.approx(SINGULAR_VALUES, rel=1e-12)
    a, lam, rank = m.constrained_dynamics(rest, rest, [])
    assert rank == 4
    assert a == pytest.approx(ACCELERATION * np.array([1, -1, 1, -1, 1]), rel=1e-12)
    # The whole system of equations has rank 9 of 10: a solver that needs an inverse has none.
    M, G = m.mass_matrix(rest), m.constraint_jacobian(rest)
    whole = np.block([[M, G.T], [G, np.zeros((5, 5))]])
    assert np.linalg.matrix_rank(whole, tol=1e-12) == 9 and np.linalg.cond(whole) > 1e15
    # Of all multipliers that do, ours are the shortest.
    free = np.linalg.svd(G.T)[2][4]
    assert abs(free @ lam) < 1e-10 and np.abs(G.T @ free).max() < 1e-12
    least = np.linalg.lstsq(whole, np.concatenate([-m.bias(rest, rest), np.zeros(5)]), rcond=1e-10)[0]
    assert -lam == pytest.approx(least[5:], abs=1e-10)


@pytest.mark.parametrize("row", MOTION, ids=lambda row: f"t={row[0]}")
def test_accelerations_along_the_motion(row: tuple[float, tuple[float, float, float], float, float]) -> None:
    """Four conditions and one way to move: G v' = gamma, and no work of the loop's forces, leave one v' only.

    The speed at each posture follows from energy.
    """
    _, _, odd, even = row
    m, q = model(), posture(odd, even)
    G = m.constraint_jacobian(q)
    way = np.linalg.svd(G)[2][4]
    energy = m.potential_energy(np.zeros(5)) - m.potential_energy(q)
    v = way * np.sqrt(max(2 * energy / (way @ m.mass_matrix(q) @ way), 0.0))
    a, lam, rank = m.constrained_dynamics(q, v, [])
    assert rank == 4
    assert np.abs(G @ a - m.constraint_bias(q, v)).max() < 1e-10
    # Along the one way it can move, the loop's forces do no work, whatever the multipliers.
    balance = m.mass_matrix(q) @ a + m.bias(q, v)
    assert abs(way @ balance) < 1e-10 * max(1.0, np.abs(balance).max())
    assert np.abs(balance - G.T @ lam).max() < 1e-10 * max(1.0, np.abs(balance).max())
    # By symmetry the accelerations are those of the posture.
    assert a[[0, 0, 1]] == pytest.approx(a[[2, 4, 3]], abs=1e-9)
