"""C text of sines and cosines: the blocks of a function, and the hand-written routines behind them."""

from __future__ import annotations

from collections.abc import Iterable
from string import Template

from symofros.expr.numerics.trigonometry import (
    COSINE,
    COSINE_SINGLE,
    FAR,
    HALF_PI,
    ROUNDER,
    SINE,
    SINE_SINGLE,
    TWO_BY_PI,
)
from symofros.generator.codegen.statements import WIDEST, Statement, StatementWriter
from symofros.native import native_text
from symofros.runtime.calls.kernel import Precision

# A block of angles is padded to one of these.
WIDTHS = (1, 2, 4, WIDEST)


def block_lines(writer: StatementWriter, statement: Statement) -> list[str]:
    """The lines of a block: its angles in a vector, the call, the variables."""
    if writer.lanes:
        return _lane_lines(writer, statement)
    first, angles = statement.nodes[0], statement.angles
    width = _width(len(angles))
    texts = [*map(writer.text, angles), *["0.0"] * (width - len(angles))]
    given = f"{{{', '.join(texts)}}}" if width > 1 else texts[0]
    lines = [
        f"    sym_{width} angles{first} = {given}, sines{first}, cosines{first};",
        f"    sym_sincos_{width}(&angles{first}, &sines{first}, &cosines{first});",
    ]
    for node in statement.nodes:
        lane = f"[{angles.index(writer.graph.args[node][0])}]" if width > 1 else ""
        lines.append(f"    const double {writer.name(node)} = {_RESULTS[writer.graph.op[node]]}{first}{lane};")
    return lines


def _lane_lines(writer: StatementWriter, statement: Statement) -> list[str]:
    """The lines of a block whose angles are vectors of states already."""
    first, angles = statement.nodes[0], statement.angles
    n = len(angles)
    lines = [
        f"    const sym_v angles{first}[] = {{{', '.join(map(writer.whole, angles))}}};",
        f"    sym_v sines{first}[{n}], cosines{first}[{n}];",
        f"    sym_sincos_v({n}, angles{first}, sines{first}, cosines{first});",
    ]
    for node in statement.nodes:
        at = angles.index(writer.graph.args[node][0])
        lines.append(f"    const sym_v {writer.name(node)} = {_RESULTS[writer.graph.op[node]]}{first}[{at}];")
    return lines


_RESULTS = {"sin": "sines", "cos": "cosines"}


def _width(angles: int) -> int:
    return next(width for width in WIDTHS if width >= angles)


def routines(code: Iterable[str], lanes: bool = False) -> list[str]:
    """The routines that some C text calls.

    Args:
        code: C text of the functions.
        lanes: Whether there is text on vectors, too, of whatever width the compiler has.
    """
    code = list(code)
    widths = [width for width in WIDTHS if lanes or any(f"sym_sincos_{width}(" in text for text in code)]
    if not widths:
        return []
    near = Template(native_text("model/trigonometry.c.in")).substitute(far=repr(FAR), near=_near("sym_near_1"))
    parts = {"SYM_SINCOS": near}
    if any("sym_sincos_1(" in text for text in code):
        parts["SYM_SINCOS_1"] = native_text("model/sincos_one.c.in")
    parts |= {
        f"SYM_SINCOS_{width}": Template(native_text("model/sincos_block.c.in")).substitute(
            width=width,
            bytes=8 * width,
            near=_near(f"sym_near_{width}", f"sym_{width}", f"sym_{width}u", f"(sym_{width}u)", f"(sym_{width})"),
            all=" & ".join(f"near[{i}]" for i in range(width)),
        )
        for width in widths
        if width > 1
    }
    # Files of formulas are included beside each other.
    return [f"#ifndef {guard}\n#define {guard}\n{text}\n#endif\n" for guard, text in parts.items()]


def of_lanes(single: bool) -> str:
    """The routine for angles that are vectors already.

    Args:
        single: Whether lanes hold floats.
    """
    if not single:
        return native_text("model/sincos_double.c.in") + native_text("model/sincos_lanes.c.in")
    near = Template(native_text("model/sincos_single.c.in")).substitute(
        two_by_pi=repr(TWO_BY_PI),
        rounder=repr(ROUNDER),
        half_pi_0=repr(HALF_PI[0]),
        half_pi_1=repr(HALF_PI[1]),
        sine=_polynomial(SINE_SINGLE, "f"),
        cosine=_polynomial(COSINE_SINGLE, "f"),
    )
    return near + native_text("model/sincos_lanes.c.in")


def on_device(precision: Precision) -> str:
    """The routine of a graphics processor, for angles of one state."""
    if precision == "single":
        return native_text("cuda/sincos_single.cu.in")
    return Template(native_text("cuda/sincos_double.cu.in")).substitute(far=repr(FAR), near=_near("sym_near_1"))


def _near(
    name: str, real: str = "double", word: str = "uint64_t", to_word: str = "sym_word", to_real: str = "sym_real"
) -> str:
    """The routine for angles up to FAR, on numbers or on vectors.

    Args:
        name: Name of the C function.
        real: Type of its angle, sine and cosine.
        word: Type of as many whole numbers of 64 bits.
        to_word: C function or cast that turns a real into a word, bit by bit.
        to_real: C function or cast that turns a word into a real.
    """
    return Template(native_text("model/sincos.c.in")).substitute(
        name=name,
        real=real,
        word=word,
        to_word=to_word,
        to_real=to_real,
        two_by_pi=repr(TWO_BY_PI),
        rounder=repr(ROUNDER),
        half_pi_0=repr(HALF_PI[0]),
        half_pi_1=repr(HALF_PI[1]),
        half_pi_2=repr(HALF_PI[2]),
        sine=_in_pairs(SINE),
        cosine=_in_pairs(COSINE),
    )


def _in_pairs(coefficients: tuple[float, ...]) -> str:
    """(c0 + z * c1) + zz * ((c2 + z * c3) + zz * (c4 + z * c5)): a shorter wait than one after the other."""
    first, second, third = (f"({a!r} + z * {b!r})" for a, b in zip(coefficients[::2], coefficients[1::2], strict=True))
    return f"{first} + zz * ({second} + zz * {third})"


def _polynomial(coefficients: tuple[float, ...], suffix: str = "") -> str:
    """c0 + z * (c1 + ... + z * cn)."""
    text = f"{coefficients[-1]!r}{suffix}"
    for coefficient in coefficients[-2::-1]:
        text = f"{coefficient!r}{suffix} + z * {text if ' ' not in text else f'({text})'}"
    return text
