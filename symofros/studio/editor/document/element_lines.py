"""The lines of a text that define each element: bodies, joints, frames, links; blocks and wires."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator
from typing import Any

from symofros.studio.editor.editing.data_edits import Path
from symofros.studio.editor.editing.yaml_spans import YamlText


def element_lines(source: YamlText, drawn: Iterable[dict[str, Any]]) -> dict[str, tuple[int, int]]:
    """First and last line of each element, counted from 1; of what the text itself does not define, nothing.

    Args:
        source: Text of the document.
        drawn: Blocks and links as the page has them, each with its `id` and `path`. Frames of bodies are named by their
            path.
    """
    starts = source.line_starts
    lines: dict[str, tuple[int, int]] = {}
    paths = [(item["id"], tuple(item["path"])) for item in drawn]
    for name, path in (*paths, *_frames(source)):
        node = source.node(path) if path else None
        if node is not None:
            begin = node.start if node.key_start < 0 else node.key_start
            end = source.end(node)
            lines[name] = bisect_right(starts, begin), bisect_right(starts, max(begin, end - 1))
    return lines


def _frames(source: YamlText) -> Iterator[tuple[str, Path]]:
    bodies = source.node(("bodies",))
    for body, entry in bodies.value.items() if bodies is not None and isinstance(bodies.value, dict) else ():
        frames = entry.value.get("frames") if isinstance(entry.value, dict) else None
        for frame in frames.value if frames is not None and isinstance(frames.value, dict) else ():
            yield f"bodies/{body}/frames/{frame}", ("bodies", body, "frames", frame)
