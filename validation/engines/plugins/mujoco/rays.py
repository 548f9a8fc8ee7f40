"""MuJoCo's rays: several at a time, and those that meet a box of triangles, of a skin or of a field of heights."""

from __future__ import annotations

from itertools import product

from ...truth.devices import DEVICES
from ...truth.geometry.shapes import BEYOND, SIDES, WITHIN
from ..writing.source import Way

_CORNERS = [[sign * side for sign, side in zip(signs, SIDES, strict=True)] for signs in product((-1, 1), repeat=3)]
# Two triangles of each side, by numbers of corners.
_FACES = [
    *([0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5]),
    *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
]
_LINE = (
    "R = np.zeros(9)\nmj.mju_quat2Mat(R, q)\nR = R.reshape(3, 3)\n"
    f"o, w = tau + {list(BEYOND)}, a + R @ {list(WITHIN)}\nu = (w - o) / np.linalg.norm(w - o)\n"
)
_X, _Y, _Z = SIDES
_MESH = f'<mesh name="s" vertex="{" ".join(f"{x}" for corner in _CORNERS for x in corner)}"/>'
_HEIGHTS = f'<hfield name="s" nrow="2" ncol="2" size="{_X} {_Y} {_Z} {_Z}"/>'
_BOX = f'type="box" size="{_X} {_Y} {_Z}"'
_SKIN = (
    f"faces, corners = np.array({_FACES}, np.int32), np.float32(a + {_CORNERS} @ R.T)\n"
    "value = [mj.mju_raySkin(12, 8, faces, corners, START, u, np.zeros(1, np.int32))]"
)
# Singles of a skin's corners.
_SINGLE = 1e-5


def _placed(asset: str, geom: str, call: str) -> str:
    """A geom at (R, a), its model compiled for each call."""
    world = f'<worldbody><body mocap="true"><geom {geom}/></body></worldbody>'
    return (
        f"{_LINE}m = mj.MjModel.from_xml_string('<mujoco><asset>{asset}</asset>{world}</mujoco>')\n"
        "m.hfield_data[:] = 1\nd = mj.MjData(m)\nd.mocap_pos[:], d.mocap_quat[:] = [a], [q]\nmj.mj_forward(m, d)\n"
        f"{call}"
    )


_SEVERAL = (
    "lengths, hit = np.zeros(2), np.zeros(2, np.int32)\n"
    "mj.mj_multiRay(m, d, START, np.r_[2 * u, u], None, 1, -1, hit, lengths, None, 2, 100.0)\nvalue = lengths[1:]"
)
_CODES = {
    "mj_multiRay": _placed("", _BOX, _SEVERAL),
    "mj_rayMesh": _placed(_MESH, 'type="mesh" mesh="s"', "value = [mj.mj_rayMesh(m, d, 0, START, u)]"),
    "mj_rayHfield": _placed(_HEIGHTS, 'type="hfield" hfield="s"', "value = [mj.mj_rayHfield(m, d, 0, START, u)]"),
    "mju_raySkin": _LINE + _SKIN,
}
WAYS = {
    f"ray_{way}_box:{call}": Way(call, code.replace("START", start), _SINGLE if "Skin" in call else 0.0)
    for call, code in _CODES.items()
    for way, start in (("to", "o"), ("out_of", "w"))
    # Between its heights and its base a field has a face of its own.
    if (way, call) != ("out_of", "mj_rayHfield")
}
# Whether a point is within a site, by the function and not by its sensor.
WITHIN_SITES = {
    f"{name}:mj_insideSite": Way(
        "mj_insideSite",
        f"m = compiled('''{device.model}''')\nd = mj.MjData(m)\nmj.mj_forward(m, d)\n"
        "value = [mj.mj_insideSite(m, d, 0, v)]",
    )
    for name, device in DEVICES["sensors of all kinds"].items()
    if name.startswith("sensed_inside")
}
