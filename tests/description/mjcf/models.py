"""Small MJCF models, each with something that an importer can get wrong."""

from __future__ import annotations

from pathlib import Path

from ruamel.yaml import YAML

# Name -> what stands inside of <mujoco>.
MODELS: dict[str, str] = YAML(typ="safe").load(Path(__file__).with_suffix(".yaml"))


def document(body: str) -> str:
    """A whole file."""
    return f'<mujoco model="test">{body}</mujoco>'


PENDULUM = '<body name="a"><joint name="q" axis="0 1 0"/><geom size="0.1" pos="1 0 0"/></body>'
