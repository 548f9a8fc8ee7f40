"""Small MJCF models, each with something that an importer can get wrong."""

from __future__ import annotations

from pathlib import Path

from ruamel.yaml import YAML

# Name -> what stands inside of <mujoco>.
MODELS: dict[str, str] = YAML(typ="safe").load(Path(__file__).with_suffix(".yaml"))


def document(body: str) -> str:
    """A whole file."""
    return f'<mujoco model="test">{body}</mujoco>'
