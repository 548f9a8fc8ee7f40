"""What MuJoCo's own readers make of a file, as a description: the MJCF that MuJoCo writes of it."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco

import symofros as sf

from .urdf import bare


def description(path: Path, floating_base: bool) -> sf.System:
    """A file as MuJoCo reads it.

    Raises:
        ValueError: MuJoCo refuses the file.
    """
    is_urdf = path.suffix.lower() == ".urdf"
    spec = mujoco.MjSpec.from_string(bare(path.read_bytes())) if is_urdf else mujoco.MjSpec.from_file(str(path))
    if floating_base:
        spec.worldbody.first_body().add_freejoint()
    spec.compile()
    with TemporaryDirectory(prefix="symofros-diff-") as folder:
        written = Path(folder) / f"{path.stem}.xml"
        written.write_text(spec.to_xml(), encoding="utf-8")
        return sf.load(written, dissipation="all", waive=("massless_tip",))
