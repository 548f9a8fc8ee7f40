"""The recursion in LaTeX: joints and bodies with the user's names, then the formulas (docs/theory/rigid.md, 3, 5)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from symofros.description import ORIGIN, Beam, Inertia, Rotation, Value
from symofros.exports.equations import formulas
from symofros.exports.equations.formulas import latex_text
from symofros.mechanics.topology import BASE, Link, SpanningTree, coordinate_symbols, speed_symbols

_AXES = ("axis", "axis2")
# What the recursion does at each link, with the equations' numbers in docs/theory/rigid.md.
_FORMULAS = r"""
\begin{aligned}
&\text{base to tip, link } i \text{ on its parent } a: \\
\omega_i &= R_{ai}^T \omega_a + \textstyle\sum_k w_k v_k & (6) \\
\alpha_i &= R_{ai}^T \alpha_a + \textstyle\sum_k (w_k \dot v_k + \dot w_k v_k) +
 (R_{ai}^T \omega_a) \times \sum_k w_k v_k & (7) \\
a_i &= R_{ai}^T (a_a + U_a p_{ai}) + \textstyle\sum_k (V_k \dot v_k + \dot V_k v_k)
 + (R_{ai}^T \omega_a + \omega_i) \times \sum_k V_k v_k & (8) \\
U_i &= [\alpha_i]_\times + [\omega_i]_\times^2, \qquad a_W = -g \\
&\text{each link, with } J_i \text{ about its origin and } S_i = m_i c_i: \\
f_i &= m_i a_i + U_i S_i & (9) \\
n_i &= J_i \alpha_i + \omega_i \times J_i \omega_i + S_i \times a_i & (10) \\
&\text{tip to base:} \\
f_a &\mathrel{+}= R_{ai} f_i, \qquad n_a \mathrel{+}= R_{ai} n_i + p_{ai} \times R_{ai} f_i & (11) \\
&\text{each speed: } h_k = V_k \cdot f_i + w_k \cdot n_i \text{ at } \dot v = 0 & (5) \\
M_{jk} &= V_j \cdot f + w_j \cdot n \text{ with } f = m V_k + w_k \times S, \; n = J w_k + S \times V_k
 \text{ of all that } k \text{ carries} & (19), (20)
\end{aligned}
"""


def recursion_text(tree: SpanningTree, symbols: Mapping[str, Any], names: Mapping[Any, str]) -> str:
    """LaTeX of the recursive equations of a tree."""
    writer = _Writer(symbols, names)
    gravity = f"g = {writer.vector(tree.system.gravity)}"
    links = [writer.link(i, link, tree.links) for i, link in enumerate(tree.links)]
    formulas_text = _FORMULAS.strip()
    return "\n\n".join([f"\\[ {gravity} \\]", *links, f"\\[\n{formulas_text}\n\\]"]) + "\n"


class _Writer:
    """LaTeX of a description's parts."""

    def __init__(self, symbols: Mapping[str, Any], names: Mapping[Any, str]) -> None:
        self._symbols, self._names = symbols, names

    def link(self, index: int, link: Link, links: Sequence[Link]) -> str:
        """LaTeX paragraph of a link: its joint, placements, inertias and beam."""
        parent = (
            "the base" if link.parent == BASE else f"link {link.parent + 1} ({latex_text(links[link.parent].name)})"
        )
        what = "deformation of the beam" if link.tip_of is not None else f"{link.joint.kind} joint"
        name, joint = latex_text(link.name), latex_text(link.joint.name)
        head = f"\\paragraph{{Link {index + 1} ({name})}} on {parent}: {what} {joint}."
        q = [self._name(name) for name in coordinate_symbols(link.joint)]
        v = [self._name(name) for name in speed_symbols(link.joint)]
        rows = [f"q_{{{index + 1}}} &= ({', '.join(q)}), \\quad v_{{{index + 1}}} = ({', '.join(v)})"]
        for step in link.placement:
            rows += self._placement("p", "R", step.position, step.rotation)
        rows += self._moving(link)
        for placement, inertia in link.inertias:
            for step in placement:
                rows += self._placement("p^{fixed}", "R^{fixed}", step.position, step.rotation)
            rows += self._inertia(inertia)
        if link.beam is not None:
            rows.append(self._beam(link.beam))
        return head + "\n\\[ \\begin{aligned}\n" + " \\\\\n".join(rows) + "\n\\end{aligned} \\]"

    def vector(self, values: Iterable[Value]) -> str:
        """A column."""
        return "(" + ",\\ ".join(map(self._value, values)) + ")^T"

    def _moving(self, link: Link) -> list[str]:
        joint = link.joint
        entries = joint.traits.entries
        rows = [
            f"{'n' if entry == 'axis' else 'n_2'} &= {self.vector(getattr(joint, entry))}"
            for entry in _AXES
            if entry in entries
        ]
        if "pitch" in entries:
            rows.append(f"\\text{{pitch}} &= {self._value(joint.pitch)}")
        if link.tip_of is None and "moving_position" in entries:
            rows.append(f"p_{{PD}} &= {self.vector(joint.moving_position)}")
            rows += self._rotation("R_{PD}", joint.moving_rotation)
        return rows

    def _placement(self, p: str, R: str, position: Sequence[Value], rotation: Rotation) -> list[str]:
        offset = [] if tuple(position) == ORIGIN else [f"{p} &= {self.vector(position)}"]
        return offset + self._rotation(R, rotation)

    def _rotation(self, label: str, rotation: Rotation) -> list[str]:
        if rotation.is_identity:
            return []
        kinds = {"rpy": "rpy", "axis_angle": "axis, angle", "quaternion": "quaternion", "matrix": "rows"}
        values = ",\\ ".join(map(self._value, rotation.values))
        return [f"{label} &= \\text{{{kinds[rotation.kind]}}}({values})"]

    def _inertia(self, inertia: Inertia) -> list[str]:
        xx, yy, zz, xy, xz, yz = map(self._value, inertia.moments)
        rows = [f"m &= {self._value(inertia.mass)}"]
        if inertia.center_of_mass != ORIGIN:
            rows.append(f"c &= {self.vector(inertia.center_of_mass)}")
        about = "c" if inertia.about == "center_of_mass" else "o"
        entries = f"{xx} & {xy} & {xz} \\\\ {xy} & {yy} & {yz} \\\\ {xz} & {yz} & {zz}"
        rows.append(f"J_{about} &= \\begin{{pmatrix}} {entries} \\end{{pmatrix}}")
        return rows + self._rotation("R_c", inertia.rotation)

    def _beam(self, beam: Beam) -> str:
        modes = ", ".join(self._name(name) for name in beam.coordinates)
        elastic = f", \\quad \\text{{elastic coordinates }} {modes}" if modes else ""
        return f"\\text{{length}} &= {self._value(beam.length)}{elastic}"

    def _name(self, name: str) -> str:
        symbol = self._symbols.get(name)
        return self._names.get(symbol, formulas.latex_of_name(name))

    def _value(self, value: Value) -> str:
        return formulas.latex(formulas.of_expression(value, self._symbols), self._names)
