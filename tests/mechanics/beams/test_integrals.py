"""Modal integrals: exact where the section is uniform, by quadrature where it is not, against scipy's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.expr.expression import Expression, lower
from symofros.expr.graph import Graph
from symofros.generator.passes.count import count_program
from symofros.mechanics.beams.fields import Field
from symofros.mechanics.beams.second_order.forms import BeamForms
from symofros.mechanics.beams.second_order.theory import SecondOrderTheory

L = 1.7
STATE = np.array([0.11, -0.07, 0.05, 0.13, 0.21, -0.17])
# Coefficients and quadrature are of size one; scipy's quad is asked for this.
TOLERANCE = 1e-12


def at(field: Field, x: float) -> float:
    terms = ((mono, float(f(x / L))) for mono, f in field.terms.items())
    return sum(value * L ** field.exponent(mono) * float(np.prod(STATE[list(mono)])) for mono, value in terms)


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
