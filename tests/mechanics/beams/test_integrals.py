"""Modal integrals: exact where the section is uniform, by quadrature where it is not, against scipy's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import scipy.integrate

import symofros as sf
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import Expression, lower
from symofros.expr.graph import Graph
from symofros.generator.passes.count import count_program
from symofros.mechanics.beams.fields import Field, Form
from symofros.mechanics.beams.second_order.forms import BeamForms
from symofros.mechanics.beams.second_order.theory import SecondOrderTheory
from symofros.mechanics.spatial.inertia import PAIRS

L = 1.7
STATE = np.array([0.11, -0.07, 0.05, 0.13, 0.21, -0.17])
COUNTS: dict[str, Any] = {"bend_y": 2, "bend_z": 2, "twist": 2, "retain": "all"}
UNIFORM = {"rhoA": 2.0, "EI_z": 3.0, "EI_y": 5.0, "GJ": 1.5, "rhoJ": 0.04, "rhoI_y": 0.03, "rhoI_z": 0.02}
TAPERED = {
    "rhoA": "2*(1 - 0.4*x/L)",
    "EI_z": "3*(1 - x/(2*L))^3",
    "EI_y": "5*exp(-x)",
    "GJ": "1.5 + sin(x)",
    "rhoJ": "0.04/(1 + x)",
    "rhoI_y": "0.03",
    "rhoI_z": "0.02 + 0.01*x^2",
}
SECTIONS: dict[str, dict[str, Callable[[float], float]]] = {
    "uniform": {key: lambda x, value=value: value for key, value in UNIFORM.items()},  # type: ignore[misc]
    "tapered": {
        "rhoA": lambda x: 2 * (1 - 0.4 * x / L),
        "EI_z": lambda x: 3 * (1 - x / (2 * L)) ** 3,
        "EI_y": lambda x: 5 * np.exp(-x),
        "GJ": lambda x: 1.5 + np.sin(x),
        "rhoJ": lambda x: 0.04 / (1 + x),
        "rhoI_y": lambda x: 0.03,
        "rhoI_z": lambda x: 0.02 + 0.01 * x**2,
    },
}
# Coefficients and quadrature are of size one; scipy's quad is asked for this.
TOLERANCE = 1e-12


def forms(section: str, family: str = "spline", **more: Any) -> BeamForms:
    """A beam's forms, all of whose edges are numbers."""
    g = Graph()
    stated = UNIFORM if section == "uniform" else TAPERED
    beam = sf.Beam("b", sf.Joint("j"), "L", family=family, **COUNTS, **stated, **more)  # type: ignore[arg-type]

    def lowered(value: Value) -> Edge:
        return lower(value, g, {"L": g.constant(L)}) if isinstance(value, Expression) else g.constant(value)

    return SecondOrderTheory(beam).equations(g, lowered, tuple(g.constant(x) for x in STATE))


def number(form: Form, upto: float = np.inf) -> float:
    found = form.g.number(form.value(upto))
    assert found is not None
    return found


def at(field: Field, x: float) -> float:
    terms = ((mono, float(f(x / L))) for mono, f in field.terms.items())
    return sum(value * L ** field.exponent(mono) * float(np.prod(STATE[list(mono)])) for mono, value in terms)


def quad(beam: BeamForms, integrand: Callable[[float], float]) -> float:
    """Over the length, interval by interval between knots."""
    ends = [float(k) * L for k in beam.along.knots]
    return sum(
        scipy.integrate.quad(integrand, a, b, epsabs=TOLERANCE, epsrel=TOLERANCE)[0]
        for a, b in zip(ends, ends[1:], strict=False)
    )


@pytest.mark.parametrize("family", ["spline", "clamped_free"])
@pytest.mark.parametrize("section", SECTIONS)
def test_mass_and_its_moments(section: str, family: str) -> None:
    beam, known = forms(section, family), SECTIONS[section]
    r, rhoA = beam.shape.position, known["rhoA"]
    mass = beam.along.g.number(beam.mass)
    assert mass == pytest.approx(quad(beam, rhoA), rel=TOLERANCE)
    for form, field in zip(beam.first_moment, r, strict=True):
        assert number(form) == pytest.approx(quad(beam, lambda x, f=field: rhoA(x) * at(f, x)), rel=TOLERANCE)
    # Without rotary inertia the sections' polar moment counts about x alone: half its trace on each diagonal entry.
    polar = 0.5 * quad(beam, known["rhoJ"])
    for form, (a, b) in zip(beam.second_moment, PAIRS, strict=True):
        expected = quad(beam, lambda x, a=a, b=b: rhoA(x) * at(r[a], x) * at(r[b], x))
        section_part = 0.0 if a != b else -polar if a == 0 else polar
        assert number(form) == pytest.approx(expected + section_part, rel=TOLERANCE)


@pytest.mark.parametrize("rotary", [False, True])
@pytest.mark.parametrize("section", SECTIONS)
def test_modal_mass(section: str, rotary: bool) -> None:
    beam, known = forms(section, rotary_inertia=rotary), SECTIONS[section]
    r, spins = beam.shape.position, beam.shape.partial_spins
    for (i, j), form in beam.modal_masses.items():

        def integrand(x: float, i: int = i, j: int = j) -> float:
            total = known["rhoA"](x) * sum(at(f.by(i), x) * at(f.by(j), x) for f in r)
            if not rotary:
                roll = beam.shape.roll
                return total + known["rhoJ"](x) * at(roll.by(i), x) * at(roll.by(j), x)
            inertias = (known[key](x) for key in ("rhoJ", "rhoI_y", "rhoI_z"))
            return total + sum(J * at(a, x) * at(b, x) for J, a, b in zip(inertias, spins[i], spins[j], strict=True))

        assert number(form) == pytest.approx(quad(beam, integrand), rel=TOLERANCE, abs=1e-14)


@pytest.mark.parametrize("section", SECTIONS)
def test_strain_energy_keeps_third_degree_and_no_more(section: str) -> None:
    beam, known = forms(section), SECTIONS[section]
    P, T, F = beam.shape.yaw, beam.shape.pitch, beam.shape.roll
    dP, dT, dF = P.along(), T.along(), F.along()

    def energy(x: float) -> float:
        p, t, f, t0, f0 = at(dP, x), at(dT, x), at(dF, x), at(T, x), at(F, x)
        GJ, EI_y, EI_z = (known[key](x) for key in ("GJ", "EI_y", "EI_z"))
        return (
            0.5 * GJ * (f**2 - 2 * f * t0 * p)
            + 0.5 * EI_y * (t**2 + 2 * t * f0 * p)
            + 0.5 * EI_z * (p**2 - 2 * p * f0 * t)
        )

    assert number(beam.strain_energy) == pytest.approx(quad(beam, energy), rel=TOLERANCE)
    assert max(map(len, beam.strain_energy.terms)) == 3


def test_uniform_integrals_are_rounded_once() -> None:
    """Rational arithmetic inside: the modal mass of xi^2 and xi^3 is rhoA L/5, rhoA L/6, rhoA L/7 to the last bit."""
    g = Graph()
    given: dict[str, Any] = {"rhoA": 1.0, "EI_z": 1.0, "bend_y": 2, "family": "polynomial", "retain": "zeroth_order"}
    beam = sf.Beam("b", sf.Joint("j"), 1.0, **given)
    edges = g.input("q", 0), g.input("q", 1)
    made = SecondOrderTheory(beam).equations(g, lambda value: g.constant(float(value)), edges)  # type: ignore[arg-type]
    found = {pair: g.number(form.value(0)) for pair, form in made.modal_masses.items()}
    assert found == {(0, 0): 1 / 5, (0, 1): 1 / 6, (1, 1): 1 / 7}
    stiffness = {mono: g.number(edge) for mono, edge in made.strain_energy.terms.items()}
    assert stiffness == {(0, 0): 2.0, (0, 1): 6.0, (1, 1): 6.0}


@pytest.mark.parametrize("count", [3, 8])
def test_quadrature_follows_polynomials_of_any_degree(count: int) -> None:
    """A section whose formula says "uniform" in a roundabout way has the exact integrals of one that is.

    Eight Legendre functions make polynomials of degree 34, whose coefficients reach 1e23 and cancel.
    """

    def beam(rhoA: Any) -> BeamForms:
        g = Graph()
        given: dict[str, Any] = {"EI_z": 3.0, "bend_y": count, "family": "legendre", "retain": "all"}
        stated = sf.Beam("b", sf.Joint("j"), L, rhoA, **given)
        edges = tuple(g.input("q", k) for k in range(count))
        return SecondOrderTheory(stated).equations(
            g, lambda x: lower(x, g, {}) if isinstance(x, Expression) else g.constant(x), edges
        )

    uniform, roundabout = beam(2.0), beam("2*cos(x)^2 + 2*sin(x)^2")
    for exact, form in zip(uniform.second_moment, roundabout.second_moment, strict=True):
        # Orthogonal functions leave zeros, which the exact form has no terms for.
        known, found = (
            np.array([float(side.g.number(side.terms[mono])) if mono in side.terms else 0.0 for mono in form.terms])  # type: ignore[arg-type]
            for side in (exact, form)
        )
        np.testing.assert_allclose(found, known, rtol=0, atol=TOLERANCE * np.abs(known).max(initial=1.0))


def test_tapered_formulas_enter_as_parameters() -> None:
    """Integrals of a section that changes depend on parameters only: they cost nothing at run time."""
    stated = sf.System(
        "s",
        [sf.Beam("b", sf.Joint("h", "revolute"), "L", "rho*(1 - x/(2*L))", EI_z="EI*(1 - x/(2*L))^3", bend_y=2)],
        [sf.Parameter("L", L), sf.Parameter("rho", 2.0), sf.Parameter("EI", 3.0)],
    )
    uniform = sf.System(
        "s", [sf.Beam("b", sf.Joint("h", "revolute"), "L", "rho", EI_z="EI", bend_y=2)], stated.parameters
    )
    counts = [count_program(sf.program_of(s, ["mass_matrix", "bias"])) for s in (stated, uniform)]
    for name in ("mass_matrix", "bias"):
        assert counts[0][name, ""] == counts[1][name, ""]
