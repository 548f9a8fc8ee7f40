"""Constraints in the native file survive writing and reading; faults name the line."""

from __future__ import annotations

from pathlib import Path

import symofros as sf


def test_conditions_by_formula_are_read_and_written(tmp_path: Path) -> None:
    body = sf.RigidBody("b", sf.Joint("p", "planar"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    edge = sf.Nonholonomic("n", {"dp.x": "-sin(p.angle)", "dp.y": "cos(p.angle)"}, "0.1*t")
    system = sf.System(
        "s", (body,), constraints=(edge, sf.KnifeEdge("e", ("b", None), "x"), sf.Coupling("c", "p.x - 2*sin(p.angle)"))
    )
    sf.save(system, tmp_path / "model.yaml")
    assert sf.load(tmp_path / "model.yaml") == system
