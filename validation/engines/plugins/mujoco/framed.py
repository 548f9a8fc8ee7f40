"""What MuJoCo says of frames that stand off links' origins: sites, cameras and geoms, by fields, functions, sensors."""

from __future__ import annotations

from ...truth.sensed import MAGNETIC
from ..writing.source import Way
from .forces import QV, QVA, Q

# Beside each site `o0`, `o1` ... an object of the same name and place, and sensors that read it.
_MADE = """
import re
def made(text):
    names = re.findall(r'<site name="(o\\d+)"', text)
    text = re.sub(r'<site( name="o\\d+"[^>]*)/>', r'ELEMENT', text)
    sensors = ''.join(
        f'<{kind} name="{kind}:{name}" objtype="TYPE" objname="{name}"MORE/>' for name in names for kind in KINDS)
    return mj.MjModel.from_xml_string(text.replace('</mujoco>', f'<sensor>{sensors}</sensor></mujoco>'))
def read(kind, k): return np.array(d.sensor(f'{kind}:o{k}').data)"""
_READ, _IMPORT = "mj.MjModel.from_xml_string(", "import mujoco as mj"
_KINDS = ("framepos", "framequat", *(f"frame{x}axis" for x in "xyz"), "framelinvel", "frameangvel")
_SITE = r"\g<0>"
# Type of an object -> element that is made of a site's, field of its pose.
_OBJECTS = {
    "site": (_SITE, "site"),
    "camera": (_SITE + r"<camera\1/>", "cam"),
    "geom": (_SITE + r'<geom\1 type="box" size="0.1 0.2 0.3" mass="0" contype="0" conaffinity="0"/>', "geom"),
}
_AXES = "np.array([read(f'frame{x}axis', k) for x in 'xyz']).T.ravel()"
_POSES = f"value = [[*read('framepos', k), *{_AXES}] for k in sensed]"
_QUATERNIONS = (
    "value = np.zeros((len(sensed), 12))\nfor row, k in zip(value, sensed):\n"
    "    row[:3] = read('framepos', k)\n    mj.mju_quat2Mat(row[3:], read('framequat', k))"
)
_TWISTS = "value = [[*read('framelinvel', k), *read('frameangvel', k)] for k in sensed]"
_ACCELERATED = f"{QVA}mj.mj_rnePostConstraint(m, d)\n"
_GRAVITY = "np.r_[m.opt.gravity, 0, 0, 0]"
_OBJECT = (
    "value = np.zeros((len(sensed), 6))\nfor row, k in zip(value, sensed):\n"
    "    mj.mj_object{}(m, d, mj.mjtObj.mjOBJ_{}, m.{}(f'o{{k}}').id, row, {})\n"
    "value = np.roll(value, 3, axis=1)"
)


def _of(one: str) -> dict[str, Way]:
    """Ways of objects of one type."""
    element, field = _OBJECTS[one]
    constant = one.upper()

    def built(more: str = "", kinds: tuple[str, ...] = _KINDS) -> tuple[tuple[str, str], ...]:
        text = _MADE.replace("ELEMENT", element).replace("TYPE", one).replace("MORE", more)
        return ((_READ, "made("), (_IMPORT, _IMPORT + text.replace("KINDS", repr(kinds))))

    there, seen = built(), built(f' reftype="{one}" refname="o0"')
    moving = built(kinds=("framelinacc", "frameangacc"))

    def said(function: str, is_local: bool) -> str:
        return _OBJECT.format(function, constant, one, int(is_local))

    own = f"own = [m.{one}(f'o{{k}}').id for k in sensed]\n"
    return {
        f"frame_poses:{one}": Way(
            f"{field}_xpos, {field}_xmat",
            f"{Q}{own}value = np.hstack([d.{field}_xpos[own], d.{field}_xmat[own]])",
            built=there,
        ),
        f"frame_poses:framepos of a {one}": Way("framepos, framexaxis", Q + _POSES, built=there),
        f"frame_poses:framequat of a {one}": Way("framepos, framequat", Q + _QUATERNIONS, built=there),
        f"frame_poses_seen:{one}": Way("framepos, framexaxis with reftype", Q + _POSES, built=seen),
        f"frame_poses_seen:framequat of a {one}": Way("framepos, framequat with reftype", Q + _QUATERNIONS, built=seen),
        f"frame_velocities:{one}": Way("mj_objectVelocity", QV + said("Velocity", False), built=there),
        f"frame_velocities:framelinvel of a {one}": Way("framelinvel, frameangvel", QV + _TWISTS, built=there),
        f"frame_velocities_seen:{one}": Way("framelinvel, frameangvel with reftype", QV + _TWISTS, built=seen),
        f"velocimeters:{one}": Way("mj_objectVelocity", f"{QV}{said('Velocity', True)}[:, :3]", built=there),
        f"gyroscopes:{one}": Way("mj_objectVelocity", f"{QV}{said('Velocity', True)}[:, 3:]", built=there),
        f"frame_accelerations:{one}": Way(
            "mj_objectAcceleration", f"{_ACCELERATED}{said('Acceleration', False)} + {_GRAVITY}", built=there
        ),
        f"accelerometers:{one}": Way(
            "mj_objectAcceleration", f"{_ACCELERATED}{said('Acceleration', True)}[:, :3]", built=there
        ),
        f"frame_accelerations:framelinacc of a {one}": Way(
            "framelinacc, frameangacc",
            f"{_ACCELERATED}mj.mj_sensorAcc(m, d)\n"
            f"value = [[*read('framelinacc', k), *read('frameangacc', k)] + {_GRAVITY} for k in sensed]",
            built=moving,
        ),
    }


WAYS = {name: way for one in _OBJECTS for name, way in _of(one).items()}
WAYS |= {
    "frame_jacobians:mj_jacGeom": Way(
        "mj_jacGeom",
        f"{Q}value = np.zeros((len(sensed), 6, m.nv))\n"
        "for J, k in zip(value, sensed): mj.mj_jacGeom(m, d, J[:3], J[3:], m.geom(f'o{k}').id)",
        built=WAYS["frame_poses:geom"].built,
    ),
    "magnetic_fields": Way(
        "magnetometer",
        f"m.opt.magnetic[:] = {list(MAGNETIC)}\n{Q}value = [data('magnetometer', k) for k in sensed]",
    ),
}
