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

    That is D/(|s|^2 x^H M x) of the modes that oscillate.

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
    forces = _changes_of_forces(model, state, par, t, modes._replace(s=s, changes=changes))
    work = np.abs(s) ** 2 * (changes[:nv].conj() * (modes.M @ changes[:nv])).real.sum(axis=0)
    of = [name for name, _ in model.names.sections]
    shares: dict[str, Array] = {}
    for beam in beams:
        first = of.index(beam.name)
        inside = forces[:, first : first + of.count(beam.name)]
        mismatch = _mismatch(beam.station_law(), inside, s, changes[beam.in_v])
        shares[beam.name] = mismatch / np.where(work > 0.0, work, np.inf)
    errors[chosen] = np.sqrt(1.0 + sum(shares.values())) - 1.0
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
    others = "" if len(bad) == 1 else f", and those of {len(bad) - 1} more, too"
    return (
        f"beam '{beam}' has too few shape functions for mode {first}: its frequency of {abs(s[first]):.4g} rad/s is too"
        f" high by about {percent:.{0 if percent >= 10.0 else 1}f} %{others}; state more functions, or divide the beam"
        " into segments",
    )


def _changes_of_forces(
    model: Model, state: tuple[Array, Array, Array, Array], par: ArrayLike | None, t: float, modes: Vibrations
) -> Complex:
    """Section forces of small modes at all stations (k, stations, 6), by equilibrium."""
    (q, v, u, z), nv = state, model.nv
    rows = np.concatenate([modes.changes, modes.changes[nv : 2 * nv] * modes.s])
    both = np.concatenate([rows.real, rows.imag], axis=1).T
    moved = np.concatenate([both, -both])
    qs, vs = model.integrate(q, moved[:, :nv]), v + moved[:, nv : 2 * nv]
    given = {"par": par, "t": t} | ({"z": z + moved[:, 2 * nv : -nv]} if model.nz else {})
    us = np.zeros((len(moved), len(u))) + u
    lam = None
    if model.nc or model.nz:
        a, lam = model.forward_dynamics(qs, vs, us, multipliers=True, **given)
    else:
        a = moved[:, -nv:] + (0.0 if modes.at_rest else model.forward_dynamics(q, v, u, **given))
    forces = model.section_forces(qs, vs, a, us, lam, **given)
    real, imaginary, back, back_imaginary = forces.reshape(4, -1, *forces.shape[1:])
    return np.asarray(0.5 * (real - back) + 0.5j * (imaginary - back_imaginary))


def _mismatch(law: StationLaw, forces: Complex, s: Complex, coordinates: Complex) -> Array:
    """Integral of |M - EI kappa|^2/EI of each mode (k), over all strains with functions (34).

    Args:
        law: The beam's elastic law at its stations.
        forces: Section forces by equilibrium (k, stations, 6).
        s: Eigenvalues (k) [1/s].
        coordinates: Elastic coordinates (n, k).
    """
    by_strains = (law.by_strains @ coordinates) * (1.0 + law.damping * s)
    left = law.by_forces @ np.moveaxis(forces, 0, -1) - by_strains
    return np.asarray((left.real**2 + left.imag**2).sum(axis=(0, 1)))
