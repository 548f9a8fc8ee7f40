"""A drawing as a viser scene, and its motion."""

from __future__ import annotations

from collections.abc import Callable, Collection
from importlib import import_module
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.mechanics.topology import BASE
from symofros.studio.viewer.drawing.drawing import Color, Drawing, DrawnBeam, DrawnConnector, DrawnPart
from symofros.studio.viewer.drawing.ground import GRAVITY_COLOR, cell_of, gravity_arrow
from symofros.studio.viewer.drawing.layers import ARROWS, HEAD, HEAD_RADIUS, LAYERS, SHAFT_RADIUS, Arrows, check_layer
from symofros.studio.viewer.drawing.meshes import on_grid, tube, tube_stations
from symofros.studio.viewer.drawing.poses import Posture, Sweep, beam_sweep, connector_sweep
from symofros.studio.viewer.render.camera import Camera

_ROOT, _TUBES = "/mechanism", "/tubes"
MARKED: Color = (255, 0, 150)  # Unlike every colour that bodies have.
SEE_THROUGH = 0.3  # Opacity of boxes of inertia, and of what frames are shown in.
_OPAQUE = ("bodies", "joints", "visuals")
_SEEN = 1e3  # How far the camera sees, of the mechanism's size.
_AWAY = np.array([[0.0, 0.0, -1e5], [0.0, 0.0, -1.1e5]])  # Ends of an arrow out of its sight; of no length, it stays.
_TRIAD = 0.05  # Length of a frame's axes, of the mechanism's size.


class _Marked(NamedTuple):
    """A node of an element: the colour that it has unmarked, None of one that is shown as a mark; its layer."""

    node: Any
    color: Color | None
    layer: str


class ViserScene:
    """The nodes of one drawing on a server, in place of those of the drawing before.

    Args:
        server: Server of viser.
        drawing: Drawing to show.
        posture: Posture of the mechanism.
        layers: Layers that are shown.
        marked: Elements of the description that are marked.
        on_pick: Called with the element that somebody clicks.
    """

    def __init__(
        self,
        server: Any,
        drawing: Drawing,
        posture: Posture,
        layers: frozenset[str],
        marked: Collection[str] = (),
        on_pick: Callable[[str], None] | None = None,
    ) -> None:
        self.server, self.drawing, self._on_pick = server, drawing, on_pick
        self.marked: frozenset[str] = frozenset()
        self._of_elements: dict[str, list[_Marked]] = {}
        self._rotation = import_module("viser.transforms").SO3
        self._shown = layers
        self._tubes = 0
        self._nodes: dict[str, list[Any]] = {layer: [] for layer in LAYERS}
        self._arrows: dict[str, Any] = {}
        with server.atomic():
            if server.scene.get_handle_by_name(_ROOT) is not None:
                server.scene.remove_by_name(_ROOT)
            server.scene.world_axes.visible = False
            server.scene.add_frame(_ROOT, show_axes=False)
            self._links = {
                i: server.scene.add_frame(self._link(i), show_axes=False) for i in range(BASE, posture.p.shape[0] - 1)
            }
            for part in drawing.parts:
                self._add_mesh(part, f"{self._link(part.link)}/{_node(part.name)}")
            self._beams = [self._add_tube("bodies", beam, beam_sweep(beam, posture)) for beam in drawing.beams]
            self._connectors = [
                self._add_tube(connector.kind, connector, connector_sweep(connector, posture))
                for connector in drawing.connectors
            ]
            self._hide_spare_tubes()
            self._add_frames()
            self._see_through()
            self._add_ground()
            self._aim()
            self.mark(marked)
            self.move(posture)

    def move(self, posture: Posture, arrows: Arrows | None = None) -> None:
        """Put everything where a posture has it, with arrows of forces; browsers show all of it at once."""
        turns = self._rotation.from_matrix(posture.R).wxyz
        with self.server.atomic():
            for i, node in self._links.items():
                node.position, node.wxyz = posture.p[i], turns[i]
            for beam, node in zip(self.drawing.beams, self._beams, strict=True):
                if beam.q[1]:
                    self._pose(node, beam_sweep(beam, posture))
            for connector, node in zip(self.drawing.connectors, self._connectors, strict=True):
                self._pose(node, connector_sweep(connector, posture))
            for layer in ARROWS:
                self._point(layer, (arrows or {}).get(layer, np.zeros((0, 2, 3))))

    def _point(self, layer: str, ends: Array) -> None:
        """Show the arrows of a layer (K, 2, 3).

        Viser's page goes on drawing arrows by which a node gets fewer: those that don't show are put out of sight.
        """
        node = self._arrows.get(layer)
        hidden = np.asarray(np.isnan(ends).any(axis=(1, 2)))
        if hidden.all():
            if node is not None:
                node.visible = False
            return
        ends = np.where(hidden[:, None, None], _AWAY * self.drawing.size, ends)
        if node is None:
            size = self.drawing.size
            node = self._arrows[layer] = self.server.scene.add_arrows(
                f"{_ROOT}/{layer}",
                ends,
                np.array(ARROWS[layer][0]),
                shaft_radius=SHAFT_RADIUS * size,
                head_radius=HEAD_RADIUS * size,
                head_length=HEAD * size,
            )
        else:
            node.points = ends
        node.visible = True

    def _pose(self, node: Any, sweep: Sweep) -> None:
        turns = self._rotation.from_matrix(sweep.axes).wxyz
        for bone, point, turn in zip(node.bones, sweep.points, turns, strict=True):
            bone.position, bone.wxyz = point, turn

    @property
    def layers(self) -> frozenset[str]:
        """The displayed layers."""
        return self._shown

    def show(self, layer: str, visible: bool) -> None:
        """Show or hide a layer.

        Raises:
            UnknownNameError: It is none of LAYERS.
        """
        check_layer("view", layer)
        self._shown = self._shown | {layer} if visible else self._shown - {layer}
        for node in self._nodes[layer]:
            node.visible = visible
        self._see_through()
        self.mark(self.marked)

    def mark(self, elements: Collection[str]) -> None:
        """Mark some elements by the colour of the selection and by their frames, and no others."""
        with self.server.atomic():
            for element in self.marked:
                for node, color, layer in self._of_elements.get(self._shown_by(element), ()):
                    if color is None:
                        node.visible = layer in self._shown
                    else:
                        node.color = color
            self.marked = frozenset(elements)
            for element in self.marked:
                for node, color, _ in self._of_elements.get(self._shown_by(element), ()):
                    if color is None:
                        node.visible = True
                    else:
                        node.color = MARKED

    def _shown_by(self, element: str) -> str:
        """The element that is drawn for one: of a joint that is not drawn, and of a frame of a beam's tip, the body."""
        section, _, name = element.partition("/")
        if element in self._of_elements or section != "bodies":
            return element
        return f"bodies/{name.partition('/')[0]}"

    def _belongs(self, element: str, node: Any, layer: str, color: Color | None = None) -> None:
        """Record the element that a node draws; `color` is the node's own, None for nodes shown only as marks."""
        if element:
            self._of_elements.setdefault(element, []).append(_Marked(node, color, layer))
            if self._on_pick is not None and hasattr(node, "on_click"):
                node.on_click(_picking(self._on_pick, element))

    def _see_through(self) -> None:
        """Let frames, which mostly lie within bodies, be seen through them."""
        for layer in _OPAQUE:
            for node in self._nodes[layer]:
                node.opacity = SEE_THROUGH if "frames" in self._shown else None

    # Nodes.

    def _link(self, index: int) -> str:
        return f"{_ROOT}/link{index}" if index != BASE else f"{_ROOT}/world"

    def _kept(self, layer: str, node: Any) -> Any:
        node.visible = layer in self._shown
        self._nodes[layer].append(node)
        return node

    def _add_mesh(self, part: DrawnPart, name: str) -> None:
        node = self.server.scene.add_mesh_simple(
            name,
            on_grid(part.mesh.vertices, self.drawing.size) if part.kind == "visuals" else part.mesh.vertices,
            part.mesh.faces,
            color=part.color,
            opacity=SEE_THROUGH if part.kind == "inertias" else None,
            cast_shadow=part.kind != "inertias",
        )
        self._kept(part.kind, node)
        self._belongs(part.element, node, part.kind, part.color)

    def _add_tube(self, layer: str, drawn: DrawnBeam | DrawnConnector, sweep: Sweep) -> Any:
        """A tube with a bone a station: browsers move bones at once with nodes, but vertices some pictures later.

        It takes the place of a tube of the drawing before, if there was one: viser 1.1's page breaks down where a mesh
        with bones is removed (its clean-up looks for a node that is gone), but not where it is replaced.
        """
        mesh, stations = tube(drawn.outline, *sweep), tube_stations(len(sweep.points), len(drawn.outline))
        node = self.server.scene.add_mesh_skinned(
            f"{_TUBES}/{self._tubes}",
            mesh.vertices,
            mesh.faces,
            color=drawn.color,
            bone_wxyzs=self._rotation.from_matrix(sweep.axes).wxyz,
            bone_positions=sweep.points,
            skin_weights=np.eye(len(sweep.points))[stations],
        )
        self._tubes += 1
        self._belongs(drawn.element, node, layer, drawn.color)
        return self._kept(layer, node)

    def _hide_spare_tubes(self) -> None:
        """Hide the tubes of the previous drawing that this one does not reuse."""
        for i in count(self._tubes):
            spare = self.server.scene.get_handle_by_name(f"{_TUBES}/{i}")
            if spare is None:
                return
            spare.visible = False

    def _add_frames(self) -> None:
        size = _TRIAD * self.drawing.size
        for triad in self.drawing.triads:
            name = f"{self._link(triad.link)}/frames/{_node(triad.name)}"
            axes = self._kept(
                "frames",
                self.server.scene.add_frame(
                    name,
                    axes_length=size,
                    axes_radius=size / 20,
                    position=triad.position,
                    wxyz=self._rotation.from_matrix(triad.rotation).wxyz,
                ),
            )
            self._belongs(triad.element, axes, "frames")
            label = self.server.scene.add_label(
                f"{self._link(triad.link)}/labels/{_node(triad.name)}", triad.name, position=triad.position
            )
            self._kept("labels", label)
            self._belongs(triad.element, label, "labels")

    def _add_ground(self) -> None:
        drawing, scene = self.drawing, self.server.scene
        cell, cells = cell_of(drawing)
        self._kept(
            "ground",
            scene.add_grid(
                f"{_ROOT}/ground",
                2 * cells * cell,
                2 * cells * cell,
                cell_size=cell,
                section_size=cells * cell,
                fade_distance=10 * drawing.size,
            ),
        )
        arrow = gravity_arrow(drawing)
        if arrow is not None:
            length = float(np.linalg.norm(arrow[1] - arrow[0]))
            self._kept(
                "ground",
                scene.add_arrows(
                    f"{_ROOT}/gravity",
                    arrow[None],
                    np.array(GRAVITY_COLOR),
                    shaft_radius=length / 25,
                    head_radius=length / 10,
                    head_length=length / 4,
                ),
            )

    def _aim(self) -> None:
        camera, initial = Camera.of(self.drawing), self.server.initial_camera
        initial.position, initial.look_at, initial.up = camera.position, camera.target, camera.up
        initial.fov, initial.near, initial.far = camera.fov, 1e-3 * self.drawing.size, _SEEN * self.drawing.size


def _picking(on_pick: Callable[[str], None], element: str) -> Callable[[Any], None]:
    """The click handler of a node of an element."""
    return lambda _: on_pick(element)


def _node(name: str) -> str:
    """A name within one level of viser's tree of nodes."""
    return name.replace("/", ".")
