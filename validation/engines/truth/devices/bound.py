"""Soft constraints of one row, by MuJoCo's parameters `solref` and `solimp`.

With m the mass, a0 the acceleration without the constraint, r what it is off by and v the rate of that, a row has
a = (1 - d) a0 + d (-b v - k r), of limits only where that is more than a0. With y = |r| / width, d rises from d0 to dw
by y^p / mid^(p - 1) up to mid, then by 1 - (1 - y)^p / (1 - mid)^(p - 1). Of a time constant T and a damping ratio z,
b = 2 / (dw T), k = d / (dw T z)^2; of a stiffness and a damping, k = stiffness d / dw^2, b = damping / dw
(Modeling, "Solver parameters"). Dry friction is a row with r = 0, whose force ends at its bound. The limit of a ball is
that of the angle of its quaternion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..arithmetic import Exact, root
from ..dynamics import Point
from ..geometry.turns import rotation_vector
from .device import BALL, MASS, MOMENT, Device, H, body, clipped, model, number, slide, turn_of


class _Row(NamedTuple):
    """Parameters of a row: `solref` and `solimp`; whether time constants below two steps are two steps."""

    ref: tuple[float, float] = (0.02, 1.0)
    imp: tuple[float, float, float, float, int] = (0.9, 0.95, 0.001, 0.5, 2)
    is_safe: bool = True

    def stated(self, more: str = "") -> str:
        """Their attributes."""
        ref, imp = (" ".join(f"{x:g}" for x in values) for values in (self.ref, self.imp))
        return f'solref{more}="{ref}" solimp{more}="{imp}"'

    def impedance(self, r: Exact) -> Exact:
        """Part of the constraint's acceleration."""
        d0, dw, width, mid = map(number, self.imp[:4])
        power, y = self.imp[4], min(abs(r) / width, number(1))
        part = y if power == 1 else y**power / mid ** (power - 1)
        if power > 1 and y > mid:
            part = 1 - (1 - y) ** power / (1 - mid) ** (power - 1)
        return d0 + (dw - d0) * part

    def wanted(self, r: Exact, v: Exact) -> Exact:
        """Reference acceleration -b v - k r."""
        d, dw = self.impedance(r), number(self.imp[1])
        first, second = map(number, self.ref)
        if self.ref[0] < 0:
            return second / dw * v + first * d / dw**2 * r
        time = max(first, 2 * H) if self.is_safe else first
        return -2 / (dw * time) * v - d / (dw * time * second) ** 2 * r

    def held(self, a0: Exact, r: Exact, v: Exact, is_limit: bool = False) -> Exact:
        """Acceleration with the row."""
        d, wanted = self.impedance(r), self.wanted(r, v)
        return a0 if is_limit and wanted <= a0 else (1 - d) * a0 + d * wanted


# Options by which a solver leaves nothing of its conditions.
SOLVED = 'solver="Newton" tolerance="0" iterations="20"'
_DRIVEN = "qpos=v[:1], qvel=a[:1], qfrc_applied=tau[:1]"
_Of = Callable[[Exact, Exact, Exact], object]
_ROWS = {
    "default": _Row(),
    "time_constant": _Row((0.125, 0.75)),
    "stiffness": _Row((-50.0, -3.0)),
    "linear_impedance": _Row(imp=(0.25, 0.875, 4.0, 0.5, 1)),
    "square_impedance": _Row(imp=(0.25, 0.875, 4.0, 0.5, 2)),
    "early_cubic_impedance": _Row(imp=(0.25, 0.875, 4.0, 0.25, 3)),
    "fast": _Row((0.015625, 1.0)),
    "fast_and_unsafe": _Row((0.015625, 1.0), is_safe=False),
}


def _slide(about: str, attributes: str, of: _Of, rest: str = "", inside: str = "", read: str = "qacc") -> Device:
    """A slide that tau drives; its acceleration of x, x', a0."""
    text = model(slide(attributes), rest, SOLVED, inside)
    return Device(about, text, _DRIVEN, read, lambda s: of(s.v[0], s.a[0], s.tau[0] / MASS))


def _limits() -> dict[str, Device]:
    made: dict[str, Device] = {}
    for name, row in _ROWS.items():
        inside = "" if row.is_safe else '<flag refsafe="disable"/>'

        def of(x: Exact, v: Exact, a0: Exact, row: _Row = row) -> object:
            return row.held(a0, x - 2, v, True) if x < 2 else a0

        made[f"limit_of_{name}"] = _slide(
            f"joint range, solreflimit, solimplimit: {row.stated()}",
            f'range="2 1000" {row.stated("limit")}',
            of,
            "",
            inside,
        )
    row = _Row((0.25, 1.0), (0.5, 0.5, 1.0, 0.5, 2))

    def from_above(x: Exact, v: Exact, a0: Exact) -> object:
        return -row.held(-a0, -2 - x, -v, True) if x > -2 else a0

    def by_margin(x: Exact, v: Exact, a0: Exact) -> object:
        r = x + 1 - number(0.5)
        return row.held(a0, r, v, True) if r < 0 else a0

    def force(x: Exact, v: Exact, a0: Exact) -> object:
        return MASS * (row.held(a0, x - 2, v, True) - a0) if x < 2 else 0 * a0

    stated = row.stated("limit")
    return made | {
        "limit_from_above": _slide("joint range", f'range="-1000 -2" {stated}', from_above),
        "limit_with_margin": _slide("joint range, margin", f'range="-1 1000" margin="0.5" {stated}', by_margin),
        "limit_force": _slide(
            "sensor/jointlimitfrc",
            f'range="2 1000" {stated}',
            force,
            '<sensor><jointlimitfrc joint="j"/></sensor>',
            read="sensordata",
        ),
        "limit_disabled": _slide("flag limit", 'range="2 1000"', lambda x, v, a0: a0, inside='<flag limit="disable"/>'),
    }


def _equalities() -> dict[str, Device]:
    def equal(row: _Row, more: str = "") -> str:
        return f'<equality><joint joint1="j" polycoef="0.25 0 0 0 0" {row.stated()}{more}/></equality>'

    def held(row: _Row) -> _Of:
        return lambda x, v, a0: row.held(a0, x - number(0.25), v)

    made = {}
    for name, row in _ROWS.items():
        inside = "" if row.is_safe else '<flag refsafe="disable"/>'
        about = f"equality/joint solref, solimp: {row.stated()}"
        made[f"equality_of_{name}"] = _slide(about, "", held(row), equal(row), inside)
    made["equality_inactive"] = _slide("equality active", "", lambda x, v, a0: a0, equal(_Row(), ' active="false"'))
    made["equality_disabled"] = _slide(
        "flag equality", "", lambda x, v, a0: a0, equal(_Row()), '<flag equality="disable"/>'
    )
    return made


def _frictions() -> dict[str, Device]:
    row = _Row((0.125, 1.0), (0.5, 0.75, 1.0, 0.5, 2))
    stated = row.stated("friction")

    def rubbed(loss: float) -> _Of:
        def of(x: Exact, v: Exact, a0: Exact) -> object:
            force = MASS * (row.held(a0, 0 * x, v) - a0)
            return a0 + clipped(force, -loss, loss) / MASS

        return of

    return {
        "dry_friction": _slide("joint frictionloss", f'frictionloss="0.5" {stated}', rubbed(0.5)),
        "dry_friction_large": _slide("joint frictionloss", f'frictionloss="512" {stated}', rubbed(512.0)),
        "dry_friction_disabled": _slide(
            "flag frictionloss", 'frictionloss="0.5"', lambda x, v, a0: a0, inside='<flag frictionloss="disable"/>'
        ),
    }


def _ball() -> dict[str, Device]:
    row = _Row((0.25, 1.0), (0.5, 0.5, 1.0, 0.5, 2))
    joint = BALL.replace("/>", f' range="0 0.5" {row.stated("limit")}/>')

    def acceleration(s: Point) -> object:
        vector, a0 = rotation_vector(turn_of(s.q)), s.tau / MOMENT
        angle = root(vector @ vector)
        if angle <= number(0.5):
            return a0
        inward = -vector / angle
        before = inward @ a0
        return a0 + inward * (row.held(before, number(0.5) - angle, inward @ s.a, True) - before)

    text = model(body(joint), option=SOLVED)
    return {"limit_of_ball": Device("joint ball range", text, "qpos=q, qvel=a, qfrc_applied=tau", "qacc", acceleration)}


DEVICES = _limits() | _equalities() | _frictions() | _ball()
