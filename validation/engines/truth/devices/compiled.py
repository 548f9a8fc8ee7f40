"""What MuJoCo's compiler makes of models: inertias that it repairs, solids of triangles, constants, keys.

A body's inertia that breaks A + B >= C becomes the mean of the three (XML reference, compiler/balanceinertia). Of a
tetrahedron of the density 1000 at 0 and at a, b, c on the axes, the volume is a b c / 6 and its centre at a quarter of
each. With the inertia M of a coordinate, 1 / M is what a unit of force makes of it (invweight0), gear / M an actuator's
(acc0).
"""

from __future__ import annotations

from ..arithmetic import exact
from .device import Device, body, model, slide

_MOMENTS = 'diaginertia="0.125 0.125 0.125"'


def _of(about: str, text: str, read: str, *values: float) -> Device:
    """A field that the state has no part in."""
    return Device(about, text, "", read, lambda s: exact(values) + 0 * s.v[0])


def _compiler(attributes: str, read: str, *values: float, world: str = "", moments: str = _MOMENTS) -> Device:
    """A model with attributes of the compiler."""
    text = model(world or slide().replace(_MOMENTS, moments), head=f"<compiler {attributes}/>")
    return _of(f"compiler {attributes}", text, read, *values)


def _inertias() -> dict[str, Device]:
    solid = '<geom type="box" size="0.25 0.5 1" density="16" group="{}" contype="0" conaffinity="0"/>'
    two = f'<body><joint type="slide"/>{solid.format(1)}{solid.format(3)}</body>'
    return {
        "compiled_balanced_inertia": _compiler(
            'balanceinertia="true"', "body_inertia[3:]", 0.5, 0.5, 0.5, moments='diaginertia="0.125 0.25 1.125"'
        ),
        "compiled_bound_mass": _compiler('boundmass="3"', "body_mass[1:]", 3.0),
        "compiled_bound_inertia": _compiler(
            'boundinertia="0.25"', "body_inertia[3:]", 0.5, 0.25, 0.375, moments='diaginertia="0.5 0.125 0.375"'
        ),
        "compiled_of_groups": _compiler('inertiagrouprange="0 2"', "body_mass[1:]", 16.0, world=two),
        "compiled_without_visuals": _compiler('discardvisual="true"', "body_mass[1:]", 32.0, world=two),
    }


def _meshes() -> dict[str, Device]:
    def mesh(inertia: str, scale: str = "") -> str:
        stated = f'<mesh name="t" vertex="0 0 0  1 0 0  0 2 0  0 0 3" inertia="{inertia}" {scale}/>'
        return model(
            '<body><joint type="slide"/><geom type="mesh" mesh="t" density="1000"/></body>',
            head=f"<asset>{stated}</asset>",
        )

    made = {}
    for inertia in ("exact", "convex"):
        made[f"compiled_mesh_{inertia}_mass"] = _of(f"mesh inertia {inertia}", mesh(inertia), "body_mass[1:]", 1000.0)
        made[f"compiled_mesh_{inertia}_centre"] = _of(
            f"mesh inertia {inertia}", mesh(inertia), "body_ipos[3:]", 0.25, 0.5, 0.75
        )
    scaled = mesh("exact", 'scale="2 1 0.5"')
    return made | {
        "compiled_mesh_scaled_centre": _of("mesh scale", scaled, "body_ipos[3:]", 0.5, 0.5, 0.375),
        "compiled_mesh_scaled_mass": _of("mesh scale", scaled, "body_mass[1:]", 1000.0),
    }


def _constants() -> dict[str, Device]:
    """Constants of a slide of 2.5 kg with its rotor, a tendon of twice its coordinate and a motor of gear 3."""
    tendon = '<tendon><fixed name="t"><joint joint="j" coef="2"/></fixed></tendon>'
    heavy = slide('armature="0.5" ref="0.25"')
    text = model(heavy, f'{tendon}<actuator><motor joint="j" gear="3"/></actuator>')
    values = {
        "dof_M0": 2.5,
        "dof_invweight0": 0.4,
        "tendon_invweight0": 1.6,
        "tendon_length0": 0.5,
        "actuator_acc0": 1.2,
        "qpos0": 0.25,
    }
    made = {f"compiled_{name}": _of(name, text, name, x) for name, x in values.items()}
    pair = model(body('<joint type="slide"/>', body('<joint type="slide"/>').replace('name="b"', "")))
    return made | {"compiled_subtree_masses": _of("body_subtreemass", pair, "body_subtreemass", 4.0, 4.0, 2.0)}


def _keys() -> dict[str, Device]:
    key = '<keyframe><key time="0.5" qpos="0.75" qvel="-0.25" act="0.125" ctrl="-1.5"/></keyframe>'
    filtered = '<actuator><general joint="j" dyntype="filter" dynprm="0.5"/></actuator>'
    text = model(slide(), filtered + key)
    values = {"key_qpos": 0.75, "key_qvel": -0.25, "key_act": 0.125, "key_ctrl": -1.5, "key_time": 0.5}
    return {f"compiled_{name}": _of("keyframe/key", text, name, x) for name, x in values.items()}


DEVICES = _inertias() | _meshes() | _constants() | _keys()
