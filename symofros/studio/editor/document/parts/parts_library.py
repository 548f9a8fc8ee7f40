"""The parts that a workspace keeps: native files in its folder `parts`, which other documents can also include."""

from __future__ import annotations

from typing import Any

from symofros.description.yaml import YamlFault
from symofros.studio.editor.document.parts.parts import extracted
from symofros.studio.editor.document.workspace import FileError, Workspace, identifier, read_text, write
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.editing.yaml_rendering import block
from symofros.studio.editor.editing.yaml_spans import yaml_text_of

Json = dict[str, Any]

FOLDER = "parts"
MAX_PARTS = 200


class Library:
    """The parts of one workspace."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace

    def listed(self) -> list[Json]:
        """Name, file and bodies of each part; files that are none can be opened and mended like any other."""
        parts = []
        for file in sorted((self.workspace.root / FOLDER).glob("*.yaml"))[:MAX_PARTS]:
            try:
                bodies = list(self.part(file.stem)["bodies"])
            except (FileError, YamlFault, EditError):
                continue
            parts.append({"name": file.stem, "path": self.workspace.shown(file), "bodies": bodies})
        return parts

    def part(self, name: str) -> Json:
        """The data of a part.

        Raises:
            FileError: There is none of that name.
            YamlFault: Its file is not YAML.
            EditError: It has no bodies.
        """
        text, _ = read_text(self.workspace.inside(f"{FOLDER}/{name}.yaml"))
        data = yaml_text_of(text).data
        if not isinstance(data, dict) or not isinstance(data.get("bodies"), dict):
            raise EditError(f"'{name[:50]}' is not a part", "no bodies", "a part has bodies", "choose another")
        return data

    def keep(self, name: str, data: Any, bodies: Any) -> None:
        """Keep some bodies of a document.

        Raises:
            EditError: They can't be a part.
            FileError: There is a part of that name; it is not overwritten.
        """
        if not isinstance(bodies, list) or not all(isinstance(item, str) for item in bodies):
            raise EditError("bodies of the part", f"{bodies!r:.100}", "a list of names", "choose some")
        file = self.workspace.inside(f"{FOLDER}/{identifier(name)}.yaml")
        if file.exists():
            raise FileError(
                f"a part '{file.stem}' is there already",
                file.stem,
                "parts have names of their own",
                "choose another name",
            )
        part = extracted(data, bodies)
        file.parent.mkdir(exist_ok=True)
        write(file, "\n".join([*block(part, (), 0), ""]))
