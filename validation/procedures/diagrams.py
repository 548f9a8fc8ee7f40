"""Block diagrams in C against block by block from Python, and against closed forms."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import symofros as sf
from symofros import blocks

from ..mechanics.geometry import Array
from .formats.exported import printed
from .scene import Cell, off

ROUNDING = 1e-10


def looped(plant: sf.System) -> Iterator[Cell]:
    """Two plants, one of them under a sampled controller with a filter, delays and several rates.

    Args:
        plant: A mechanism of two coordinates with one input.
    """
    d = sf.Diagram("loop")
    for name in ("plant", "other"):
        d.add_model(name, plant, start=dict(zip(sf.compile(plant).names.q, (0.1, 0.2), strict=True)))
    d.add(blocks.Sine(name="wave", amplitude=0.4, frequency=3.0))
    d.add(blocks.TransferFunction(name="filter", num=(1.0,), den=(0.05, 1.0)), u="wave.y")
    d.add(blocks.Pick(name="angle", entries=[1]), u="plant.q")
    d.add(blocks.UnitDelay(name="late", period=0.03, offset=0.01), u="angle")
    d.add(blocks.Hold(name="held", period=0.02), u="filter")
    d.add(blocks.Formula(name="force", formulas={"y": ["2*a - 3*b[0] + 0.1*sin(t)"]}), a="held", b="late")
    d.add(blocks.RateLimit(name="slow", rising=3.0, falling=2.0, period=0.01), u="force.y")
    d.add(blocks.Saturation(name="limited", low=-0.5, high=0.6), u="slow")
    d.add(
        blocks.PythonBlock(
            name="law",
            function=lambda t, given: {"y": [0.2 * given["x"][0] - t], "z": [t, 2.0]},
            inputs={"x": (1,)},
            outputs={"y": (1,), "z": (2,)},
            period=0.015,
        ),
        x="angle",
    )
    d.add(blocks.ForwardDynamics(name="plant", model="plant"), u="limited")
    d.add(blocks.ForwardDynamics(name="other", model="other"), u="law.y")
    simulation = sf.Simulation(d)
    names = ("plant.q", "plant.v", "plant.a", "other.q", "filter.y", "late.y", "limited.y", "law.y", "law.z")
    for method in ("rk4", "euler"):
        run = simulation.run(0.107, dt=2e-3, record=0.004, method=method)
        other = simulation.interpret(0.107, dt=2e-3, record=0.004, method=method, compiled=False)
        error = off(run.t, other.t) + max(off(run[name], other[name]) for name in names)
        yield Cell(f"a diagram by {method}", error + float(not run.outcome.ok), ROUNDING)
    again = simulation.run(0.107, dt=2e-3, record=0.004, method="euler", threads=2)
    yield Cell("a diagram by two threads", max(off(again[name], run[name]) for name in names), ROUNDING)
    fine = [simulation.run(0.107, method=name, rtol=1e-9, atol=1e-9, record=0.107) for name in ("dop853", "dopri5")]
    yield Cell("a diagram by chosen steps", off(fine[0]["plant.q"][-1], fine[1]["plant.q"][-1]), 1e-6)


def switched() -> Iterator[Cell]:
    """A relay that a sine switches: its crossings and the time that it was on."""
    d = sf.Diagram("switch")
    d.add(blocks.Sine(name="wave", amplitude=1.0, frequency=1.0))
    d.add(blocks.Relay(name="relay", lower=-0.5, upper=0.5, on=2.0, off=-1.0), u="wave.y")
    d.add(blocks.Integrator(name="sum"), u="relay")
    run = sf.Simulation(d).run(1.3, dt=0.01, record=0.1)
    rise, fall = 1 / 12, 7 / 12  # sin(2 pi t) = 1/2 rising, -1/2 falling.

    def integral(t: float) -> float:
        ends = np.clip([rise, fall, 1 + rise, 10.0], 0.0, t)
        on = ends[1] - ends[0] + max(0.0, t - ends[2])
        return float(2.0 * on - (t - on))

    wanted = np.array([integral(float(t)) for t in run.t])
    # Cubics locate the crossings of a sine, to the fourth power of the step.
    yield Cell("a relay that a sine switches", off(run["sum.y"].ravel(), wanted), 1e-5)
    inner = [t for t in run.t if abs(t * 10 - round(t * 10)) > 1e-6]
    crossings = np.array(sorted(set(np.round(inner, 6))))
    yield Cell("crossings", off(crossings, np.array([rise, fall, 1 + rise])), 1e-5)
    lag = sf.Diagram("lag")
    lag.add(blocks.Sine(name="wave", amplitude=1.0, frequency=7.0 / (2 * math.pi)))
    lag.add(blocks.TransferFunction(name="lag", num=(1.0,), den=(0.1, 1.0)), u="wave.y")
    run = sf.Simulation(lag).run(1.0, method="dop853", rtol=1e-11, atol=1e-13, record=0.25)
    b, t = 0.7, run.t
    wanted = (np.sin(7 * t) - b * np.cos(7 * t) + b * np.exp(-10 * t)) / (1 + b * b)
    yield Cell("a lag", off(run["lag.y"].ravel(), wanted), 1e-9)


def sampled() -> Iterator[Cell]:
    """Blocks that are sampled: at each instant a value is taken and held until the next; a delay gives the one before.

    Periods that divide steps and records and periods that do not; instants that coincide with records.
    """
    d = sf.Diagram("sampled")
    d.add(blocks.Sine(name="wave", amplitude=1.0, frequency=0.7))
    rates = {"even": (0.02, 0.0), "odd": (0.03, 0.0), "late": (0.05, 0.015)}
    for name, (period, offset) in rates.items():
        d.add(blocks.Hold(name=f"hold_{name}", period=period, offset=offset), u="wave.y")
        d.add(blocks.UnitDelay(name=f"delay_{name}", period=period, offset=offset), u="wave.y")
    for method in ("rk4", "dopri5"):
        run = sf.Simulation(d).run(0.4, dt=0.01, record=0.005, method=method)
        for name, (period, offset) in rates.items():
            number = np.floor((run.t - offset) / period + 1e-9)

            def wave(n: Array, period: float = period, offset: float = offset) -> Array:
                return np.where(n >= 0.0, np.sin(2 * math.pi * 0.7 * (offset + n * period)), 0.0)

            errors = [
                off(run[f"hold_{name}.y"].ravel(), wave(number)),
                off(run[f"delay_{name}.y"].ravel(), wave(number - 1.0)),
            ]
            yield Cell(f"samples {name} by {method}", max(errors), ROUNDING)


def stored(plant: sf.System) -> Iterator[Cell]:
    """A diagram that is written and read again runs to the same bits; exported as C, it tells what a run does.

    Args:
        plant: A mechanism of two coordinates with one input.
    """
    d = sf.Diagram("kept")
    d.add_model("plant", plant, start=dict(zip(sf.compile(plant).names.q, (0.1, 0.2), strict=True)))
    d.add(blocks.Sine(name="wave", amplitude=0.4, frequency=3.0))
    d.add(blocks.TransferFunction(name="filter", num=(1.0,), den=(0.05, 1.0)), u="wave.y")
    d.add(blocks.Pick(name="angle", entries=[1]), u="plant.q")
    d.add(blocks.UnitDelay(name="late", period=0.02, offset=0.01), u="angle")
    d.add(blocks.Formula(name="force", formulas={"y": ["2*a - 3*b[0] + 0.1*sin(t)"]}), a="filter", b="late")
    d.add(blocks.Saturation(name="limited", low=-0.5, high=0.6), u="force.y")
    d.add(blocks.ForwardDynamics(name="plant", model="plant"), u="limited")
    names = ["plant.q", "plant.a", "late.y", "limited.y"]
    run = sf.Simulation(d).run(0.2, dt=1e-3, record=0.05)
    with tempfile.TemporaryDirectory() as folder:
        sf.save_diagram(d, Path(folder, "kept.yaml"))
        again = sf.Simulation(sf.load_diagram(Path(folder, "kept.yaml"))).run(0.2, dt=1e-3, record=0.05)
    differing = sum(int(np.sum(again[name] != run[name])) for name in names)
    yield Cell("a diagram read again", float(differing), 0.5, "entries of other bits")
    with tempfile.TemporaryDirectory() as folder:
        files = sf.export(d, "c", folder, outputs=names).folder
        text = printed(files, "0.2", "0.05")
    rows = np.array([[float(x) for x in row.split(",")] for row in text.splitlines()[1:]])
    wanted = np.concatenate(
        [run.t[:, None], *(np.asarray(run[name]).reshape(len(run.t), -1) for name in names)], axis=1
    )
    yield Cell("a diagram as a package of C", off(rows, wanted), 1e-8)
