"""Which input of a run is no finite number or no rotation, and where it comes from."""

from __future__ import annotations

import numpy as np

from symofros.simulation.inputs import InputPlan
from symofros.simulation.settings import UNIT_TOLERANCE
from symofros.simulation.stepping.bound_run import InputValueError
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.user_functions import raised_where

# Size of a state that makes feedback overflow.
_EXPLODED = 1e100


def input_failure(failure: BaseException | None) -> tuple[str, str]:
    """Reason and advice for a function of inputs that failed, and ended the run."""
    if isinstance(failure, InputValueError):
        return str(failure), "let it return finite numbers, one an input"
    if failure is None:
        return "the input function failed", "call it by itself at this state"
    return f"the input function raised {raised_where(failure)}", "call it by itself at this state; outcome.failure"


def input_fault(stepper: Stepper) -> str:
    """The input that is not finite, or no rotation, at the state evaluated last, in words; "" where there is none."""
    t, q, v = stepper.evaluation_point
    if not np.abs(np.concatenate([q, v])).max(initial=0.0) < _EXPLODED:
        return ""  # The state went first, and took a feedback with it.
    bad = np.flatnonzero(~np.isfinite(stepper.inputs_now))
    if not len(bad):
        return _no_rotation(stepper, t)
    i = int(bad[0])
    value = stepper.inputs_now[i]
    return f"input '{stepper.model.names.u[i]}' is {value} at t = {t:.6g} s, {_source(stepper.inputs, i)}"


def _no_rotation(stepper: Stepper, t: float) -> str:
    """The quaternion among the inputs that is of another length than one, in words; "" where there is none."""
    for first in stepper.model.record.quaternion_inputs:
        length = float(np.linalg.norm(stepper.inputs_now[first : first + 4]))
        if not abs(length - 1.0) <= UNIT_TOLERANCE:
            names = ", ".join(stepper.model.names.u[first : first + 4])
            return f"inputs {names} are a quaternion of length {length:.6g} at t = {t:.6g} s, which is no rotation"
    return ""


def _source(inputs: InputPlan, i: int) -> str:
    """Source of input i, in words: its formula, its samples, or a constant."""
    if i in inputs.formulas:
        return f"by its formula {str(inputs.formulas[i])!r}"
    if any(index == i for index, *_ in inputs.signals):
        return "by its samples"
    return "a constant"
