"""Pictures of a run: curves over time, and paths in a plane."""

from __future__ import annotations

import pytest
from numpy.testing import assert_array_equal

import symofros as sf
from symofros.blocks import Join, Sine
from symofros.diagrams.settings import Plot, RunSettings
from symofros.errors import DescriptionError
from tests.late import require


def circle(plot: Plot) -> sf.Diagram:
    """A sine with its rate."""
    diagram = sf.Diagram("circle", simulation=RunSettings(t_end=0.5, plots=(plot,)))
    diagram.add(Sine(name="wave"))
    diagram.add(Join(name="both"), u1="wave.y", u2="wave.rate")
    return diagram


def test_plane_plots_draw_the_second_entry_over_the_first_at_equal_scales() -> None:
    require("matplotlib", "plots")
    run = sf.Simulation(circle(Plot("path", ("both",), xy=True))).run(dt=0.01, record=0.05)
    (axis,) = run.plot().axes
    (line,) = axis.get_lines()
    assert_array_equal(line.get_xydata(), run["both"])
    assert axis.get_aspect() == 1.0


def test_a_plane_plot_of_one_entry_is_refused() -> None:
    with pytest.raises(DescriptionError, match="over a plane"):
        sf.Simulation(circle(Plot("path", ("wave.y",), xy=True)))
