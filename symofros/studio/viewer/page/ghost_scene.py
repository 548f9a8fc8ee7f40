"""Ghosts on a server: transparent, each in one color."""

from __future__ import annotations

import html
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from symofros.mechanics.topology import BASE
from symofros.studio.viewer.drawing.drawing import Color, Drawing, DrawnBeam, DrawnConnector
from symofros.studio.viewer.drawing.meshes import on_grid, tube, tube_stations
from symofros.studio.viewer.drawing.poses import Posture, Sweep, beam_sweep, connector_sweep
from symofros.studio.viewer.playing.ghosts import Ghost

_OPACITY = 0.35
_LAYERS = frozenset({"bodies", "joints", "constraints", "visuals"})  # Of what is drawn of a ghost.
_ROOT = "/ghosts"


def legend_of(ghosts: Sequence[Ghost]) -> str:
    """Names of ghosts with their colors, as HTML."""
    rows = (
        f'<li><span style="color: rgb{ghost.color}" aria-hidden="true">■</span> {html.escape(ghost.name)}</li>'
        for ghost in ghosts
    )
    style = "margin: 2px 0; padding: 0 0.5em; list-style: none; font-size: 13px; overflow-wrap: anywhere"
    return f'<ul style="{style}" aria-label="Ghosts">{"".join(rows)}</ul>'


class GhostScene:
    """The nodes of ghosts, in place of those of earlier ones.

    Args:
        server: Server of viser.
        ghosts: Color and drawing of each.
        layers: Layers that are shown.
    """

    def __init__(self, server: Any, ghosts: Sequence[tuple[Color, Drawing]], layers: frozenset[str]) -> None:
        self._server = server
        self._layered: dict[str, list[Any]] = {layer: [] for layer in _LAYERS}
        with server.atomic():
            self._ghosts = [self._add(f"{_ROOT}/{k}", *ghost, layers) for k, ghost in enumerate(ghosts)]

    def _add(self, root: str, color: Color, drawing: Drawing, layers: frozenset[str]) -> _GhostNodes:
        scene = self._server.scene
        nodes = _GhostNodes(drawing, scene.add_frame(root, show_axes=False))
        for part in drawing.parts:
            if part.kind in _LAYERS and part.link != BASE:  # What stands still is drawn once.
                if part.link not in nodes.links:
                    nodes.links[part.link] = scene.add_frame(f"{root}/link{part.link}", show_axes=False)
                vertices = part.mesh.vertices
                node = scene.add_mesh_simple(
                    f"{root}/link{part.link}/{part.name.replace('/', '.')}",
                    on_grid(vertices, drawing.size) if part.kind == "visuals" else vertices,
                    part.mesh.faces,
                    color=color,
                    opacity=_OPACITY,
                    cast_shadow=False,
                )
                self._keep(part.kind, node, layers)
        swept: list[tuple[str, DrawnBeam | DrawnConnector, int]] = [
            *(("bodies", beam, len(beam.line.points(beam.length, np.zeros(beam.q[1])))) for beam in drawing.beams),
            *((item.kind, item, 2) for item in drawing.connectors if item.kind in _LAYERS),
        ]
        for i, (layer, item, stations) in enumerate(swept):
            node = _add_tube(scene, f"{root}/tubes/{i}", item, stations, color)
            nodes.tubes.append((item, node))
            self._keep(layer, node, layers)
        return nodes

    def _keep(self, layer: str, node: Any, layers: frozenset[str]) -> None:
        node.visible = layer in layers
        self._layered[layer].append(node)

    def show(self, layer: str, visible: bool) -> None:
        """Show or hide a layer of all ghosts; layers that ghosts have not are passed over."""
        for node in self._layered.get(layer, ()):
            node.visible = visible

    def move(self, postures: Sequence[Posture | None]) -> None:
        """Put each ghost where its posture has it; None: it is not shown."""
        with self._server.atomic():
            for nodes, posture in zip(self._ghosts, postures, strict=True):
                if nodes.root.visible != (posture is not None):
                    nodes.root.visible = posture is not None
                if posture is not None:
                    nodes.move(posture)

    def remove(self) -> None:
        """Take the ghosts out of the picture; tubes stay, hidden: viser's page breaks down where one is removed."""
        with self._server.atomic():
            for nodes in self._ghosts:
                nodes.root.visible = False
                for node in nodes.links.values():
                    node.remove()


class _GhostNodes:
    """The nodes of one ghost: its root, its links by their indices, its tubes."""

    def __init__(self, drawing: Drawing, root: Any) -> None:
        self.drawing, self.root = drawing, root
        self.links: dict[int, Any] = {}
        self.tubes: list[tuple[DrawnBeam | DrawnConnector, Any]] = []
        self._rotation = import_module("viser.transforms").SO3

    def move(self, posture: Posture) -> None:
        turns = self._rotation.from_matrix(posture.R).wxyz
        for i, node in self.links.items():
            node.position, node.wxyz = posture.p[i], turns[i]
        for item, node in self.tubes:
            self._bend(
                node, beam_sweep(item, posture) if isinstance(item, DrawnBeam) else connector_sweep(item, posture)
            )

    def _bend(self, node: Any, sweep: Sweep) -> None:
        turns = self._rotation.from_matrix(sweep.axes).wxyz
        for bone, point, turn in zip(node.bones, sweep.points, turns, strict=True):
            bone.position, bone.wxyz = point, turn


def _add_tube(scene: Any, name: str, item: DrawnBeam | DrawnConnector, stations: int, color: Color) -> Any:
    # At rest along x; its first move brings it to its place.
    points, axes = np.zeros((stations, 3)), np.tile(np.eye(3), (stations, 1, 1))
    points[:, 0] = np.linspace(0.0, 1.0, stations)
    mesh = tube(item.outline, points, axes)
    return scene.add_mesh_skinned(
        name,
        mesh.vertices,
        mesh.faces,
        color=color,
        opacity=_OPACITY,
        cast_shadow=False,
        bone_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (stations, 1)),
        bone_positions=points,
        skin_weights=np.eye(stations)[tube_stations(stations, len(item.outline))],
    )
