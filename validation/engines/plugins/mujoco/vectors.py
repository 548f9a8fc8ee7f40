"""MuJoCo's functions of numbers, vectors and matrices."""

from __future__ import annotations

from ...truth.geometry.poses import AWAY
from ...truth.geometry.vectors import DECAY, FRICTION, ROOTS, TIMES
from ..writing.source import Way

_U = f"u = v + {list(AWAY)}\n"
_X = "value = np.zeros({n})\nmj.{call}"
_B = f"{_U}B = np.array([v, a, tau])\nA = B @ B.T + np.eye(3)\n"
_D = "value = np.zeros((3, 3))\nmj.{call}"
_EACH = "value = [mj.{call} for x, y in zip(v, a)]"
_STORED = "kept, counts, firsts = np.zeros({n}), np.zeros(3, np.int32), np.zeros(3, np.int32)\ncolumns = {columns}\n"
_FORCE = "w = np.array([8 * (1 + abs(v[1]) + abs(v[2])), v[1], v[2]])\n"
_BAND = "L = np.zeros({size})\nmj.mju_dense2Band(L, A, 3, {shape})\n"


def _vector(call: str, n: int = 3, before: str = "", after: str = "") -> Way:
    """A result that is written into the first argument."""
    return Way(call.partition("(")[0], before + _X.format(n=n, call=call) + after)


def _number(call: str, before: str = "") -> Way:
    return Way(call.partition("(")[0], f"{before}value = [mj.{call}]")


def _each(call: str) -> Way:
    return Way(call.partition("(")[0], _EACH.format(call=call))


def _matrix(call: str, before: str = _B) -> Way:
    return Way(call.partition("(")[0], before + _D.format(call=call))


def _changed(call: str, first: str, before: str = "") -> Way:
    """A result that changes the first argument."""
    return Way(call.partition("(")[0], f"{before}value = {first}.copy()\nmj.{call}")


def _pairs() -> dict[str, Way]:
    """Functions of vectors of any length, and of three."""
    rows = {
        "vector_sum": ("mju_add", "value, v, a"),
        "vector_difference": ("mju_sub", "value, v, a"),
        "vector_scaled": ("mju_scl", "value, v, tau[0]"),
        "vector_sum_scaled": ("mju_addScl", "value, v, a, tau[0]"),
        "vector_copy": ("mju_copy", "value, v"),
    }
    changed = {
        "vector_sum": ("mju_addTo", "value, a"),
        "vector_difference": ("mju_subFrom", "value, a"),
        "vector_sum_scaled": ("mju_addToScl", "value, a, tau[0]"),
        "vector_zero": ("mju_zero", "value"),
    }
    numbers = {"vector_dot": ("mju_dot", "v, a"), "vector_length": ("mju_norm", "u")}
    made: dict[str, Way] = {}
    for more in ("", "3"):
        made |= {f"{name}:{call}{more}": _vector(f"{call}{more}({given})") for name, (call, given) in rows.items()}
        made |= {
            f"{name}:{call}{more}": _changed(f"{call}{more}({given})", "v") for name, (call, given) in changed.items()
        }
        made |= {
            f"{name}:{call}{more}": _number(f"{call}{more}({given})", _U) for name, (call, given) in numbers.items()
        }
        made[f"vector_normalised:mju_normalize{more}"] = Way(
            f"mju_normalize{more}", f"{_U}length = mj.mju_normalize{more}(u)\nvalue = [*u, length]"
        )
    return made


_KEPT = """m = mj.MjModel.from_xml_string('<mujoco><option timestep="0.25"/><worldbody><body>'
    '<joint name="j" type="slide"/><geom size="1"/></body></worldbody>'
    '<actuator><motor joint="j" nsample="3"/></actuator><sensor><jointpos joint="j" nsample="3"/></sensor></mujoco>')
d, value, times, values = mj.MjData(m), np.zeros(1), np.array([-0.75, -0.5, -0.25]), v.reshape(3, 1)
"""


def _histories() -> dict[str, Way]:
    """Samples that are set and read."""
    made = {}
    for kind, call, more in (("control", "Ctrl", ""), ("sensor", "Sensor", ", 0.0")):
        stored = f"mj.mj_init{call}History(m, d, 0, times, values{more})\n"
        for how, order in (("held", 0), ("interpolated", 1)):
            made[f"history_of_{kind}_{how}"] = Way(
                f"mj_init{call}History, mj_read{call}",
                f"{_KEPT}{stored}value = mj.mj_read{call}(m, d, 0, -0.375, value, {order})",
            )
    return made


WAYS = (
    _pairs()
    | _histories()
    | {
        "vector_fill": _vector("mju_fill(value, tau[0])"),
        "vector_cross": _vector("mju_cross(value, v, a)"),
        "vector_distance": _number("mju_dist3(u, a)", _U),
        "vector_entries_sum": _number("mju_sum(v)"),
        "vector_absolute_sum": _number("mju_L1(v)"),
        "vector_sorted": Way("mju_insertionSort", "value = np.r_[v, a]\nmj.mju_insertionSort(value)"),
        "vector_aligned": _vector("mjv_alignToCamera(value, v, u)", before=_U),
        "vector_copy:mju_d2n": _vector("mju_d2n(value, v)"),
        "vector_copy:mju_n2d": _vector("mju_n2d(value, v)"),
        "number_clipped": _each("mju_clip(x, -0.5, 0.25)"),
        "number_least": _each("mju_min(x, y)"),
        "number_greatest": _each("mju_max(x, y)"),
        "number_sign": _each("mju_sign(x)"),
        "number_rounded": _each("mju_round(64 * y)"),
        "sigmoid": Way(
            "mju_sigmoid", f"{_U}value = [mj.mju_sigmoid(x) for x in [*(abs(u) / (1 + abs(u))), -0.5, 1.5]]"
        ),
        "radical_inverse": Way(
            "mju_Halton", "value = [mj.mju_Halton(k, base) for k, base in ((1, 3), (5, 3), (11, 3), (6, 2))]"
        ),
        "muscle_rate": _number(
            f"mju_muscleDynamics(abs(v[0]) / (1 + abs(v[0])), abs(a[0]) / 2, np.array([*{list(TIMES)}, 0.0]))"
        ),
        "matrix_product": _matrix("mju_mulMatMat(value, B, A)"),
        "matrix_product_first_transposed": _matrix("mju_mulMatTMat(value, B, A)"),
        "matrix_product_second_transposed": _matrix("mju_mulMatMatT(value, A, B)"),
        "matrix_square": _matrix("mju_sqrMatTD(value, B, u)"),
        "matrix_square_plain": _matrix("mju_sqrMatTD(value, B, None)"),
        "matrix_times_vector": _vector("mju_mulMatVec(value, B, u)", before=_B),
        "matrix_times_vector:mju_mulMatVec3": _vector("mju_mulMatVec3(value, B.ravel(), u)", before=_B),
        "matrix_transposed_times_vector": _vector("mju_mulMatTVec(value, B, u)", before=_B),
        "matrix_transposed_times_vector:mju_mulMatTVec3": _vector("mju_mulMatTVec3(value, B.ravel(), u)", before=_B),
        "matrix_between_vectors": _number("mju_mulVecMatVec(u, B, a)", _B),
        "matrix_transpose": _matrix("mju_transpose(value, B)"),
        "matrix_symmetric_part": _matrix("mju_symmetrize(value, B)"),
        "matrix_from_triangle": Way(
            "mju_sym2dense",
            f"{_B}columns = np.array([0, 0, 1, 0, 1, 2], np.int32)\nkept = A[np.tril_indices(3)]\n"
            "value = np.zeros((3, 3))\n"
            "mj.mju_sym2dense(value, kept, np.arange(1, 4, dtype=np.int32), np.array([0, 1, 3], np.int32), columns)",
        ),
        "matrix_through_entries": Way(
            "mju_dense2sparse, mju_sparse2dense",
            f"{_B}{_STORED.format(n=9, columns='np.zeros(9, np.int32)')}"
            "mj.mju_dense2sparse(kept, B, counts, firsts, columns)\nvalue = np.zeros((3, 3))\n"
            "mj.mju_sparse2dense(value, kept, counts, firsts, columns)",
        ),
        "band_matrix": _matrix("mju_band2Dense(value, L, 3, 2, 0, True)", _B + _BAND.format(size=6, shape="2, 0")),
        "band_matrix_dense": _matrix(
            "mju_band2Dense(value, L, 3, 2, 1, True)", _B + _BAND.format(size=7, shape="2, 1")
        ),
        "band_times_vector": _vector(
            "mju_bandMulMatVec(value, L[:, None], u[:, None], 3, 2, 0, 1, True)",
            before=_B + _BAND.format(size=6, shape="2, 0"),
        ),
        "friction_edges": _vector(f"mju_encodePyramid(value, w, np.array({list(FRICTION)}))", 4, _FORCE),
        "friction_edges_back": _vector(
            "mju_decodePyramid(value, edges, mu)",
            before=f"{_FORCE}mu, edges = np.array({list(FRICTION)}), np.zeros(4)\nmj.mju_encodePyramid(edges, w, mu)\n",
        ),
        "quaternion_conjugate": _vector("mju_negQuat(value, q)", 4),
        "quaternion_axis_product": _vector("mju_mulQuatAxis(value, q, v)", 4),
        "quaternion_unit": _vector("mju_unit4(value)", 4),
        "quaternion_unit:mju_zero4": _vector("mju_zero4(value)", 4, after="\nvalue[0] += 1"),
        "quaternion_normalised": Way("mju_normalize4", "value = 2 * q\nmj.mju_normalize4(value)"),
        "quaternion_normalised:mju_copy4": _vector("mju_copy4(value, q)", 4),
    }
    | {
        f"decay_of_{name}_roots": _number(f"mju_springDamper(v[0], a[0], {stiffness}, {damping}, {DECAY})")
        for name, (damping, stiffness) in ROOTS.items()
    }
)
