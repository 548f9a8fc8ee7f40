"""A spinning rod of rigid links with springs between them: a reference that shares nothing with any beam element.

Masses sit at the ends of the links; in absolute angles a of n links of length h, c_k the mass beyond joint k,

    sum_j h^2 c_max(i,j) (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) = k_i (a_(i-1) - a_i) + k_(i+1) (a_(i+1) - a_i)

with a_0 the hub's angle; springs are EI/h, that of the clamp, which has half a link beside it, 2 EI/h. The distance
from the inextensible rod falls with h^2, which two counts of links remove (Richardson). The stretch of a straight rod
that spins steadily, rhoA W^2 L^3/(3 EA), is added along the last link.
"""

from __future__ import annotations

import numpy as np

from ...adapters.exudyn.ancf import SlenderBeam
from ...mechanics.geometry import Array


def tip(rod: SlenderBeam, times: Array, links: int) -> Array:
    """Displacement of the tip (n, 2), along and across the hub's x, extrapolated from `links` and twice as many [m]."""
    coarse, fine = linked(rod, times, links), linked(rod, times, 2 * links)
    return (4.0 * fine - coarse) / 3.0


def linked(rod: SlenderBeam, times: Array, links: int) -> Array:
    """The same of one number of links, by the classical Runge-Kutta method between times that are evenly spaced."""
    h = rod.length / links
    at_node = np.full(links, rod.rhoA * h)
    at_node[-1] /= 2.0
    beyond = np.cumsum(at_node[::-1])[::-1] * h**2
    i = np.arange(links)
    mass = beyond[np.maximum(i[:, None], i[None, :])]
    springs = np.full(links + 1, rod.EI / h)
    springs[0], springs[-1] = 2.0 * rod.EI / h, 0.0
    bent = np.empty(links + 2)

    def rate(t: float, y: Array) -> Array:
        a, w = y
        apart = a[:, None] - a[None, :]
        bent[0], bent[1:-1], bent[-1] = float(rod.angle(t)), a, a[-1]
        torque = springs * np.diff(bent)
        force = torque[1:] - torque[:-1] - (mass * np.sin(apart)) @ (w * w)
        return np.array([w, np.linalg.solve(mass * np.cos(apart), force)])

    # The fastest vibration of the chain is near 4 sqrt(EI/(rhoA h^4)).
    interval = float(times[1] - times[0])
    parts = int(np.ceil(interval * 4.0 * np.sqrt(rod.EI / rod.rhoA) / h**2 / 1.5))
    dt, y, angles_of_links = interval / parts, np.zeros((2, links)), []
    for t in times[:-1]:
        angles_of_links.append(y[0])
        for part in range(parts):
            s = float(t) + part * dt
            k1 = rate(s, y)
            k2 = rate(s + dt / 2, y + dt / 2 * k1)
            k3 = rate(s + dt / 2, y + dt / 2 * k2)
            y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(s + dt, y + dt * k3))
    angles = np.array([*angles_of_links, y[0]]) - rod.angle(times)[:, None]
    spin = rod.rate / rod.duration * (times - np.sin(2 * np.pi * times / rod.duration) * rod.duration / (2 * np.pi))
    stretch = rod.rhoA * spin**2 * rod.length**3 / (3.0 * rod.EA)
    along = h * np.cos(angles).sum(axis=1) - rod.length + stretch * np.cos(angles[:, -1])
    return np.stack([along, h * np.sin(angles).sum(axis=1) + stretch * np.sin(angles[:, -1])], axis=-1)
