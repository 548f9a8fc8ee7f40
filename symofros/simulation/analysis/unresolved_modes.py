"""How far frequencies are too high, as a beam's shape functions are too few (docs/theory/beams.md, section 10)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.beams import ElasticBeam, StationLaw
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.rigid_motions import Complex

# Error of a frequency from which a note says so.
_NOTED = 0.05
# Largest change of an angle, or of a displacement in lengths, by which section forces are differentiated.
_STEP = 1e-4
# Functions that the estimate takes.
_FUNCTIONS = "section_forces", "mass_matrix", "forward_dynamics"


class Vibrations(NamedTuple):
    """Modes as they come from the linear model.

    Attributes:
        s: Eigenvalues (k) [1/s].
        changes: Along q, of v and of states of forces (2 nv + nz, k).
        M: Mass matrix at the state (nv, nv).
        at_rest: Whether the state is an equilibrium, so that accelerations are those of the mode alone.
    """

    s: Complex
    changes: Complex
    M: Array
    at_rest: bool


def judged_beams(model: Model, par: ArrayLike | None) -> Sequence[ElasticBeam]:
    """Beams of which there is an estimate: those with stations, of models with the functions that it takes."""
    with_stations = {name for name, _ in model.names.sections}
    return [beam for beam in model.beams(par) if beam.name in with_stations and not _missing(model)]


def _missing(model: Model) -> list[str]:
    return [name for name in _FUNCTIONS if not model.has(name)]


def unjudged_notes(model: Model, par: ArrayLike | None, judged: Sequence[ElasticBeam]) -> tuple[str, ...]:
    """A note on the beams of which there is no estimate."""
    known, missing = {beam.name for beam in judged}, _missing(model)
    others = [f"'{beam.name}'" for beam in model.beams(par) if beam.name not in known]
    if not others:
        return ()
    reason = f"the model was compiled without {' and '.join(missing)}" if missing else "stations are stated as none"
    return (
        f"how far too few shape functions of beam {' and '.join(others)} raise frequencies is not estimated: {reason}",
    )


def too_high(
    model: Model,
    state: tuple[Array, Array, Array, Array],
    par: ArrayLike | None,
    t: float,
    modes: Vibrations,
    beams: Sequence[ElasticBeam],
) -> tuple[Array, Mapping[str, Array]]:
    """Estimated error of each frequency by too few functions (36), relative (k), and the part of each beam in it.

    That is D/(|s|^2 x^H M x) of the modes that oscillate. The error is infinite where more functions may leave no
    stiffness: near the critical load.

    Args:
        model: Model in double precision.
        state: Configuration (nq), speeds (nv), inputs (nu) and states of forces (nz).
        par: Run-time parameters.
        t: Time [s].
        modes: Modes about the state.
        beams: Those to be judged (`judged_beams`).
    """
    errors = np.full(len(modes.s), np.nan)
    chosen = np.flatnonzero(modes.s.imag > 0.0)
    s, changes, nv = modes.s[chosen], modes.changes[:, chosen], model.nv
    if not len(chosen):
        return errors, {}
    # Coordinates are angles, or displacements that the shortest beam makes large.
    largest = np.abs(changes[:nv]).max(axis=0)
    step = _STEP * min(1.0, *(beam.length for beam in beams))
    changes = changes * (step / np.where(largest > 0.0, largest, 1.0))
    forces, at_state = _forces_inside(model, state, par, t, modes._replace(s=s, changes=changes))
    work = np.abs(s) ** 2 * (changes[:nv].conj() * (modes.M @ changes[:nv])).real.sum(axis=0)
    of = [name for name, _ in model.names.sections]
    shares, released = dict[str, Array](), np.zeros(len(s))
    for beam in beams:
        stations = slice(of.index(beam.name), of.index(beam.name) + of.count(beam.name))
        inside, N = forces[:, stations], at_state[stations, 0]
        mismatch, compressed = _mismatch(beam.station_law(), inside, N, s, changes[beam.in_v])
        shares[beam.name] = mismatch / np.where(work > 0.0, work, np.inf)
        released += compressed / np.where(work > 0.0, work, np.inf)
    missing, whole = np.asarray(sum(shares.values())), 1.0 + released
    left = 1.0 - missing * whole / (whole + missing)
    errors[chosen] = np.where(left > 0.0, 1.0 / np.sqrt(np.where(left > 0.0, left, 1.0)), np.inf) - 1.0
    return errors, shares


def resolution_notes(s: Complex, errors: Array, shares: Mapping[str, Array]) -> tuple[str, ...]:
    """A note on the first mode whose frequency is too high by more than a few per cent; arguments as by `too_high`."""
    bad = np.flatnonzero(errors > _NOTED)
    if not len(bad):
        return ()
    first = int(bad[0])
    judged = np.count_nonzero(s[:first].imag > 0.0)
    beam = max(shares, key=lambda name: float(shares[name][judged]))
    percent = 100.0 * errors[first]
    size = (
        f" by about {percent:.{0 if percent >= 10.0 else 1}f} %" if np.isfinite(percent) else ", if it has one at all"
    )
    others = "" if len(bad) == 1 else f", and those of {len(bad) - 1} more, too"
    return (
        f"beam '{beam}' has too few shape functions for mode {first}: its frequency of {abs(s[first]):.4g} rad/s is too"
        f" high{size}{others}; state more functions, or divide the beam"
        " into segments",
    )


def _forces_inside(
    model: Model, state: tuple[Array, Array, Array, Array], par: ArrayLike | None, t: float, modes: Vibrations
) -> tuple[Complex, Array]:
    """Section forces at all stations by equilibrium: of small modes (k, stations, 6), of the state (stations, 6)."""
    (q, v, u, z), nv = state, model.nv
    rows = np.concatenate([modes.changes, modes.changes[nv : 2 * nv] * modes.s])
    both = np.concatenate([rows.real, rows.imag], axis=1).T
    moved = np.concatenate([both, -both, np.zeros_like(both[:1])])
    qs, vs = model.integrate(q, moved[:, :nv]), v + moved[:, nv : 2 * nv]
    given = {"par": par, "t": t} | ({"z": z + moved[:, 2 * nv : -nv]} if model.nz else {})
    us = np.zeros((len(moved), len(u))) + u
    lam = None
    if model.nc or model.nz:
        a, lam = model.forward_dynamics(qs, vs, us, multipliers=True, **given)
    else:
        a = moved[:, -nv:] + (0.0 if modes.at_rest else model.forward_dynamics(q, v, u, **given))
    forces = model.section_forces(qs, vs, a, us, lam, **given)
    real, imaginary, back, back_imaginary = forces[:-1].reshape(4, -1, *forces.shape[1:])
    return np.asarray(0.5 * (real - back) + 0.5j * (imaginary - back_imaginary)), np.asarray(forces[-1])


def _mismatch(law: StationLaw, forces: Complex, N: Array, s: Complex, coordinates: Complex) -> tuple[Array, Array]:
    """D of each mode (34b), over all strains with functions, and what compression takes of its energy (k each).

    Args:
        law: The beam's elastic law at its stations.
        forces: Section forces by equilibrium (k, stations, 6).
        N: Axial force of the state (stations).
        s: Eigenvalues (k) [1/s].
        coordinates: Elastic coordinates (n, k).
    """
    strains = law.by_strains @ coordinates
    left = law.by_forces @ np.moveaxis(forces, 0, -1) - strains * (1.0 + law.damping * s)
    flat = left.reshape(-1, len(s))
    slopes = law.slopes.reshape(-1, len(flat))
    pull = np.repeat(np.maximum(N, 0.0), len(slopes) // len(N))
    stretched = np.eye(len(flat)) + slopes.T @ (pull[:, np.newaxis] * slopes)
    mismatch = (flat.conj() * np.linalg.solve(stretched, flat)).real.sum(axis=0)
    turned = np.abs(slopes @ strains.reshape(flat.shape)) ** 2
    push = np.repeat(np.maximum(-N, 0.0), len(slopes) // len(N))
    return mismatch, push @ turned
