"""What frozen public classes state is their own, whatever becomes of the arrays, lists and tables that stated it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.base.arguments import checked

# Class, its arguments, the one that is filled anew. The latter holds one number at least.
CASES: dict[str, tuple[Any, dict[str, Any], str]] = {
    "action of an event": (sf.Event, {"formula": "t - 1", "action": {"dx": 2.0}}, "action"),
    "samples": (sf.Signal, {"t": np.array([0.0, 1.0]), "values": np.array([1.0, 2.0])}, "values"),
    "output times": (sf.SimulationOptions, {"output": np.array([0.1, 0.2])}, "output"),
    "target": (sf.Target, {"position": np.array([0.1, 0.2, 0.3])}, "position"),
    "condition": (sf.Condition, {"triggered": "a.y", "initial": {"y": [1.0, 2.0]}}, "initial"),
    "machine state": (blocks.MachineState, {"during": {"tau": 2.0}}, "during"),
    "block": (blocks.Constant, {"name": "c", "value": np.array([1.0, 2.0])}, "value"),
    "block by lists": (blocks.LookupTable, {"name": "c", "x": [0.0, 1.0], "y": [3.0, 4.0]}, "y"),
    "events of a block": (blocks.ForwardDynamics, {"name": "c", "model": "m", "events": {"e": "t - 1"}}, "events"),
}


def spoil(value: Any) -> None:
    """Fill an array, list or table anew, and what lies in it."""
    for key in [*value] if isinstance(value, dict) else range(len(value)):
        if isinstance(value[key], dict | list):
            spoil(value[key])
        else:
            value[key] = 99.0


@pytest.mark.parametrize("case", CASES)
def test_fields_do_not_change_with_their_arguments(case: str) -> None:
    made_of, arguments, name = CASES[case]
    made = made_of(**arguments)
    before = repr(getattr(made, name))
    spoil(arguments[name])
    assert repr(getattr(made, name)) == before and repr(arguments[name]) != before


def test_a_call_with_options_by_name_is_not_refused_for_them() -> None:
    """What is wrong is the second argument, not `dt`, and nobody gives `self`."""
    for wrong in (lambda: sf.Stepper(None, [0.1], dt=0.1), lambda: sf.Stepper(dt=0.1)):  # type: ignore[call-arg, misc]
        with pytest.raises(sf.ArgumentError) as raised:
            wrong()
        assert "'dt'" not in str(raised.value) and "self" not in str(raised.value)
        assert "it takes model, u, par, events, options, and options by name" in str(raised.value)


def test_each_of_any_number_of_arguments_is_checked() -> None:
    """They were taken as they came: a list of inputs failed at the first run, inside."""
    diagram: Any = sf.Diagram("d")
    with pytest.raises(sf.ArgumentError, match=r"add_inlet: targets is not a text\n  found:  list"):
        diagram.add_inlet("goal", ["a.u", "b.u"])
    with pytest.raises(sf.ArgumentError, match=r"add: inputs is not a text\n  found:  Gain"):
        diagram.add(blocks.Gain(name="a"), u=blocks.Gain(name="c"))


def test_calls_with_options_by_name_are_looked_at_without_inspect(monkeypatch: pytest.MonkeyPatch) -> None:
    """`inspect.Signature.bind` took a tenth of a short run; other arguments, and collected ones, are checked."""

    @checked
    def run(model: int, *, t_end: float = 1.0, **changes: Any) -> dict[str, Any]:
        return changes

    @checked
    def add(**inputs: str) -> dict[str, str]:
        return inputs

    with pytest.raises(sf.ArgumentError, match="add: inputs is not a text"):
        add(u=3)
    with pytest.raises(sf.ArgumentError, match="run: t_end is not a number"):
        run(1, t_end="1", dt=0.1)
    monkeypatch.setattr("symofros.base.arguments.bound", None)
    assert run(1, t_end=2.0, dt=0.1, changes=3) == {"dt": 0.1, "changes": 3}
