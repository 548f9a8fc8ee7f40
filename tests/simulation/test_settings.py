"""Settings of runs: what a run does not start from."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros import blocks


@pytest.fixture(scope="module")
def top() -> sf.Model:
    spin = sf.Joint("spin", "free")
    return sf.compile(sf.System("top", (sf.RigidBody("top", spin, sf.Inertia(1.0, (0, 0, 0), (1, 2, 3))),)))


@pytest.mark.parametrize("length", [0.0, 0.5, 0.998, 1.002, 2.0])
def test_quaternions_that_are_no_rotations_are_refused(top: sf.Model, length: float) -> None:
    q = top.neutral()
    q[3:] *= length
    with pytest.raises(sf.ShapeError, match=f"length {length:g}"):
        sf.simulate(top, q, t_end=0.1)
    with pytest.raises(sf.ShapeError, match=f"length {length:g}"):
        sf.simulate_batch(top, t_end=0.1, q0=np.stack([top.neutral(), q]))


def test_quaternions_in_few_digits_are_made_unit_ones(top: sf.Model) -> None:
    q = top.neutral()
    q[3:] = 0.5004, -0.5, 0.5, 0.5
    run = sf.simulate(top, q, t_end=0.1)
    assert abs(np.linalg.norm(run.q[-1, 3:]) - 1.0) < 1e-14


def test_a_result_that_holds_the_state_is_met_with_its_vector(top: sf.Model) -> None:
    with pytest.raises(sf.ShapeError, match=r"type Assembled(.|\n)*pass its vector, \.q"):
        sf.simulate(top, sf.assemble(top), t_end=0.1)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        *(("t", "t_end"), ("T", "t_end"), ("duration", "t_end"), ("tmax", "t_end"), ("t_ends", "t_end")),
        *(("step", "dt"), ("solver", "method"), ("x0", "q0"), ("params", "par"), ("inputs", "u"), ("metod", "method")),
    ],
)
def test_names_that_other_tools_have_lead_to_ours(top: sf.Model, written: str, meant: str) -> None:
    for simulate in (sf.simulate, sf.simulate_batch):
        with pytest.raises(sf.UnknownNameError, match=f"no option '{written}'(.|\n)*did you mean '{meant}'"):
            simulate(top, **{written: 1.0})


def test_names_that_other_tools_have_for_what_a_run_lacks_are_not_suggested(top: sf.Model) -> None:
    """A diagram has no first configuration: its options are named instead."""
    diagram = sf.Diagram("d")
    diagram.add(blocks.Constant(name="one", value=1.0))
    for written, meant in (("t", "t_end"), ("params", "parameters")):
        with pytest.raises(sf.UnknownNameError, match=f"did you mean '{meant}'"):
            sf.Simulation(diagram).run(0.1, **{written: 1.0})
    with pytest.raises(sf.UnknownNameError, match="no option 'x0'") as refused:
        sf.Simulation(diagram).run(0.1, x0=1.0)
    assert "q0" not in str(refused.value)
