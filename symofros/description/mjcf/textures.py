"""Textures of the materials of an MJCF model: the color of those that MuJoCo makes, the picture of those from files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.description.mjcf.files import Folder
from symofros.description.mjcf.meshes import asset_name, asset_path, compiler_settings, defaults
from symofros.description.urdf.values import finite_numbers
from symofros.description.xml_nodes import Element


@dataclass(frozen=True)
class Texture:
    """Factor of a material's color.

    Attributes:
        color: Mean of what MuJoCo makes (3), 0 to 1; ones for a picture.
        file: Path of a picture; "" where there is none.
        is_flat: Whether a mesh's places in it are those that its file states: a cube's are not.
    """

    color: Array
    file: str = ""
    is_flat: bool = False


def textures_of(folder: Folder, stated: Element) -> dict[str, Texture]:
    """Material -> its texture, of those that have one that may be read.

    Args:
        folder: Folder of the model.
        stated: The document as it was written.
    """
    settings = compiler_settings(stated)
    base = settings.get("texturedir", settings.get("assetdir", ""))
    classes = defaults(stated, "material")
    assets = list(stated.all("asset"))
    known = {asset_name(each): each for asset in assets for each in asset.all("texture")}
    textures: dict[str, Texture] = {}
    for material in (each for asset in assets for each in asset.all("material")):
        attributes = classes.get(material.attributes.get("class", "main"), {}) | material.attributes
        layers = [layer.attributes for layer in material.all("layer") if layer.attributes.get("role") == "rgb"]
        named = layers[0].get("texture") if layers else attributes.get("texture")
        element = known.get(named or "")
        texture = None if element is None else _texture(folder, element.attributes, base, settings)
        if texture is not None:
            textures[asset_name(material)] = texture
    return textures


def _texture(folder: Folder, stated: dict[str, str], base: str, settings: dict[str, str]) -> Texture | None:
    """A texture by its attributes; None where nothing can be drawn of it."""
    builtin, file = stated.get("builtin", "none"), stated.get("file")
    if builtin in _SHARES:
        colors = (
            finite_numbers(stated.get("rgb1", "0.8 0.8 0.8"), 3),
            finite_numbers(stated.get("rgb2", "0.5 0.5 0.5"), 3),
        )
        if colors[0] is None or colors[1] is None:
            return None
        share = _SHARES[builtin]
        mean = (1.0 - share) * np.array(colors[0]) + share * np.array(colors[1])
        return Texture(np.clip(mean, 0.0, 1.0))
    path = folder.seen(asset_path(file, base, settings)) if file is not None else ""
    return Texture(np.ones(3), path, stated.get("type", "cube") == "2d") if path else None


# Share of rgb2 in the color of what MuJoCo makes, on all sides of a cube but its lower one.
_SHARES = {"flat": 0.0, "gradient": 0.5, "checker": 0.5}
