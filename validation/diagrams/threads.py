"""Two mechanisms of one diagram on two threads: the paper's simulation on several processors."""

from __future__ import annotations

import numpy as np

import symofros as sf
from symofros import blocks

from ..references import MODELS
from ..reporting.figures import Chart, Curve, Figure
from ..reporting.findings import Finding, Study

DT, PERIODS = 1e-3, (1e-3, 2e-3, 5e-3, 1e-2)


def copies(period: float, count: int = 2) -> sf.Diagram:
    """Copies of the station's arms, each following the other's joints as sampled."""
    diagram = sf.Diagram("copies")
    names = [f"arm{k}" for k in range(count)]
    system = MODELS["mss"]
    for k, name in enumerate(names):
        start = {f"spdm_left_q{i}": 0.1 * (k + 1) for i in range(1, 8)}
        diagram.add_model(name, system, start)
        diagram.add(blocks.ForwardDynamics(name=name, model=name), u=f"{name}_pd.effort")
        other = names[(k + 1) % count]
        diagram.add(
            blocks.JointPD(name=f"{name}_pd", kp=20.0, kd=40.0, period=period),
            q_desired=f"{other}.q",
            q=f"{name}.q",
            v=f"{name}.v",
        )
    return diagram


def study(quick: bool) -> Study:
    """Compare results and wall times of a diagram of two mechanisms on one and on two threads."""
    t_end = 0.5 if quick else 4.0
    gains, same = [], True
    for period in PERIODS[:2] if quick else PERIODS:
        simulation = sf.Simulation(copies(period))
        parts = len(simulation.resolved.layout.parts)
        times: list[tuple[float, float]] = []
        for _ in range(5):
            alone = simulation.run(t_end, dt=DT, record=0.05)
            shared = simulation.run(t_end, dt=DT, record=0.05, threads=2)
            same &= np.array_equal(alone.q, shared.q) and np.array_equal(alone.v, shared.v)
            times.append((alone.cost.seconds, shared.cost.seconds))
        one, two = np.min(times, axis=0)
        gains.append(float(one / two))
    findings = (
        Finding("parts that move apart between samples", float(parts), 2.0, 2.0, "they meet at samples only"),
        Finding(
            "runs on one and on two threads that differ in a bit",
            0.0 if same else 1.0,
            0.0,
            reason="nothing is exchanged between samples",
        ),
        Finding(
            "time on one thread over that on two, best period",
            max(gains),
            2.0,
            0.5,
            "2 at most on two cores; below 1 where the machine has other work",
        ),
    )
    shown = np.array(PERIODS[: len(gains)])
    figure = Figure(
        "Two threads meet at every sample; the rarer samples are, the less of the gain that costs. Where two cores are"
        " free the curve lies between 1 and 2.",
        (
            Chart(
                "two mechanisms of 22 joints on two threads",
                "sample period [s]",
                "time of one thread over two",
                (Curve("measured", shown, np.array(gains), 0, "joined"),),
                log="x",
            ),
        ),
    )
    answer = (
        "Mechanisms that see each other at samples only are integrated by themselves in between. On two threads the"
        f" run takes 1/{max(gains):.2f} of the time at best (wall clock, the fastest of five runs each), and every"
        " bit of the result is that of one thread."
    )
    return Study("What do several processors gain, and do they change anything?", answer, (figure,), findings)
