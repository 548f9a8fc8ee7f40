"""Tapes: the bits of the graph in single states and in batches of any length, routines and runs included."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS, load_model
from symofros.compiler import Compilation
from symofros.generator.codegen.tape import machine_text, tape_functions
from symofros.runtime.calls.tape import TapeUnit, tape_machine
from tests.generator.codegen.test_c_equals_interpreter import EXACT_FLAGS, SMALL, built, everything
from tests.generator.codegen.test_source import OPERATIONS
from tests.models import CASES, sampled, system

C, TAPE = sf.Options(flags=EXACT_FLAGS), sf.Options(backend="tape")
WIDTH = 16  # SYM_TAPE_WIDTH


@pytest.mark.parametrize("case", sampled(CASES, SMALL))
def test_tapes_have_the_bits_of_the_interpreter(case: str) -> None:
    models = built(case, backend="tape"), built(case, backend="interpreter")
    on_tape, twin = (everything(model, np.random.default_rng(1), 3 * WIDTH + 2) for model in models)
    for name, values in on_tape.items():
        np.testing.assert_array_equal(values, twin[name], err_msg=name)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, WIDTH - 1, WIDTH, WIDTH + 1, 3 * WIDTH + 5])
def test_a_batch_of_any_length_has_the_bits_of_single_states(n: int, rng: np.random.Generator) -> None:
    model = sf.compile(load_model("joint_zoo"), TAPE)
    states = [model.random_state(rng) for _ in range(n)]
    q, v = (np.array(part) for part in zip(*states, strict=True))
    for name in ("dynamics", "forward_dynamics", "mass_matrix"):
        of = ("q",) if name == "mass_matrix" else ("q", "v")
        batch = model.evaluate(name, **dict(zip(of, (q, v), strict=False)))
        single = [model.evaluate(name, **dict(zip(of, state, strict=False))) for state in states]
        for values, each in zip(batch, zip(*single, strict=True), strict=True):
            np.testing.assert_array_equal(values, np.array(each), err_msg=name)


def test_each_operation_has_the_bits_of_the_interpreter() -> None:
    """Numbers of all sizes, those that are none, and angles that the C library takes over."""
    rng = np.random.default_rng(2)
    u = rng.uniform(-3, 3, (200, 2)) * 10.0 ** rng.integers(-3, 9, (200, 1))
    u[:6] = [(0.0, -0.0), (np.inf, 1.0), (-np.inf, 2.0), (np.nan, 0.0), (1e300, -1e300), (1.0, np.nan)]
    at_rest = np.zeros((200, len(OPERATIONS.bodies)))
    inputs = {"q": at_rest, "v": at_rest, "u": u, "t": np.zeros((200, 1))}

    def values(backend: Literal["tape", "interpreter"]) -> np.ndarray:
        kernel = sf.compile(OPERATIONS, sf.Options(backend=backend)).kernel("generalized_force")
        pre = kernel.prepare(np.array([[0.7]]))
        return kernel.run(200, pre, [inputs[name] for name, _ in kernel.signature.inputs])[0]

    np.testing.assert_array_equal(values("tape"), values("interpreter"))


@pytest.mark.parametrize("constraints", ["multipliers", "null_space"])
@pytest.mark.parametrize("case", ["four_bar", "rolling_disc", "two_arms"])
def test_functions_that_routines_finish_have_the_bits_of_c(
    case: str, constraints: Literal["multipliers", "null_space"], rng: np.random.Generator
) -> None:
    c, tape = (sf.compile(MODELS[case], replace(options, constraints=constraints)) for options in (C, TAPE))
    for _ in range(3):
        q, v = c.random_state(rng)
        at = {"q": q, "v": v, "u": rng.standard_normal(c.nu)}
        beside = c.integrate(q, np.full(c.nv, 0.01))
        weights = {"a_bar": rng.standard_normal(c.nv), "lam_bar": rng.standard_normal(c.nc)}
        calls = (("forward_dynamics", {}), ("forward_dynamics_derivatives", {}), ("forward_dynamics_vjp", weights))
        for name, more in (*calls, ("forward_dynamics_hessian", weights)):
            for ours, theirs in zip(tape.evaluate(name, **at, **more), c.evaluate(name, **at, **more), strict=True):
                np.testing.assert_array_equal(ours, theirs, err_msg=name)
        for ours, theirs in zip(tape.project(beside, v), c.project(beside, v), strict=True):
            np.testing.assert_array_equal(ours, theirs, err_msg="project")


@pytest.mark.parametrize("case", ["heavy_top", "four_bar"])
def test_a_run_has_the_bits_of_c(case: str) -> None:
    runs = [sf.simulate(sf.compile(MODELS[case], options), t_end=0.5, dt=0.01) for options in (C, TAPE)]
    np.testing.assert_array_equal(runs[1].q, runs[0].q)
    np.testing.assert_array_equal(runs[1].v, runs[0].v)


def test_run_time_parameters_count(rng: np.random.Generator) -> None:
    s = system("parametrised1")
    tape, twin = (sf.compile(s, sf.Options(backend=backend)) for backend in ("tape", "interpreter"))
    par = np.array(tape.record.par_default) * rng.uniform(0.9, 1.1, tape.npar)
    q, v = tape.random_state(rng)
    for values, expected in zip(
        tape.dynamics(q, v, np.ones(tape.nu), par=par), twin.dynamics(q, v, np.ones(tape.nu), par=par), strict=True
    ):
        np.testing.assert_array_equal(values, expected)


def test_slots_are_returned_and_running_out_of_them_is_refused() -> None:
    """A process holds so many functions at a time, and as many models one after the other as it likes."""
    compilation = Compilation(load_model("pendulum"), sf.Options(("kinetic_energy",)))
    parts, machine = tape_functions(compilation.program), tape_machine(machine_text())
    for _ in range(600):  # Two slots each, of 1024.
        TapeUnit(machine, *parts, compilation.record)
    with pytest.raises(sf.CompileError, match="no room for another function on tape") as error:
        held = [TapeUnit(machine, *parts, compilation.record) for _ in range(600)]
        assert not held
    assert "backend='c'" in str(error.value)
    del error
    TapeUnit(machine, *parts, compilation.record)


def test_no_tape_is_longer_than_its_operations() -> None:
    """Each operation of the graph is one instruction at most."""
    compilation = Compilation(load_model("joint_zoo"), sf.Options(("forward_dynamics",)))
    (function,) = tape_functions(compilation.program)[1]
    runs = [words[0] for name, words in function.tape.code if name not in ("LOAD", "STORE", "STORE_NEG", "CLEAR")]
    count = compilation.operations["forward_dynamics", ""]
    assert sum(runs) <= count.add + count.mul + count.div + count.call
