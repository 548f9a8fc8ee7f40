"""A document as blocks and wires; also of one that is not a mechanism yet: what does not fit is left out."""

from __future__ import annotations

from typing import Any

from symofros.description import DIRECTIONS, STRAINS, WORLD
from symofros.description.yaml import default_joint_name

GROUND = "world"  # The id of the block of the ground, whatever the body without a joint is called.
# Ports that no frame names: where a body's joint arrives, and the body frame.
ROOT, ORIGIN = "/root", ""

# Section of what links two frames -> kind of its wires.
_LINKS = {"closures": "closure", "connections": "connection", "contacts": "contact"}

Block = dict[str, Any]


def diagram(data: Any) -> dict[str, list[Block]]:
    """The blocks and wires of a document.

    Args:
        data: The document as plain data, whatever is in it.

    Returns:
        `nodes` and `edges` (docs/editor.md); each wire's ends are ports of blocks that exist.
    """
    return _Diagram(data if isinstance(data, dict) else {}).drawn()


class _Diagram:
    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data
        self.bodies = {name: _dict(body) for name, body in _dict(data.get("bodies")).items()}
        bases = [name for name, body in self.bodies.items() if "joint" not in body]
        self.base = bases[0] if bases else WORLD
        self.nodes: dict[str, Block] = {}
        self.edges: list[Block] = []

    def drawn(self) -> dict[str, list[Block]]:
        self.ground()
        for name, body in self.bodies.items():
            if name != self.base:
                self.body(name, body)
        for name, body in self.bodies.items():
            if isinstance(body.get("joint"), dict):
                self.joint(name, body["joint"])
        for section, kind in _LINKS.items():
            for name, entry in _dict(self.data.get(section)).items():
                self.link(section, name, _dict(entry), kind)
        for name, entry in _dict(self.data.get("nonholonomic")).items():
            self.condition(name, _dict(entry))
        return {"nodes": list(self.nodes.values()), "edges": self.edges}

    def ground(self) -> None:
        body = self.bodies.get(self.base, {})
        frames = _dict(body.get("frames"))
        path = ["bodies", self.base] if self.base in self.bodies else ["system"]
        title = self.base if self.base in self.bodies else "world"
        self.block(GROUND, "base", title, "ground", path, [ORIGIN, *frames])

    def body(self, name: str, body: Block) -> None:
        beam = body.get("beam")
        frames = [*_dict(body.get("frames"))]
        if isinstance(beam, dict):
            modes = [beam.get(key, 0) for key in STRAINS if key in beam or key in DIRECTIONS]
            kind, subtitle = "beam", f"{beam.get('family', 'spline')}, {'+'.join(map(str, modes))} modes"
            frames = frames or ["tip"]
        elif isinstance(body.get("solid"), dict):
            kind, subtitle = "rigid_body", str(body["solid"].get("shape", "?"))
        elif isinstance(body.get("inertia"), dict):
            kind, subtitle = "rigid_body", f"mass {body['inertia'].get('mass', '?')}"
        else:
            kind, subtitle = "massless_body", "massless"
        self.block(f"bodies/{name}", kind, name, subtitle, ["bodies", name], [ROOT, ORIGIN, *frames])

    def block(self, key: str, kind: str, title: str, subtitle: str, path: list[str], ports: list[str]) -> None:
        kinds = {ROOT: "root", ORIGIN: "origin"}  # Any other is a frame.
        self.nodes[key] = {
            "id": key,
            "kind": kind,
            "title": title,
            "subtitle": subtitle,
            "path": path,
            "ports": [{"name": port, "kind": kinds.get(port, "frame")} for port in dict.fromkeys(ports)],
            "problems": 0,
        }

    def joint(self, name: str, joint: Block) -> None:
        source = self.port(joint.get("parent", WORLD), joint.get("frame"))
        target = f"bodies/{name}"
        if source is None or target not in self.nodes:
            return
        kind = joint.get("kind", "?")
        label = f"{joint.get('name', default_joint_name(name))}: {kind}"
        self.wire(f"bodies/{name}/joint", "joint", source, (target, ROOT), ["bodies", name, "joint"], label)
        self.edges[-1]["joint"] = kind

    def link(self, section: str, name: str, entry: Block, kind: str) -> None:
        ends = [self.anchor(_dict(entry.get(side))) for side in ("first", "second")]
        if ends[0] is not None and ends[1] is not None:
            label = f"{name}: rod" if kind == "closure" and "length" in entry else name
            self.wire(f"{section}/{name}", kind, ends[0], ends[1], [section, name], label)

    def condition(self, name: str, entry: Block) -> None:
        """Name of the block of a condition on speeds; a condition at a frame is wired to the frame."""
        kind = next((key for key in ("knife_edge", "rolling", "coefficients") if key in entry), "coefficients")
        key = f"nonholonomic/{name}"
        self.block(key, "nonholonomic", name, kind, ["nonholonomic", name], [ORIGIN])
        end = self.anchor(_dict(entry.get(kind))) if kind != "coefficients" else None
        if end is not None:
            self.wire(f"{key}/{kind}", "constraint", end, (key, ORIGIN), ["nonholonomic", name], name)

    def anchor(self, anchor: Block) -> tuple[str, str] | None:
        return self.port(anchor.get("body"), anchor.get("frame"))

    def port(self, body: Any, frame: Any) -> tuple[str, str] | None:
        """A frame's port; the body's own where the frame does not exist."""
        key = GROUND if body in (WORLD, self.base) else f"bodies/{body}"
        if key not in self.nodes:
            return None
        known = {port["name"] for port in self.nodes[key]["ports"]}
        return key, frame if isinstance(frame, str) and frame in known else ORIGIN

    def wire(
        self, key: str, kind: str, source: tuple[str, str], target: tuple[str, str], path: list[str], label: str
    ) -> None:
        self.edges.append(
            {
                "id": key,
                "kind": kind,
                "source": source[0],
                "source_port": source[1],
                "target": target[0],
                "target_port": target[1],
                "path": path,
                "label": label,
            }
        )


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}
