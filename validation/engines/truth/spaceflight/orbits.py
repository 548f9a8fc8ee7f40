"""Orbits in many digits: anomalies, elements and what they make, frames that follow them, gravity of oblate bodies.

The centre has the gravitational parameter MU. An ellipse has, by the angles v and sizes of a, for x / (1 + |x|) = s(x)

    semi-axis a = 2 + s(a0), eccentricity e = 1/2 + s(a1) / 4, inclination 5/4 + s(v0), node v1, pericentre v2,
    true anomaly tau0;  E - e sin E = M, tan(f / 2) = sqrt((1 + e) / (1 - e)) tan(E / 2)                           (8)

and a hyperbola 1 / e for e, -a for a, and e sinh H - H = N.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, arc, cos_sin, cross, exact, eye, normalised, rate, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.attitudes import about

MU = 4.0
# Unnormalised coefficients of gravity's potential, by degree and order, of a body of radius 1.
ZONAL = {2: 1.0, 3: 1.0, 4: 1.0, 5: 1.0, 6: 1.0}
# Degree, order -> cosine's and sine's normalised coefficients.
HARMONICS = {
    (2, 0): (-0.0625, 0.0),
    (2, 1): (0.03125, -0.015625),
    (2, 2): (0.0625, 0.03125),
    (3, 0): (0.015625, 0.0),
    (3, 1): (-0.03125, 0.0625),
    (3, 2): (0.015625, -0.0078125),
    (3, 3): (0.03125, 0.015625),
}
_DIGITS = Decimal("1e-60")


def _part(x: Exact) -> Exact:
    return x / (1 + abs(x))


def _eccentricity(s: Point) -> Exact:
    return Decimal("0.5") + _part(s.a[1]) / 4


def _turns(x: Exact, y: Exact) -> Exact:
    """The angle of the number of turns that y has, with the direction of x within half a turn of it."""
    return y + arc(*cos_sin(x - y))


def _halves(angle: Exact, ratio: Exact) -> Exact:
    """The angle whose half has ratio times the tangent, in the same turn (8)."""
    cosine, sine = cos_sin(angle / 2)
    return _turns(2 * arc(cosine, ratio * sine), angle)


def _true_of_eccentric(E: Exact, e: Exact) -> Exact:
    return _halves(E, root((1 + e) / (1 - e)))


def _solved(f: Callable[[Exact], tuple[Exact, Exact]], x: Exact) -> Exact:
    """A root of a function, from its value and slope, by Newton's method."""
    for _ in range(400):
        value, slope = f(x)
        x -= value / slope
        if abs(value) < _DIGITS:
            break
    return x


def _eccentric_of_mean(M: Exact, e: Exact) -> Exact:
    def off(E: Exact) -> tuple[Exact, Exact]:
        cosine, sine = cos_sin(E)
        return E - e * sine - M, 1 - e * cosine

    return _solved(off, M + e * cos_sin(M)[1])


def _hyperbolic(H: Exact) -> tuple[Exact, Exact]:
    grown = H.exp()
    return (grown + 1 / grown) / 2, (grown - 1 / grown) / 2


def _hyperbolic_of_mean(N: Exact, e: Exact) -> Exact:
    def off(H: Exact) -> tuple[Exact, Exact]:
        cosh, sinh = _hyperbolic(H)
        return e * sinh - H - N, e * cosh - 1

    return _solved(off, (abs(N) / e + 1).ln().copy_sign(N))


def anomalies(t: Truth, s: Point) -> Exact:
    """Anomalies of the angle x = tau0: f at E = x, M at E = x, E at f = x, E at M = x (4)."""
    x, e = s.tau[0], _eccentricity(s)
    mean = x - e * cos_sin(x)[1]
    return np.array([_true_of_eccentric(x, e), mean, _halves(x, root((1 - e) / (1 + e))), _eccentric_of_mean(x, e)])


def anomalies_of_a_hyperbola(t: Truth, s: Point) -> Exact:
    """Anomalies of a hyperbola at H = x = tau0: f, N; H at f = x / 2, H at N = x (4)."""
    x, e = s.tau[0], 1 / _eccentricity(s)
    (cosh, sinh), ratio = _hyperbolic(x), root((e + 1) / (e - 1))
    true = 2 * arc(1 + cosh, ratio * sinh)  # tanh(H / 2) = sinh H / (1 + cosh H).
    cosine, sine = cos_sin(x / 4)
    tangent = sine / (cosine * ratio)
    return np.array([true, e * sinh - x, ((1 + tangent) / (1 - tangent)).ln(), _hyperbolic_of_mean(x, e)])


def _elements(s: Point, is_open: bool) -> tuple[Exact, ...]:
    """Semi-axis, eccentricity, inclination, node, pericentre, true anomaly."""
    e, axis = _eccentricity(s), 2 + _part(s.a[0])
    inclination, f = Decimal("1.25") + _part(s.v[0]), s.tau[0]
    if is_open:
        return -axis, 1 / e, inclination, s.v[1], s.v[2], f / 2
    return axis, e, inclination, s.v[1], s.v[2], f


def moving(s: Point, is_open: bool) -> tuple[Exact, Exact]:
    """Position and velocity (3) each."""
    axis, e, inclination, node, pericentre, f = _elements(s, is_open)
    R = about(2, node) @ about(0, inclination) @ about(2, pericentre)
    parameter, (cosine, sine) = axis * (1 - e * e), cos_sin(f)
    distance, fast = parameter / (1 + e * cosine), root(Decimal(MU) / parameter)
    zero = Decimal(0)
    return (
        R @ np.array([distance * cosine, distance * sine, zero]),
        R @ np.array([-fast * sine, fast * (e + cosine), zero]),
    )


def position_and_velocity(is_open: bool) -> TruthOf:
    """Position and velocity of the elements (6)."""
    return lambda t, s: np.concatenate(moving(s, is_open))


def elements(is_open: bool) -> TruthOf:
    """Semi-axis, eccentricity, inclination, cosines and sines of node, pericentre and true anomaly (9)."""

    def function(t: Truth, s: Point) -> Exact:
        axis, e, inclination, *angles = _elements(s, is_open)
        return np.array([axis, e, inclination, *(x for angle in angles for x in cos_sin(angle))])

    return function


def follow(r: Exact, v: Exact) -> Exact:
    """Axes of the frame that follows an orbit, as columns: outwards, ahead, along the angular momentum (3, 3)."""
    out, up = normalised(r), normalised(cross(r, v))
    return np.stack([out, cross(up, out), up], axis=1)


def hill_frame(t: Truth, s: Point) -> Exact:
    """Rows of the axes of that frame (9)."""
    return follow(*moving(s, False)).T.reshape(9)


def hill_position(t: Truth, s: Point) -> Exact:
    """Position and velocity of a point that is v2, v away and moves by tau, seen in that frame (6)."""
    r, v = moving(s, False)
    R, spin = follow(r, v), cross(r, v) / (r @ r)
    return np.concatenate([R.T @ s.v2, R.T @ (s.tau - cross(spin, s.v2))])


def hill_back(t: Truth, s: Point) -> Exact:
    """Position and velocity of the point that is at v2 and moves by tau in that frame (6)."""
    r, v = moving(s, False)
    R, spin = follow(r, v), cross(r, v) / (r @ r)
    return np.concatenate([r + R @ s.v2, v + R @ s.tau + cross(spin, R @ s.v2)])


def equinoctial(t: Truth, s: Point) -> Exact:
    """a, e sin, e cos of node and pericentre, tan(i / 2) sin, cos of the node, both longitudes (9)."""
    axis, e, inclination, node, pericentre, f = _elements(s, False)
    half, length = cos_sin(inclination / 2), node + pericentre
    E = _halves(f, root((1 - e) / (1 + e)))
    mean = E - e * cos_sin(E)[1]
    (c, x), (d, z) = cos_sin(length), cos_sin(node)
    tangent = half[1] / half[0]
    return np.array([axis, e * x, e * c, tangent * z, tangent * d, *cos_sin(length + mean), *cos_sin(length + f)])


def place(s: Point) -> Exact:
    """Where gravity is asked for (3), outside of the body."""
    return s.v2 + exact((1.0, -1.5, 2.0))


def _legendre(n: int, x: Exact) -> Exact:
    values = [Decimal(1), x]
    for k in range(1, n):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return values[n]


def _gradient(potential: Callable[[Exact], Exact], r: Exact) -> Exact:
    return np.array([rate(potential, r, axis) for axis in eye(3)])


def zonal(n: int) -> TruthOf:
    """The pull of the zonal harmonic of degree n for unit coefficient, parameter and radius (3)."""

    def potential(r: Exact) -> Exact:
        distance = root(r @ r)
        return -_legendre(n, r[2] / distance) / distance ** (n + 1)

    return lambda t, s: _gradient(potential, place(s))


def _factorial(n: int) -> int:
    return 1 if n < 2 else n * _factorial(n - 1)


def _harmonic(n: int, m: int, r: Exact) -> tuple[Exact, Exact]:
    """Cosine's and sine's normalised solid harmonics of a position: P_nm(z / r) (cos, sin)(m longitude) / r^(n + 1).

    With z = r u, x + i y = r sqrt(1 - u^2) exp(i longitude) and P_nm = (1 - u^2)^(m / 2) d^m P_n / du^m.
    """
    distance = root(r @ r)
    u = r[2] / distance
    real, imaginary = Decimal(1), Decimal(0)
    for _ in range(m):
        real, imaginary = (
            (real * r[0] - imaginary * r[1]) / distance,
            (real * r[1] + imaginary * r[0]) / distance,
        )
    # Coefficients of P_n, differentiated m times.
    polynomial = [
        Decimal((-1) ** k * _factorial(2 * n - 2 * k))
        / (2**n * _factorial(k) * _factorial(n - k) * _factorial(n - 2 * k))
        for k in range(n // 2 + 1)
    ]
    total = Decimal(0)
    for k, coefficient in enumerate(polynomial):
        power = n - 2 * k
        if power >= m:
            total += coefficient * Decimal(_factorial(power)) / _factorial(power - m) * u ** (power - m)
    scale = root(Decimal((2 - (m == 0)) * (2 * n + 1) * _factorial(n - m)) / _factorial(n + m))
    return scale * total * real / distance ** (n + 1), scale * total * imaginary / distance ** (n + 1)


def harmonics(t: Truth, s: Point) -> Exact:
    """The pull of a body of MU with HARMONICS (3)."""

    def potential(r: Exact) -> Exact:
        total = Decimal(0)
        for (n, m), (c, x) in HARMONICS.items():
            cosine, sine = _harmonic(n, m, r)
            total += Decimal(MU) * (Decimal(c) * cosine + Decimal(x) * sine)
        return total

    return _gradient(potential, place(s)) + point_mass(t, s)


def point_mass(t: Truth, s: Point) -> Exact:
    """The pull of a point mass of MU (3)."""
    r = place(s)
    return -Decimal(MU) * r / root(r @ r) ** 3


ORBITS: dict[str, tuple[str, TruthOf]] = {
    "orbit_anomalies": ("f at E = x, M at E = x, E at f = x, E at M = x, x = tau[0] (4)", anomalies),
    "orbit_anomalies_open": ("f, N at H = x, H at f = x / 2, at N = x, x = tau[0] (4)", anomalies_of_a_hyperbola),
    "orbit_state": ("position and velocity of elements (6)", position_and_velocity(False)),
    "orbit_state_open": ("the same of a hyperbola (6)", position_and_velocity(True)),
    "orbit_elements": ("a, e, i, cosines and sines of node, pericentre, true anomaly (9)", elements(False)),
    "orbit_elements_open": ("the same of a hyperbola (9)", elements(True)),
    "orbit_frame": ("rows of the axes outwards, ahead, across (9)", hill_frame),
    "orbit_frame_position": ("position and velocity seen from that frame (6)", hill_position),
    "orbit_frame_back": ("position and velocity of a point that is given in that frame (6)", hill_back),
    "orbit_equinoctial": ("equinoctial elements (9)", equinoctial),
    "gravity_point_mass": ("pull of a point mass (3)", point_mass),
    "gravity_harmonics": ("pull of harmonics of degrees 2 and 3 (3)", harmonics),
}
ORBITS |= {f"gravity_zonal_{n}": (f"pull of the zonal harmonic of degree {n} (3)", zonal(n)) for n in ZONAL}
