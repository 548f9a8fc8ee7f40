"""trimesh: its rotations and placements, and placements that lead points to others."""

from __future__ import annotations

from ...truth.geometry.poses import AWAY, POINTS, SEQUENCES, WEIGHTS
from ...truth.geometry.shapes import SCALES
from ..writing.source import HALF_TURNS, ON_END, Way, ways_of
from .solids import FACES

IMPORTS = ("import trimesh", "from trimesh import transformations as tr")
_R = "R, Q = tr.quaternion_matrix(q), tr.quaternion_matrix(q2)\n"
_X = f"{_R}X, Y = R.copy(), Q.copy()\nX[:3, 3], Y[:3, 3] = a, tau\n"
_ROWS = "value = {of}[:3, :3].ravel()"
_AGAIN = "[{of}[:3, :3].ravel() for H in {all}]"
_FLAT = "T = {of}\nvalue = [*T[:3, 3], *T[:3, :3].flat]"
_FROM = "tr.quaternion_matrix(tr.quaternion_from_matrix(np.block([[H, np.zeros((3, 1))], [0, 0, 0, 1]])))"
_EULER = "tr.euler_matrix(*tr.euler_from_matrix(H, 'sxyz'), 'sxyz')"
_POINTS = (
    f"marks, weights = np.array({[*map(list, POINTS)]}), np.array({list(WEIGHTS)})\nplaces = marks @ R[:3, :3].T + a\n"
)
_ALIGNED = (
    "trimesh.registration.procrustes(marks, places, reflection=False, scale=False, return_cost=False, weights={})"
)


def _rows(of: str) -> str:
    return _ROWS.format(of=of)


def _flat(of: str) -> str:
    return _FLAT.format(of=of)


WAYS = ways_of(f"""
== rotation_matrix | quaternion_matrix | {_R}{_rows("R")}
== rotation_matrix:quaternion_from_matrix | quaternion_from_matrix
{_R}{_rows("tr.quaternion_matrix(tr.quaternion_from_matrix(R))")}
== rotation_matrix:precise | quaternion_from_matrix, isprecise
{_R}{_rows("tr.quaternion_matrix(tr.quaternion_from_matrix(R, isprecise=True))")}
== rotation_composed | quaternion_multiply | {_rows("tr.quaternion_matrix(tr.quaternion_multiply(q, q2))")}
== rotation_inverse | quaternion_inverse | {_rows("tr.quaternion_matrix(tr.quaternion_inverse(q))")}
== rotation_inverse:conjugate | quaternion_conjugate | {_rows("tr.quaternion_matrix(tr.quaternion_conjugate(q))")}
== rotation_halfway | quaternion_slerp | {_rows("tr.quaternion_matrix(tr.quaternion_slerp(q, q2, 0.25))")}
== rotation_logarithm | rotation_from_matrix | {_R}angle, axis, _ = tr.rotation_from_matrix(R)\nvalue = angle * axis
== rotation_exponential | rotation_matrix
n = np.linalg.norm(v)
{_rows("tr.rotation_matrix(n, v if n else [1, 0, 0])")}
== rotation_exponential:quaternion_about_axis | quaternion_about_axis
n = np.linalg.norm(v)
{_rows("tr.quaternion_matrix(tr.quaternion_about_axis(n, v if n else [1, 0, 0]))")}
== rotation_half_turns | quaternion_from_matrix
{HALF_TURNS}value = {_AGAIN.format(of=_FROM, all="half_turns")}
== rotation_half_turns:euler_from_matrix | euler_from_matrix
{HALF_TURNS}value = {_AGAIN.format(of=_EULER, all="half_turns")}
== rotation_of_rpy | euler_matrix | {_rows("tr.euler_matrix(*v, 'sxyz')")}
== rotation_of_rpy:quaternion_from_euler | quaternion_from_euler
{_rows("tr.quaternion_matrix(tr.quaternion_from_euler(*v, 'sxyz'))")}
== rotation_to_rpy | euler_from_matrix | {_R}value = tr.euler_from_matrix(R, 'sxyz')
== rotation_to_rpy:quaternion | euler_from_quaternion | value = tr.euler_from_quaternion(q, 'sxyz')
== rotations_on_end | euler_from_matrix | {ON_END}value = {_AGAIN.format(of=_EULER, all="on_end")}
== rotation_of_zyz | euler_matrix | {_rows("tr.euler_matrix(*v, 'rzyz')")}
== rotations_of_three_angles | euler_matrix
value = [tr.euler_matrix(*v, 'r' + order)[:3, :3].ravel() for order in {SEQUENCES}]
== rotations_of_three_angles:quaternion_from_euler | quaternion_from_euler
value = [tr.quaternion_matrix(tr.quaternion_from_euler(*v, 'r' + order))[:3, :3].ravel() for order in {SEQUENCES}]
== pose_composed | concatenate_matrices | {_X}{_flat("tr.concatenate_matrices(X, Y)")}
== pose_composed:decompose_matrix | decompose_matrix, compose_matrix
{_X}{_flat("tr.compose_matrix(*tr.decompose_matrix(X @ Y))")}
== pose_inverse | inverse_matrix | {_X}{_flat("tr.inverse_matrix(X)")}
== pose_of_point | transform_points | {_X}value = tr.transform_points([v], X)[0]
== turn_about_line | rotation_matrix about a point | {_flat(f"tr.rotation_matrix(tau[0], v + {list(AWAY)}, a)")}
== pose_aligned | registration.procrustes | {_R}{_POINTS}{_flat(_ALIGNED.format("None"))}
== pose_aligned:superimposition_matrix | superimposition_matrix
{_R}{_POINTS}{_flat("tr.superimposition_matrix(marks.T, places.T)")}
== pose_aligned:affine_matrix_from_points | affine_matrix_from_points
{_R}{_POINTS}{_flat("tr.affine_matrix_from_points(marks.T, places.T, shear=False, scale=False)")}
""") | {
    f"pose_aligned:{name}": Way(
        "registration.procrustes, weights", f"{_R}{_POINTS}{before}{_flat(_ALIGNED.format(of))}"
    )
    for name, before, of in (
        ("equal weights", "", "np.full(len(marks), 2.0)"),
        ("weights", "", "weights"),
        ("weights of none", "places[-1] += 8.0\n", "np.sign(np.arange(len(marks))[::-1])"),
    )
}
# Solids that are made of triangles, by their sizes, with and without a placement or a reflection.
_SIZES = "x = np.abs(v) + 0.5\n"
_MADE = {
    "prism": "cylinder(x[0], x[1], sections=4",
    "pyramid": "cone(x[0], x[1], sections=4",
    "ring": "annulus(x[0], x[0] + x[1], x[2], sections=4",
    "bar": "box(x",
}
_PLACED = {"": "", ":placed": ", transform=X", ":mirrored": ", transform=X @ np.diag([1.0, 1.0, -1.0, 1.0])"}
WAYS |= {
    f"volume_of_{solid}{how}": Way(
        f"creation.{made.partition('(')[0]}", f"{_SIZES}{_X}value = [trimesh.creation.{made}{placed}).volume]"
    )
    for solid, made in _MADE.items()
    for how, placed in _PLACED.items()
}
_CORNERS = f"{_SIZES}corners, faces = np.vstack([np.zeros(3), np.diag(x)]), np.reshape({[*FACES]}, (4, 3))\n"
# Faces of OBJ by places in all that the file has, and by places before each face, where more vertices come behind.
_OBJ = (
    "lines = ['v ' + ' '.join(map(repr, map(float, p))) for p in corners]\n"
    "lines += ['f ' + ' '.join(str(k + {first}) for k in face) for face in faces] + ['v 8 8 8'] * 3\n"
    "solid = trimesh.load_mesh(io.StringIO('\\n'.join(lines)), file_type='obj', process=False)\n"
)
_FORMATS = ("stl", "ply", "off", "obj", "glb")
_READ = {
    "": "solid = trimesh.Trimesh(corners, faces, process=False)\n",
    ":OBJ": _OBJ.format(first=1),
    ":OBJ, relative": _OBJ.format(first=-4),
} | {
    f":{one}, written": "solid = trimesh.Trimesh(corners, faces, process=False)\n"
    f"data = solid.export(file_type='{one}')\n"
    "data = data.encode() if isinstance(data, str) else data\n"
    f"solid = trimesh.load_mesh(io.BytesIO(data), file_type='{one}', process=False)\n"
    for one in _FORMATS
}
_OF_SOLID = {
    "volume_of_tetrahedron": "value = [solid.volume]",
    "centre_of_tetrahedron": "value = solid.center_mass",
    "face_of_tetrahedron": "value = solid.triangles_cross[3] / 2",
}
WAYS |= {
    f"{function}{name}{how}": Way(
        "apply_transform" if name else "Trimesh, load_mesh",
        "import io\n"
        + _CORNERS
        + made
        + f"solid.apply_transform(np.diag([{', '.join(map(str, factors))}, 1.0]))\n"
        + text,
        slack=0.0 if how in ("", ":OBJ", ":OBJ, relative") else 1e-6,  # Formats of single precision, or of 8 digits.
    )
    for function, text in _OF_SOLID.items()
    for name, factors in SCALES.items()
    for how, made in _READ.items()
    if not (name and how)
}
