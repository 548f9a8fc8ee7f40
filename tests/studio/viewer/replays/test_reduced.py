"""Drawings of replays: what is left out, and how far shapes are from what they were."""

from __future__ import annotations

from dataclasses import replace

from reference_models import MODELS
from symofros.studio.viewer.drawing.drawing import DrawnPart
from symofros.studio.viewer.drawing.layers import initial_layers
from symofros.studio.viewer.drawing.meshes import Mesh, on_grid
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.replays.reduced import reducing, tolerance_of
from tests.late import late
from tests.studio.viewer.drawing.test_decimation import distances

creation = late("trimesh.creation", "view")


def test_shapes_stay_within_the_tolerance_that_pages_tell() -> None:
    drawing = Mechanism(MODELS["planar_robot"]).drawing()
    ball = creation.icosphere(subdivisions=5, radius=0.2 * drawing.size)
    shape = DrawnPart("visuals/ball", "visuals", 0, Mesh(ball.vertices, ball.faces), (1, 2, 3))
    dressed = replace(drawing, parts=(*drawing.parts, shape, replace(shape, name="visuals/other")))
    layers = frozenset({"visuals", "ground"})
    tolerance = tolerance_of(dressed)
    reduce = reducing(layers, tolerance)
    shown = reduce(dressed)
    assert [part.name for part in shown.parts] == ["visuals/ball", "visuals/other"]
    assert not shown.beams and not shown.connectors and not shown.triads
    first, second = shown.parts
    assert first.mesh is second.mesh is reduce(dressed).parts[0].mesh  # Decimated once.
    assert len(first.mesh.faces) < 0.5 * len(ball.faces)
    seen = first.mesh._replace(vertices=on_grid(first.mesh.vertices, dressed.size))
    assert distances(ball.vertices[::60], seen).max() < tolerance


def test_a_drawing_keeps_all_that_its_layers_show() -> None:
    for name in ("planar_robot", "four_bar"):
        drawing = Mechanism(MODELS[name]).drawing()
        layers = initial_layers(drawing)
        shown = reducing(layers, tolerance_of(drawing))(drawing)
        assert shown.parts == tuple(part for part in drawing.parts if part.kind in layers)
        assert shown.beams == drawing.beams and shown.connectors == drawing.connectors and shown.size == drawing.size
        assert not shown.triads and reducing(layers | {"frames"}, 1.0)(drawing).triads == drawing.triads
