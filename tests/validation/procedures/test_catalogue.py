"""Procedures agree with formulas of their own, and a wrong one on either side shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.functions import FUNCTIONS
from validation.comparison.units import Rescaled, Units
from validation.mechanics.assembly import assemble
from validation.procedures import catalogue
from validation.procedures.catalogue import PROCEDURES, first_scene, judge_procedures
from validation.procedures.equations import analyses, identities, reactions
from validation.procedures.formats import differences, files
from validation.procedures.motions import batches, runs, steps, switching, zeros
from validation.procedures.scene import Cell, Manifold, Scene


def scene(name: str) -> Scene:
    return first_scene(MODELS[name], assemble(MODELS[name]))


def wrong(cells: Iterator[Cell]) -> list[str]:
    return [cell.name for cell in cells if not cell.error <= cell.tolerance]


# Every procedure of every model that the check asks.
ASKED = [(name, k) for name, procedures in PROCEDURES.items() for k in range(len(procedures))]


@pytest.mark.parametrize(("name", "k"), ASKED)
def test_procedures_agree(name: str, k: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a procedure is asked of is in no other test again: a property is stated in one place."""
    monkeypatch.setattr(catalogue, "PROCEDURES", {name: PROCEDURES[name][k : k + 1]})
    rows = list(judge_procedures(name, MODELS[name], assemble(MODELS[name])))
    wrong = [row for row in rows if not row.ok and row.status != "unsupported"]
    assert rows and not wrong, wrong


def test_every_label_is_a_reference_model() -> None:
    assert set(PROCEDURES) <= set(MODELS)


@pytest.mark.slow
def test_a_wrong_coefficient_of_a_method_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """On the side of the formulas, which stands for one in C."""
    rk4 = steps.EXPLICIT["rk4"]
    monkeypatch.setitem(steps.STEPS, "rk4", replace(rk4, b=rk4.b + [1e-6, -1e-6, 0, 0]).step)
    assert wrong(runs.fixed_steps(scene("heavy_top"))) == ["steps by rk4"]


def test_a_wrong_sign_of_the_gyroscopic_terms_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    top = scene("heavy_top")
    linearize = type(top.model).linearize

    def turned(model: sf.Model, *given: np.ndarray, **stated: object) -> object:
        A, *rest = linearize(model, *given, **stated)  # type: ignore[call-overload]
        A[: model.nv, : model.nv] *= -1.0
        return (A, *rest) if "outputs" not in stated else linearize(model, *given, **stated)  # type: ignore[call-overload]

    monkeypatch.setattr(type(top.model), "linearize", turned)
    assert wrong(analyses.linearised(top)) == ["A of the kinematics"]


def test_a_mechanism_with_switches_is_asked_for_derivatives_and_in_other_units() -> None:
    """By parameters that have values near their own; switches are numbers in other units, which know no parameters."""
    system = MODELS["docking"]
    model = sf.compile(system, sf.Options(backend="interpreter"))
    q, v = model.random_state(np.random.default_rng(2))
    one = Scene(model, system, Manifold.of(assemble(system)), q, v, lambda *_: np.array([0.4]))
    assert not wrong(analyses.differentiated(one))
    (rope,) = (item for item in system.constraints if item.name == "rope")
    roped = replace(system, constraints=(rope,), switches=system.switches[-1:])
    assert [switch.engaged for switch in Rescaled(roped, Units(length=2.0)).system().switches] == [0.0]


def test_a_trajectory_of_a_batch_that_takes_other_inputs_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate: Callable[..., sf.Trajectory] = sf.simulate
    monkeypatch.setattr(sf, "simulate", lambda *given, **stated: simulate(*given, **{**stated, "u": None}))
    assert "a batch by rk4" in wrong(batches.trajectories(scene("double_pendulum")))


def test_every_function_with_vector_jacobian_products_is_asked_for() -> None:
    assert set(identities.TRANSPOSED) == {row.transposes for row in FUNCTIONS.values() if row.transposes}
    for name, (inputs, outputs) in identities.TRANSPOSED.items():
        assert tuple(inputs.split()) == tuple(group for group in FUNCTIONS[name].inputs if group not in ("t", "gains"))
        assert tuple(outputs.split()) == tuple(output.name for output in FUNCTIONS[name].cotangents.values())


def test_wrong_signs_in_momenta_and_second_derivatives_show(monkeypatch: pytest.MonkeyPatch) -> None:
    body, top, kind = scene("torque_free_body"), scene("heavy_top"), sf.Model
    coriolis, product = kind.coriolis_matrix, kind.inverse_dynamics_hvp
    monkeypatch.setattr(kind, "coriolis_matrix", lambda model, q, v: coriolis(model, q, v).T)
    monkeypatch.setattr(kind, "inverse_dynamics_hvp", lambda model, *given: product(model, *given)[::-1])
    assert wrong(identities.momenta(body)) == ["C v and the weight"]
    assert wrong(identities.twice_differentiated(top)) == ["Hessian-vector products"]


def test_vector_jacobian_products_of_a_beam_that_leave_a_coordinate_out_show(monkeypatch: pytest.MonkeyPatch) -> None:
    bent, vjp = scene("flexible_pendulum"), sf.Model.vjp
    assert not wrong(identities.transposed(bent))

    def shortened(model: sf.Model, *given: object, **stated: object) -> dict[str, np.ndarray]:
        products = vjp(model, *given, **stated)  # type: ignore[arg-type]
        products["q"][-1] = 0.0
        return products

    monkeypatch.setattr(sf.Model, "vjp", shortened)
    assert {"mass_matrix: vector-Jacobian products", "potential_energy: vector-Jacobian products"} <= set(
        wrong(identities.transposed(bent))
    )


def test_an_exception_in_a_procedure_is_a_failed_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: Scene) -> Iterator[Cell]:
        yield Cell("before", 0.0, 1.0)
        raise sf.SymofrosError(sf.Problem("a", "b", "c", "d"))

    monkeypatch.setattr(catalogue, "PROCEDURES", {"heavy_top": (refused,)})
    rows = list(judge_procedures("heavy_top", MODELS["heavy_top"], assemble(MODELS["heavy_top"])))
    assert [row.status for row in rows] == ["agree", "failed"]


def test_reactions_that_are_wrong_by_a_millionth_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing in check asked for wrenches of constraints or efforts of drives."""
    four_bar = scene("four_bar")
    assert not wrong(reactions.of_constraints(four_bar)) and not wrong(reactions.of_drives(four_bar))
    for name in ("closure_wrench", "prescribed_efforts"):
        right = getattr(sf.Model, name)
        monkeypatch.setattr(sf.Model, name, lambda *given, right=right, **more: (1 + 1e-6) * right(*given, **more))
    assert wrong(reactions.of_constraints(four_bar)) == ["wrenches of constraints"]
    assert wrong(reactions.of_drives(four_bar)) == ["power of drives"]


def test_a_conditions_share_that_is_dropped_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what is released: in the rows of a switched closure."""
    kind, jacobian = sf.Model, sf.Model.constraint_jacobian
    monkeypatch.setattr(kind, "constraint_jacobian", lambda model, q, **given: jacobian(model, q, **given) + 1e-6)
    assert wrong(switching.engaged(scene("pendulum"))) == ["switched constraint jacobian"]


def test_a_difference_without_its_entry_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where `diff` calls everything the same, each planted difference does."""
    monkeypatch.setattr(sf, "diff", lambda one, other, diff=sf.diff: diff(one, one))
    found = wrong(differences.first_differences(scene("pendulum")))
    assert {f"diff of {what}" for what in differences.CHANGED} <= {*found}


def test_a_reader_that_halves_damping_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    def halved(path: Path, **options: Any) -> sf.System:
        system = load(path, **options)
        bodies: list[Any] = []
        for body in system.bodies:
            joint: Any = body.joint
            if joint is not None:
                dampers = [isinstance(one, sf.Damper) for one in joint.elements]
                halves = [
                    replace(x, coefficient=0.5 * cast(float, x.coefficient))
                    for x in joint.elements
                    if isinstance(x, sf.Damper)
                ]
                elements = [halves.pop(0) if damps else x for damps, x in zip(dampers, joint.elements, strict=True)]
                body = replace(cast(Any, body), joint=replace(joint, elements=tuple(elements)))
            bodies.append(body)
        return replace(system, bodies=tuple(bodies))

    load: Callable[..., sf.System] = sf.load
    monkeypatch.setattr(sf, "load", halved)
    names = wrong(files.read(scene("pendulum")))
    assert [name.removeprefix("an arm read from ") for name in names] == [
        "URDF, losses and mimicry",
        "URDF, stops",
        "MJCF, losses",
        "MJCF, viscous",
    ]


def test_an_event_that_is_lost_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    simulate: Callable[..., sf.Trajectory] = sf.simulate

    def lossy(*given: Any, **stated: Any) -> sf.Trajectory:
        run = simulate(*given, **stated)
        return replace(run, events=run.events[1:])

    monkeypatch.setattr(sf, "simulate", lossy)
    assert len(wrong(zeros.of_time(scene("pendulum")))) >= 7
