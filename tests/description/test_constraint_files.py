"""Constraints in the native file survive writing and reading; faults name the line."""

from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf


def test_conditions_by_formula(tmp_path: Path) -> None:
    body = sf.RigidBody("b", sf.Joint("p", "planar"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    edge = sf.Nonholonomic("n", {"dp.x": "-sin(p.angle)", "dp.y": "cos(p.angle)"}, "0.1*t")
    system = sf.System(
        "s", (body,), constraints=(edge, sf.KnifeEdge("e", ("b", None), "x"), sf.Coupling("c", "p.x - 2*sin(p.angle)"))
    )
    sf.save(system, tmp_path / "model.yaml")
    assert sf.load(tmp_path / "model.yaml") == system


HEAD = "symofros: 1\nbodies:\n  a: {joint: {name: p, kind: revolute}, inertia: {mass: 1, moments: [1, 1, 1]}}\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("closures:\n  k: {first: {body: a}, second: {body: world}, translations: [w]}\n", "bad.yaml:5"),
        ("closures:\n  k: {first: {body: a}, second: {body: world}, length: 1, translations: [x]}\n", "both a rod"),
        ("closures:\n  k: {first: {body: a}, second: {body: world}, translations: []}\n", "blocks nothing"),
        ("closures:\n  k: {first: {body: b}, second: {body: world}}\n", "no body 'b'"),
        ("nonholonomic:\n  k: {right: 1}\n", "not exactly one kind"),
        ("nonholonomic:\n  k: {knife_edge: {body: a}, rolling: {body: a, radius: 1}}\n", "not exactly one kind"),
    ],
)
def test_faults(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "bad.yaml").write_text(HEAD + text)
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(tmp_path / "bad.yaml")
    assert said in str(caught.value), str(caught.value)
