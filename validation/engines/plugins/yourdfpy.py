"""yourdfpy: a reader of URDF, with the poses that its graph of a scene has; no mechanics."""

from __future__ import annotations

from ..interface import Convention, Tree, Unsupported
from .writing.numbering import numbered
from .writing.source import Source, SourcePlugin, ways_of

_OF = "value = [{} for j in moving]"
_BODY = """value = []
for one in (robot.link_map[name].inertial for name in links):
    T = np.eye(4) if one is None or one.origin is None else one.origin
    I = np.zeros((3, 3)) if one is None or one.inertia is None else T[:3, :3] @ one.inertia @ T[:3, :3].T
    m = float(one.mass) if one and one.mass else 0.0
    value.append([m, *(m * T[:3, 3]), *I[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]])"""
WAYS = ways_of(f"""
== sizes | num_dofs | value = [robot.num_dofs] * 2
== link_poses | get_transform
robot.update_cfg({{j.name: x for j, x in zip(moving, q)}})
value = [[*T[:3, 3], *T[:3, :3].flat] for T in (robot.get_transform(name) for name in links)]
== link_bodies | link_map, inertial | {_BODY}
== joint_limits | limit.lower, upper
def bound(x): return 0.0 if x is None else x
{_OF.format("[bound(j.limit.lower), bound(j.limit.upper)]")}
== coupled_coefficients | mimic.multiplier, offset
value = [[one.offset, one.multiplier] for one in (j.mimic for j in robot.joint_map.values()) if one]
== joint_speed_limits | limit.velocity | {_OF.format("j.limit.velocity")}
== joint_force_limits | limit.effort | {_OF.format("j.limit.effort")}
== joint_dampings | dynamics.damping | {_OF.format("(j.dynamics and j.dynamics.damping) or 0.0")}
== joint_frictions | dynamics.friction | {_OF.format("(j.dynamics and j.dynamics.friction) or 0.0")}
""")
_KINDS = {("revolute", ""): "angle", ("revolute", "unbounded"): "angle", ("prismatic", ""): "length"}


def write(tree: Tree) -> Source | Unsupported:
    """It builds nothing."""
    return Unsupported("reads URDF alone", offered=False)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has it read a file, or what it has written of one."""
    made = numbered(tree, _KINDS)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    moving = [link.name for link, own in zip(tree.links, slots, strict=True) if own]
    again = ("robot = yourdfpy.URDF.load(io.BytesIO(robot.write_xml_string()))",) if form == "urdf written" else ()
    lines = (
        *("import io", "import numpy as np", "import yourdfpy"),
        f"robot = yourdfpy.URDF.load(io.BytesIO({text.encode()!r}))",
        *again,
        f"moving = [next(j for j in robot.joint_map.values() if j.child == name) for name in {moving!r}]",
    )
    return Source(lines, slots, nq, nv, {"links": (f"links = {[link.name for link in tree.links]!r}",)})


PLUGIN = SourcePlugin(
    name="yourdfpy",
    package="yourdfpy",
    extra="yourdfpy",
    conventions=(
        Convention("order of joints", "of the file; found by the links after them"),
        Convention("poses", "from the base link"),
        Convention("what is left out", "None, but for the limits' defaults"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
    formats=("urdf", "urdf written"),
    write_reading=write_reading,
)
