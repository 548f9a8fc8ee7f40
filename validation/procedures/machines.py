"""One program by several machines: C, tape, NumPy; arrays laid out otherwise; other parameters; steps begun anew."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import symofros as sf

from ..contract.quantities import ROUNDING
from ..mechanics.geometry import Array
from .equations.identities import TRANSPOSED
from .scene import Cell, Scene, off

SAME = 0.5
TAPE = sf.Options(backend="tape")
# Sizes of batches: below, at and behind whole vectors of any width.
_SIZES = (1, 2, 3, 5, 8, 13)
_DERIVATIVES = ("forward_dynamics_derivatives", "inverse_dynamics_derivatives", "inverse_dynamics_by_par", "regressor")
_CONSTRAINED = ("constraint", "constraint_jacobian", "constraint_rate", "constraint_bias")


def taped(scene: Scene) -> Iterator[Cell]:
    """Every function by the tape and by NumPy, of one state and of batches of any size; a run by the tape and by C."""
    tape = sf.compile(scene.system, TAPE)
    plain = sf.compile(scene.system, sf.Options(backend="interpreter"))
    frame = scene.model.names.frames[-1]
    rng, count = np.random.default_rng(17), max(_SIZES)
    given: dict[str, Any] = {"q": _states(scene, rng, count)}
    given |= {name: rng.standard_normal((count, size)) for name, size in _sizes(scene.model).items()}
    names = [
        name for name in (*TRANSPOSED, *_DERIVATIVES, "constraint_jacobian") if scene.model.nc or "constr" not in name
    ]
    if scene.model.nc:  # Of one state that keeps its conditions, or rows repeat each other.
        names = [name for name in names if name not in ("forward_dynamics_derivatives", "regressor")]
    worst = {"one state": 0.0, "batches": 0.0}
    for name in names:
        of, inputs = (frame if name.startswith("frame") else ""), _inputs_of(name)
        wanted = [
            np.stack(x)
            for x in zip(*(plain.evaluate(name, of, **_at(given, inputs, i)) for i in range(2)), strict=True)
        ]
        single = [
            np.stack(x) for x in zip(*(tape.evaluate(name, of, **_at(given, inputs, i)) for i in range(2)), strict=True)
        ]
        worst["one state"] = max(worst["one state"], *(off(a, b) for a, b in zip(single, wanted, strict=True)))
        whole = tape.evaluate(name, of, **{x: given[x] for x in inputs})
        worst["batches"] = max(worst["batches"], *(off(a[:2], b) for a, b in zip(whole, wanted, strict=True)))
        for size in _SIZES:
            some = tape.evaluate(name, of, **{x: given[x][:size] for x in inputs})
            worst["batches"] = max(worst["batches"], *(off(a, b[:size]) for a, b in zip(some, whole, strict=True)))
    for what, error in worst.items():
        yield Cell(f"functions by the tape, {what}", error, 10.0 * ROUNDING)
    runs = [
        sf.simulate(model, scene.q, scene.v, 0.1, u=scene.u, method="rk4", dt=0.01) for model in (tape, scene.model)
    ]
    yield Cell("a run by the tape", max(off(runs[0].q, runs[1].q), off(runs[0].v, runs[1].v)), 1e-10)


def _sizes(model: sf.Model) -> dict[str, int]:
    return {"v": model.nv, "a": model.nv, "u": model.nu, "lam": model.nc}


def _inputs_of(name: str) -> tuple[str, ...]:
    if name in TRANSPOSED:
        return tuple(TRANSPOSED[name][0].split())
    stated = {"forward_dynamics_derivatives": "q v u", "constraint_jacobian": "q"}
    return tuple(stated.get(name, "q v a").split())


def _at(given: dict[str, Any], inputs: tuple[str, ...], i: int) -> dict[str, Any]:
    return {name: given[name][i] for name in inputs}


def _states(scene: Scene, rng: np.random.Generator, count: int) -> Array:
    steps = 0.3 * rng.standard_normal((count, scene.model.nv))
    return np.array([scene.manifold.retract(scene.q, step) for step in steps])


def laid_out(scene: Scene) -> Iterator[Cell]:
    """The same states in other layouts: columns, gaps, reversed, one state for many speeds, single numbers, `out`."""
    model, rng, n = scene.model, np.random.default_rng(18), 11
    q, v = _states(scene, rng, n), rng.standard_normal((n, model.nv))
    wanted = np.array([model.bias(q[i], v[i]) for i in range(n)])
    wide_q, wide_v = np.zeros((2 * n, model.nq + 3)), np.zeros((2 * n, model.nv + 1))
    wide_q[::2, 1:-2], wide_v[::2, :-1] = q, v
    target = np.full((n, model.nv), np.nan)
    layouts: dict[str, tuple[Array, Array]] = {
        "rows": (q, v),
        "columns": (np.asfortranarray(q), np.asfortranarray(v)),
        "with gaps": (wide_q[::2, 1:-2], wide_v[::2, :-1]),
        "in two lengths": (np.stack([q, q]), np.stack([v, v])),
    }
    worst = 0.0
    for one, other in layouts.values():
        found = np.asarray(model.bias(one, other))
        worst = max(worst, off(found.reshape(-1, model.nv)[:n], wanted), off(found.reshape(-1, model.nv)[-n:], wanted))
    backwards = np.asarray(model.bias(q[::-1], v[::-1]))[::-1]
    same = np.asarray(model.bias(q[0], v))
    first = np.array([model.bias(q[0], one) for one in v])
    returned = model.evaluate("bias", q=q, v=v, out={"h": target})[0]
    worst = max(worst, off(backwards, wanted), off(same, first), off(target, wanted), float(returned is not target))
    yield Cell("arrays laid out otherwise", worst, 10.0 * ROUNDING)
    quaternions = scene.model.record.quaternions.get("q", ())
    if quaternions:
        lengths = 1.0 + 1e-5 * np.array([1.0, -1.0, 0.5, -0.5, 0.0, 1.0, -1.0, 0.3, -0.3, 0.9, -0.9])
        worst = 0.0
        apart = np.abs(lengths - 1.0) * (np.arange(n) < n - 1)  # All to one side, and the last one not at all.
        for scaled in (lengths, 2.0 - lengths, 1.0 - apart, 1.0 + apart):
            stretched = q.copy()
            for at in quaternions:
                stretched[:, at : at + 4] *= scaled[:, None]
            for given in (stretched, np.asfortranarray(stretched)):
                worst = max(worst, off(model.bias(given, v), wanted))
                worst = max(worst, *(off(model.bias(given[i], v[i]), wanted[i]) for i in range(n)))
        yield Cell("quaternions off unit length", worst, 1e-9)


def parameterised(scene: Scene) -> Iterator[Cell]:
    """Other values of parameters: stated anew, given with a call, kept by a copy, drawn for each of many, in runs."""
    model, rng = scene.model, np.random.default_rng(19)
    base = np.asarray(model.parameter_values)
    rows = base * rng.uniform(0.98, 1.02, (9, len(base)))
    q, v, u = scene.q, scene.v, scene.law(0.0, scene.q, scene.v)
    names = model.names.par
    stated = tuple(
        replace(one, value=float(rows[0][names.index(one.name)])) if one.name in names else one
        for one in scene.system.parameters
    )
    anew = sf.compile(replace(scene.system, parameters=stated), TAPE)
    kept = model.with_parameters(**dict(zip(names, map(float, rows[0]), strict=True)))
    asked: tuple[Callable[..., Any], ...] = (
        lambda m, **given: m.mass_matrix(q, **given),
        lambda m, **given: m.bias(q, v, **given),
        lambda m, **given: m.generalized_force(q, v, u, **given),
        lambda m, **given: m.forward_dynamics(q, v, u, **given),
        lambda m, **given: m.potential_energy(q, u=u, **given),
        lambda m, **given: m.frame_pose(model.names.frames[-1], q, **given)[0],
    )
    worst = 0.0
    for call in asked:
        wanted = call(anew)
        worst = max(worst, off(call(model, par=rows[0]), wanted), off(call(kept), wanted))
        each = np.array([call(model, par=row) for row in rows])
        worst = max(worst, off(np.asarray(call(model, par=rows)), each))
    yield Cell("other parameters", worst, 1e-9)
    yield Cell("parameters of the model itself", off(np.asarray(model.parameter_values), base), 1e-15)
    runs = [
        sf.simulate(m, q, v, 0.1, u=scene.u, method="rk4", dt=0.01, **given)
        for m, given in ((model, {"par": rows[0]}), (kept, {}), (anew, {}))
    ]
    stepper, many = (
        sf.Stepper(model, dt=0.01, method="rk4"),
        sf.Steppers(model, len(rows), par=rows, dt=0.01, method="rk4"),
    )
    held: Any = sf.Signal([0.0], [u], "hold") if model.nu else None
    wanted = [sf.simulate(model, q, v, 0.1, u=held, par=row, method="rk4", dt=0.01).q[-1] for row in rows[:2]]
    stepper.reset(q, v, par=rows[1])
    many.reset(q, v, par=rows)
    pushed = (u,) if model.nu else ()
    for _k in range(10):
        stepper.step(*pushed)
    many.step(np.tile(u, (len(rows), 1)) if model.nu else None, 10)
    error = max(off(stepper.q, wanted[1]), off(many.q[0], wanted[0]), off(many.q[1], wanted[1]))
    error = max(error, *(off(run.q, runs[0].q) for run in runs[1:]))
    yield Cell("runs with other parameters", error, 1e-9)


def resumed(scene: Scene) -> Iterator[Cell]:
    """A stepper that is kept, copied, put back, begun anew: the same bits as one that was never disturbed."""
    model, v = scene.model, scene.v
    held = scene.law(0.0, scene.q, v)
    options: dict[str, Any] = {"dt": 0.01, "method": "rk4"}
    pushed = (held if model.nu else None,)
    plain = sf.Stepper(model, **options)
    plain.reset(scene.q, v)
    states = [(plain.t, plain.q.copy(), plain.v.copy())]
    for _k in range(12):
        plain.step(*pushed)
        states.append((plain.t, plain.q.copy(), plain.v.copy()))
    one = sf.Stepper(model, **options)
    one.reset(scene.q, v)
    one.step(*pushed, 4)
    kept, other = one.save(), one.copy()
    differing = _differs(one, states[4]) + _differs(other, states[4])
    one.step(*pushed, 8)
    differing += _differs(one, states[12]) + _differs(other, states[4])
    other.step(*pushed, 2)
    differing += _differs(other, states[6])
    one.restore(kept)
    differing += _differs(one, states[4])
    one.step(*pushed)
    differing += _differs(one, states[5])
    yield Cell("steppers kept and put back", float(differing), SAME, "entries of other bits")
    several = sf.Steppers(model, 9, **options)
    starts = v * np.linspace(0.5, 1.5, 9)[:, None]
    rows = (np.tile(held, (9, 1)) if model.nu else None,)
    several.reset(scene.q, starts)
    several.step(*rows, 3)
    all_kept, first = several.save(), several.q.copy()
    several.step(*rows, 5)
    last = several.q.copy(), several.v.copy()
    several.restore(all_kept)
    differing = int(np.sum(several.q != first))
    several.step(*rows, 5)
    differing += int(np.sum(several.q != last[0]) + np.sum(several.v != last[1]))
    chosen = np.arange(9) % 3 == 1
    several.reset(scene.q, starts, which=chosen)
    differing += int(np.sum(several.q[~chosen] != last[0][~chosen]) + np.sum(several.v[chosen] != starts[chosen]))
    yield Cell("many steppers kept and put back", float(differing), SAME, "entries of other bits")


def _differs(stepper: sf.Stepper, state: tuple[float, Array, Array]) -> int:
    """Entries that differ from those of a state; the sum that a time is differs from the product by rounding."""
    t, q, v = state
    return int(np.sum(stepper.q != q) + np.sum(stepper.v != v) + (abs(stepper.t - t) > 1e-12))


def rolled_out(scene: Scene) -> Iterator[Cell]:
    """Rollouts are runs; their gradients, by quaternions too, are those of their tangents and of differences."""
    model, rng, n = scene.model, np.random.default_rng(20), 6
    u = rng.standard_normal((n, model.nu))
    # Steps that turn by less than series need, and by more.
    ways = [("rk4", 0.02), ("semi_implicit_euler", 0.02), ("euler", 0.02)]
    ways += [("rk4", 0.25)] if scene.manifold.nq != model.nv else []
    for method, h in ways:
        roll = sf.rollout(model, scene.q, scene.v, u, h, method=method, t0=0.2)
        shifted: Any = sf.Signal(0.2 + h * np.arange(n), u, "hold") if model.nu else None
        run = sf.simulate(model, scene.q, scene.v, 0.2 + n * h, u=shifted, method=method, dt=h, t0=0.2)
        same = scene.manifold.same_sign(roll.q, run.q)
        name = f"{method}, {h:g} s"
        yield Cell(f"a rollout by {name}", max(off(same, run.q), off(roll.v, run.v), off(roll.t, run.t)), 1e-10)
        q_bar, v_bar = rng.standard_normal((n + 1, model.nv)), rng.standard_normal((n + 1, model.nv))
        gradient = roll.gradient(q_bar, v_bar)
        k = 3
        sizes = {"dq0": (model.nv,), "dv0": (model.nv,), "du": (n, model.nu), "dpar": (model.npar,)}
        d = {name: rng.standard_normal((*size, k)) for name, size in sizes.items()}
        d["dpar"] *= np.asarray(model.parameter_values)[:, None]
        along = roll.tangents(**d)
        forwards = np.einsum("ni,nik->k", q_bar, along.q) + np.einsum("ni,nik->k", v_bar, along.v)
        backwards = gradient.q0 @ d["dq0"] + gradient.v0 @ d["dv0"] + gradient.par @ d["dpar"]
        backwards = backwards + np.einsum("ni,nik->k", gradient.u, d["du"])
        yield Cell(f"gradient of a rollout by {name}", off(backwards, forwards), 1e-9)

        def ends(e: float, method: str = method, h: float = h, d: dict[str, Array] = d) -> tuple[Array, Array]:
            moved = {name: e * value[..., 0] for name, value in d.items()}
            other = sf.rollout(
                model,
                scene.manifold.retract(scene.q, moved["dq0"], twist=True),
                scene.v + moved["dv0"],
                u + moved["du"],
                h,
                method=method,
                par=np.asarray(model.parameter_values) + moved["dpar"],
                t0=0.2,
            )
            return other.q[-1], other.v[-1]

        e = 1e-5
        (q_a, v_a), (q_b, v_b) = ends(e), ends(-e)
        by_q = (np.asarray(model.difference(roll.q[-1], q_a)) - np.asarray(model.difference(roll.q[-1], q_b))) / (2 * e)
        error = max(off(along.q[-1][:, 0], by_q), off(along.v[-1][:, 0], (v_a - v_b) / (2 * e)))
        yield Cell(f"tangents of a rollout by {name}", error, 1e-5)
        if scene.manifold.nq != model.nv:
            weights = rng.standard_normal(model.nq)
            by_coordinates = roll.gradient(weights).q0
            slopes = [
                (
                    weights
                    @ (
                        scene.manifold.same_sign(ends(e, d=one)[0], roll.q[-1])
                        - scene.manifold.same_sign(ends(-e, d=one)[0], roll.q[-1])
                    )
                )
                / (2 * e)
                for one in ({name: value * (name == "dq0") for name, value in d.items()},)
            ]
            yield Cell(
                f"gradient by quaternions, {name}",
                float(abs(by_coordinates @ d["dq0"][:, 0] - slopes[0]) / (abs(slopes[0]) or 1.0)),
                1e-5,
            )
