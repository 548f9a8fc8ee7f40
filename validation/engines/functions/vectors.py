"""What packages compute of numbers, vectors and matrices."""

from __future__ import annotations

from decimal import Decimal
from functools import partial

import numpy as np

from ..truth.arithmetic import Exact, cross, exact
from ..truth.geometry import vectors
from ..truth.geometry.vectors import away, band, gram, length, of_state, product, rows
from .function import Function, functions_of

# What trees are asked about that stand for vectors (`Tree.asked`).
ASKED = "vectors"
_HALF = Decimal("0.5")
_UNIT = exact((1.0, 0.0, 0.0, 0.0))


def _of_vectors() -> dict[str, Function]:
    table = {
        "vector_sum": ("v + a (3)", lambda s: s.v + s.a),
        "vector_difference": ("v - a (3)", lambda s: s.v - s.a),
        "vector_scaled": ("tau[0] v (3)", lambda s: s.tau[0] * s.v),
        "vector_sum_scaled": ("v + tau[0] a (3)", lambda s: s.v + s.tau[0] * s.a),
        "vector_copy": ("v (3)", lambda s: s.v),
        "vector_fill": ("tau[0] thrice (3)", lambda s: [s.tau[0]] * 3),
        "vector_zero": ("zeros where v was (3)", lambda s: 0 * s.v),
        "vector_dot": ("v a (1)", lambda s: s.v @ s.a),
        "vector_cross": ("v x a (3)", lambda s: cross(s.v, s.a)),
        "vector_length": ("|u| (1)", lambda s: length(away(s))),
        "vector_distance": ("|u - a| (1)", lambda s: length(away(s) - s.a)),
        "vector_normalised": ("u / |u|, |u| (4)", lambda s: [*(away(s) / length(away(s))), length(away(s))]),
        "vector_entries_sum": ("sum of v (1)", lambda s: sum(s.v)),
        "vector_absolute_sum": ("sum of |v| (1)", lambda s: sum(abs(s.v))),
        "vector_sorted": ("entries of v and a, the least first (6)", lambda s: sorted([*s.v, *s.a])),
        "vector_aligned": (
            "v, turned about z by the turn of y to (u[0], u[1]) (3)",
            lambda s: _aligned(s.v, away(s)),
        ),
    }
    numbers = {
        "number_clipped": ("v within -1/2 and 1/4 (3)", lambda s: [min(max(x, -_HALF), _HALF / 2) for x in s.v]),
        "number_least": ("least of v and a (3)", lambda s: np.minimum(s.v, s.a)),
        "number_greatest": ("greatest of v and a (3)", lambda s: np.maximum(s.v, s.a)),
        "number_sign": ("signs of v (3)", lambda s: [Decimal((x > 0) - (x < 0)) for x in s.v]),
        "number_rounded": ("nearest whole numbers to 64 a (3)", lambda s: [(64 * x).to_integral_value() for x in s.a]),
        "sigmoid": ("quintic from 0 to 1 of |u| / (1 + |u|), of -1/2, of 3/2 (5)", vectors.sigmoid),
        "radical_inverse": (
            "numbers 1, 5, 11 of Halton's sequence of base 3, 6 of base 2 (4)",
            lambda s: [Decimal(1) / 3, Decimal(7) / 9, Decimal(19) / 27, Decimal(3) / 8],
        ),
    }
    return functions_of({name: (text, of_state(of)) for name, (text, of) in (table | numbers).items()}, ASKED)


def _aligned(v: Exact, u: Exact) -> list[Exact]:
    x, y, z = v
    side = length(u[:2])
    sine, cosine = u[0] / side, u[1] / side
    return [cosine * x + sine * y, -sine * x + cosine * y, z]


def _of_times() -> dict[str, Function]:
    """Samples v at -3 h, -2 h, -h, read at -3/2 h; what muscles' activations do."""
    between = ("linear interpolation of these (1)", lambda s: [(s.v[1] + s.v[2]) / 2])
    table = {
        "history_of_control_held": ("the last of the samples before that (1)", lambda s: [s.v[1]]),
        "history_of_control_interpolated": between,
        "history_of_sensor_held": ("the last of the samples before that (1)", lambda s: [s.v[1]]),
        "history_of_sensor_interpolated": between,
        "muscle_rate": (
            f"rate of a muscle's activation |a[0]| / 2 at the control |v[0]| / (1 + |v[0]|), times {vectors.TIMES} (1)",
            vectors.muscle_rate,
        ),
    }
    return functions_of({name: (text, of_state(of)) for name, (text, of) in table.items()}, ASKED)


def _of_matrices() -> dict[str, Function]:
    table = {
        "matrix_product": ("B (B B^T + 1) (3, 3)", lambda s: rows(s) @ gram(s)),
        "matrix_product_first_transposed": ("B^T (B B^T + 1) (3, 3)", lambda s: rows(s).T @ gram(s)),
        "matrix_product_second_transposed": ("(B B^T + 1) B^T (3, 3)", lambda s: gram(s) @ rows(s).T),
        "matrix_square": ("B^T diag(u) B (3, 3)", lambda s: rows(s).T @ (away(s)[:, None] * rows(s))),
        "matrix_square_plain": ("B^T B (3, 3)", lambda s: rows(s).T @ rows(s)),
        "matrix_times_vector": ("B u (3)", lambda s: rows(s) @ away(s)),
        "matrix_transposed_times_vector": ("B^T u (3)", lambda s: rows(s).T @ away(s)),
        "matrix_between_vectors": ("u B a (1)", lambda s: away(s) @ rows(s) @ s.a),
        "matrix_transpose": ("B^T (3, 3)", lambda s: rows(s).T),
        "matrix_symmetric_part": ("(B + B^T) / 2 (3, 3)", lambda s: (rows(s) + rows(s).T) / 2),
        "matrix_from_triangle": ("B B^T + 1 of its lower triangle by rows of entries (3, 3)", gram),
        "matrix_through_entries": ("B by rows of its entries that are not zero (3, 3)", rows),
        "band_matrix": ("B B^T + 1 without its corners, from its band (3, 3)", band),
        "band_matrix_dense": ("B B^T + 1 from a band with a dense row (3, 3)", gram),
        "band_times_vector": ("band_matrix times u (3)", lambda s: band(s) @ away(s)),
        "friction_edges": (f"edges of a contact force, of frictions {vectors.FRICTION} (4)", vectors.edges),
        "friction_edges_back": ("normal and tangents of that force, from these edges (3)", vectors.contact_force),
        "quaternion_conjugate": ("conjugate of q (4)", lambda s: [s.q[0], *-s.q[1:]]),
        "quaternion_axis_product": ("q times (0, v) (4)", lambda s: product(s.q, np.array([Decimal(0), *s.v]))),
        "quaternion_unit": ("1, 0, 0, 0 (4)", lambda s: _UNIT),
        "quaternion_normalised": ("q, of twice that (4)", lambda s: s.q / length(s.q)),
    }
    for roots, (damping, stiffness) in vectors.ROOTS.items():
        text = f"where x'' + {damping} x' + {stiffness} x = 0 leads from v[0], a[0] in {vectors.DECAY} s (1)"
        table[f"decay_of_{roots}_roots"] = (text, partial(vectors.decayed, roots=roots))
    return functions_of({name: (text, of_state(of)) for name, (text, of) in table.items()}, ASKED)


VECTORS = _of_vectors() | _of_matrices() | _of_times()
