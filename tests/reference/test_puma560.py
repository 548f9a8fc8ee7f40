"""The PUMA 560 against the explicit model that was published with its parameters."""

from __future__ import annotations

import numpy as np

from tests.reference.motion import Array, reference

# Armstrong, Khatib and Burdick 1986, appendix: gravity constants [N m] and inertial constants [kg m^2], as they are
# quoted from it; the print itself was not at hand, but each follows from the parameters to the digits quoted.
G = (-37.2, -8.44, 1.02, 0.249, -0.0282)
J = {
    2: 1.75,
    4: 0.69,
    5: 0.372,
    6: 0.333,
    8: -0.134,
    9: 0.0238,
    12: -0.011,
    13: -0.00379,
    14: 0.00164,
    15: 0.00125,
    16: 0.00124,
    17: 0.000642,
    23: 0.00004,
}
MOTOR = (1.14, 4.71, 0.827, 0.2, 0.179, 0.193)
# Printed with three digits, g = 9.81 rounded somewhere: half a unit of the third digit of the largest, several summed.
PRINTED_GRAVITY = 0.05  # [N m]
# The elements below leave out constants of at most 7e-4 kg m^2, as the paper's abbreviated model does; the others are
# printed with three digits, the largest being 1.75.
PRINTED_INERTIA = 0.005  # [kg m^2]


def poses(count: int = 40) -> Array:
    return np.random.default_rng(560).uniform(-np.pi, np.pi, (count, 6))


def test_gravity_is_the_published_one() -> None:
    """Tau at rest: joint 2: g1 C2 + g2 S23 + g3 S2 + g4 C23 + g5 (S23 C5 + C23 C4 S5); joints 3 to 5 likewise."""
    puma = reference("puma560")
    for q in poses():
        c2, s2, c23, s23 = np.cos(q[1]), np.sin(q[1]), np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
        c4, s4, c5, s5 = np.cos(q[3]), np.sin(q[3]), np.cos(q[4]), np.sin(q[4])
        forearm = G[1] * s23 + G[3] * c23 + G[4] * (s23 * c5 + c23 * c4 * s5)
        expected = [
            0.0,
            G[0] * c2 + G[2] * s2 + forearm,
            forearm,
            -G[4] * s23 * s4 * s5,
            G[4] * (c23 * s5 + s23 * c4 * c5),
            0.0,
        ]
        np.testing.assert_allclose(puma.bias(q, np.zeros(6)), expected, atol=PRINTED_GRAVITY)


def test_mass_matrix_is_the_published_one() -> None:
    """The abbreviated elements of the paper's appendix, with the printed constants."""
    puma = reference("puma560")
    for q in poses():
        c2, s2, c3, s3 = np.cos(q[1]), np.sin(q[1]), np.cos(q[2]), np.sin(q[2])
        c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
        c4, c5, s5 = np.cos(q[3]), np.cos(q[4]), np.sin(q[4])
        elbow = J[5] * s3 + J[12] * c3 + J[16] * (s3 * c5 + c3 * c4 * s5)
        a33 = J[6] + 2 * J[15] * c5
        M = puma.mass_matrix(q) - np.diag(MOTOR)
        assert abs(M[0, 1] - (J[4] * s2 + J[8] * c23 + J[9] * c2 + J[13] * s23)) < PRINTED_INERTIA
        assert abs(M[0, 2] - (J[8] * c23 + J[13] * s23)) < PRINTED_INERTIA
        assert abs(M[1, 1] - (J[2] + a33 + 2 * elbow)) < PRINTED_INERTIA
        assert abs(M[1, 2] - (a33 + elbow)) < PRINTED_INERTIA
        # Not so with 0.066 for Izz3: the third element would be 0.02 too small.
        assert abs(M[2, 2] - a33) < 0.002
        np.testing.assert_allclose(M[3:, 3:].diagonal(), [J[14], J[17], J[23]], rtol=0, atol=4e-4)
