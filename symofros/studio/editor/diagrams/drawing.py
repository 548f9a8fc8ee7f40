"""What is drawn of a diagram: blocks with their ports, and wires between them; also of one that is not whole."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from symofros.diagrams.block import Port
from symofros.diagrams.diagram import INSIDE, Diagram
from symofros.diagrams.wiring import Draft, Source
from symofros.errors import DescriptionError
from symofros.studio.editor.diagrams.palette import group_of
from symofros.studio.editor.editing.data_edits import conditions_of

Json = dict[str, Any]

# Characters that are drawn of a comment; a longer one is refused, and is here to be mended.
_MOST_DRAWN = 2000


class Drawing:
    """The blocks and wires of a document.

    Args:
        data: Document as plain data, whatever is in it.
        read: As much of the diagram as could be read.
        drafted: As much of it as holds together.
        loops: Signals along each algebraic loop.
        problems: Problems as the page shows them.
    """

    def __init__(
        self,
        data: Any,
        read: Diagram | None,
        drafted: Draft | None,
        loops: Sequence[Sequence[Source]],
        problems: Sequence[Json],
    ) -> None:
        self.data = data if isinstance(data, dict) else {}
        self.read, self.drafted = read, drafted
        self.loops = {pair for loop in loops for pair in zip(loop, loop[1:], strict=False)}
        self.problems = problems
        self.nodes: dict[str, Json] = {}
        self.wires: list[Json] = []

    def as_json(self) -> Json:
        """`nodes`, `wires`, and what is known of the models."""
        for name, entry in self._section("models").items():
            self._node("models", name, "model", "initialisation", str(_dict(entry).get("file", "")))
        for name, entry in self._section("blocks").items():
            self._block(name, _dict(entry))
        for name, entry in self._section("parts").items():
            self._part(name, _dict(entry))
        for name, entry in self._section("blocks").items():
            for port, source in _dict(_dict(entry).get("inputs")).items():
                self._wire(source, f"blocks/{name}", port, ["blocks", name, "inputs", port])
        for name, entry in self._section("parts").items():
            for inlet, source in _dict(_dict(entry).get("inputs")).items():
                self._wire(source, f"parts/{name}", inlet, ["parts", name, "inputs", inlet])
            for signal, source in conditions_of(entry).items():
                self._wire(source, f"parts/{name}", signal, ["parts", name, "condition", signal])
        for target, source in self._section("wires").items():
            self._wire(source, *self._target(target), ["wires", target])
        for problem in self.problems:
            if problem["node"] in self.nodes:
                self.nodes[problem["node"]]["problems"] += 1
        return {"nodes": list(self.nodes.values()), "wires": self.wires, "models": self._models()}

    def _node(self, section: str, name: str, kind: str, group: str, note: str) -> Json:
        node = {
            "id": f"{section}/{name}",
            "kind": kind,
            "group": group,
            "title": name,
            "note": note,
            "path": [section, name],
            "period": None,
            "inputs": [],
            "outputs": [],
            "problems": 0,
        }
        return self.nodes.setdefault(str(node["id"]), node)

    def _block(self, name: str, entry: Json) -> None:
        kind = str(entry.get("kind", "?"))
        model = entry.get("model")
        node = self._node("blocks", name, kind, group_of(kind), model if isinstance(model, str) else "")
        period = entry.get("period")
        node["period"] = period if type(period) in (int, float) else None
        if kind == "comment":
            node["note"], node["heading"] = str(entry.get("text", ""))[:_MOST_DRAWN], entry.get("heading") is True
        ports = self.drafted.ports.get(name) if self.drafted else None
        given = list(_dict(entry.get("inputs")))
        if ports is not None:
            node["inputs"] = [_port(port) for port in ports.inputs]
            node["outputs"] = [_port(port) for port in ports.outputs]
        known = {port["name"] for port in node["inputs"]}
        node["inputs"] += [_port(Port(port, None)) for port in given if port not in known]
        faults = {problem["port"]: problem for problem in self.problems if problem["node"] == node["id"]}
        for port in node["inputs"]:
            fault = faults.get(port["name"])
            port["fault"] = f"{fault['found']}; {fault['rule']}" if fault else ""

    def _part(self, name: str, entry: Json) -> None:
        file = entry.get("file")
        node = self._node("parts", name, "part", "part", file if isinstance(file, str) else "inline")
        part = self.read.parts.get(name) if self.read else None
        inlets = [*(part.diagram.inlets if part else ()), *_dict(entry.get("inputs")), *conditions_of(entry)]
        node["inputs"] = [_port(Port(inlet, None, default=0)) for inlet in dict.fromkeys(inlets)]
        node["outputs"] = [_port(Port(outlet, None)) for outlet in (part.diagram.outlets if part else ())]

    def _target(self, text: str) -> tuple[str, str]:
        """The node and the port of an input that `wires` names."""
        block, _, port = text.rpartition(".")
        part, inside, rest = block.partition(INSIDE)
        if not inside:
            return f"blocks/{block}", port
        return f"parts/{part}", self._inside(f"parts/{part}", "inputs", f"{rest}.{port}")

    def _inside(self, node: str, side: str, name: str) -> str:
        """A port of a block inside a part, which the part shows."""
        if node in self.nodes and name not in {port["name"] for port in self.nodes[node][side]}:
            self.nodes[node][side].append(_port(Port(name, None, default=0)))
        return name

    def _wire(self, source: Any, node: str, port: str, path: list[str]) -> None:
        end = self._source(source) if isinstance(source, str) else None
        if end is None or node not in self.nodes:
            return
        start = self.nodes[end[0]]
        known = {item["name"] for item in start["outputs"]}
        if end[1] not in known:  # Of a block that could not be read, or a name that it lacks: drawn all the same.
            start["outputs"].append(_port(Port(end[1], None)))
        fed = next((item for item in self.nodes[node]["inputs"] if item["name"] == port), None)
        self.wires.append(
            {
                "id": "/".join(path),
                "source": end[0],
                "source_port": end[1],
                "target": node,
                "target_port": port,
                "path": path,
                "period": start["period"],
                "fault": fed.get("fault", "") if fed else "",
                "loop": self._closes(end, node),
            }
        )

    def _closes(self, source: tuple[str, str], target: str) -> bool:
        """Whether a wire is part of an algebraic loop."""
        start = (source[0].partition("/")[2], source[1])
        return any(a == start and f"blocks/{b[0]}" == target for a, b in self.loops)

    def _source(self, text: str) -> tuple[str, str] | None:
        """The node and the output named by a source; None if there is no such node."""
        block, _, port = text.rpartition(".") if "." in text else (text, "", "")
        part, inside, rest = block.partition(INSIDE)
        if inside:
            node = f"parts/{part}"
            return (node, self._inside(node, "outputs", f"{rest}.{port}")) if node in self.nodes else None
        for node in (f"blocks/{block}", f"parts/{block}"):
            if node in self.nodes:
                outputs = self.nodes[node]["outputs"]
                return node, port or (outputs[0]["name"] if outputs else "?")
        return None

    def _models(self) -> dict[str, Json]:
        """Names in each model that forms choose from."""
        known: dict[str, Json] = {}
        if self.read is None or self.drafted is None:
            return known
        for name in self.read.models:
            try:
                record = self.drafted.models.record(name)
            except DescriptionError:
                continue
            known[name] = {
                "frames": list(record.frame_names),
                "q": list(record.q_names),
                "v": list(record.v_names),
                "parameters": list(record.par_names),
            }
        return known

    def _section(self, key: str) -> Json:
        return _dict(self.data.get(key))


def _port(port: Port) -> Json:
    return {
        "name": port.name,
        "shape": None if port.shape is None else list(port.shape),
        "unit": port.unit,
        "required": port.default is None,
        "fault": "",
    }


def _dict(value: Any) -> Json:
    return value if isinstance(value, dict) else {}
