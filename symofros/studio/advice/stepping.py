"""Which integrator and which step: the cheapest that errs by no more than a share of the tolerance."""

from __future__ import annotations

from collections.abc import Iterator

from symofros.description import System
from symofros.errors import SymofrosError
from symofros.simulation.stepping.methods import METHODS
from symofros.studio.advice.scene_runner import Cost, SceneRunner, Stepping, Trial

_FIXED = ("rk4", "semi_implicit_euler", "implicit_euler", "generalized_alpha")
_ADAPTIVE = ("dopri5", "dop853", "rodas4")
# Of fixed steps the longest that is tried, and how much shorter the next is.
_COARSEST, _FINER = 32, 2.0
_LEVELS = 14
_LOOSEST = 1e-2
# Derivatives of larger models take minutes to compile, which no scene pays back.
LARGEST = 250_000


def cheapest(
    runner: SceneRunner, system: System, reference: Trial, share: float
) -> tuple[Stepping, Cost, float, list[str]]:
    """The cheapest way to step a model through the scene.

    Args:
        runner: Runner of the scene.
        system: System to step.
        reference: Exact motion of the system.
        share: Share of the tolerance, which the error of stepping may take.

    Returns:
        The stepping, its cost, its error in units of what is allowed, and a line on each method tried.

    Raises:
        SymofrosError: No method will do, as may be where only fixed steps may be taken.
    """
    if runner.model(system).nv == 0:
        return runner.given, runner.cost(system, reference, "rk4"), 0.0, ["no speeds are left: nothing is integrated"]
    best: tuple[Stepping, Cost, float] | None = None
    lines = []
    for method in _FIXED if runner.scene.fixed_step else (*_ADAPTIVE, *_FIXED):
        if METHODS[method].family.implicit and not _small(runner, system):
            lines.append(f"{method}: not tried, derivatives of more than {LARGEST} operations")
            continue
        coarsest = _coarsest(runner, system, reference, share, method, None if best is None else best[1].total)
        if coarsest is None:
            lines.append(f"{method}: dearer, or never within {share:.2g} of the tolerance")
            continue
        stepping, cost, error = coarsest
        lines.append(f"{stepping}: {cost.total} operations, error {error:.2g} of the tolerance")
        if best is None or cost.total < best[1].total:
            best = coarsest
    if best is None:
        raise SymofrosError(
            f"advise: no way to step '{system.name}' through the scene",
            "; ".join(lines),
            "one method is within its share of the tolerance",
            "allow adaptive steps, or a larger tolerance",
        )
    return (*best, lines)


def _small(runner: SceneRunner, system: System) -> bool:
    """Whether a model's derivatives may be compiled; those of models with few operations are not counted for it."""
    return runner.operations(system, ("implicit_terms",))["implicit_terms"] <= LARGEST


def _coarsest(
    runner: SceneRunner, system: System, reference: Trial, share: float, method: str, dearest: int | None
) -> tuple[Stepping, Cost, float] | None:
    """The coarsest setting of a method that will do; None where it costs more than `dearest` before it does."""
    for stepping in _ladder(runner.scene.t_end, method):
        trial = runner.trial(system, stepping)
        if trial.run is None:
            continue
        cost, error = runner.cost(system, trial, method), runner.error(trial, reference)
        if dearest is not None and cost.total >= dearest:
            return None
        if error <= share:
            return stepping, cost, error
    return None


def _ladder(t_end: float, method: str) -> Iterator[Stepping]:
    if METHODS[method].adaptive:
        yield from (Stepping(method, rtol=_LOOSEST * 10.0**-k) for k in range(9))
        return
    for k in range(_LEVELS):
        yield Stepping(method, dt=t_end / round(_COARSEST * _FINER**k))
