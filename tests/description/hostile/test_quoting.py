"""Names between backquotes: what is read, printed, and refused as unclear."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import symofros as sf
from symofros.base.names import RESERVED, coordinate_of, rate_symbol, speed_of, symbol_in, symbol_of
from symofros.description.parser import parse
from symofros.description.quoting import readings, text_among, with_quotes
from symofros.expr.expression import CONSTANTS, Expression, always_quoted, spelled
from tests.description.hostile.hostile_names import HOSTILE

NAMES = st.one_of(
    st.sampled_from(HOSTILE),
    st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]) | st.sampled_from(" `d.[]0-*"), min_size=1),
).filter(str.isprintable)
SYMBOLS = st.one_of(NAMES.map(symbol_of), st.builds(rate_symbol, NAMES, st.integers(1, 2)), st.just("t"))


@st.composite
def formulas(draw: st.DrawFn, depth: int = 3) -> Expression:
    kind = draw(st.sampled_from(["symbol", "number", *(["add", "sub", "mul", "div", "pow", "sin"] if depth else [])]))
    if kind == "number":
        return Expression("number", number=draw(st.floats(0, 1e6)))
    if kind == "symbol":
        return Expression("symbol", name=draw(SYMBOLS))
    return Expression(kind, tuple(draw(formulas(depth=depth - 1)) for _ in range(1 if kind == "sin" else 2)))


@given(formulas())
def test_printed_formulas_parse_to_the_same_formula(formula: Expression) -> None:
    assert parse(str(formula)) == formula
    assert parse(formula.text(always_quoted)) == formula or formula.symbols() & {"t"}


@given(NAMES)
def test_a_quoted_name_is_that_name(name: str) -> None:
    assert parse(spelled(symbol_of(name))).symbols() == {symbol_of(name)} - {*CONSTANTS}
    rate = parse(rate_symbol(name))
    assert rate.symbols() == {rate_symbol(name)} and symbol_in(str(rate)) == rate_symbol(name)


@given(NAMES, NAMES)
def test_names_are_found_with_and_without_quotes(name: str, other: str) -> None:
    assume(name != other and f"d{name}" != other)
    known = [name, other]
    assert coordinate_of(name, known) == name and speed_of(name, known) == name
    quoted = f"`{name.replace('`', '``')}`"
    if quoted not in known:
        assert coordinate_of(quoted, known) == name
    if f"d{quoted}" not in known and quoted not in known:
        assert speed_of(f"d{quoted}", known) == name


def test_reserved_names_are_time_and_the_constants() -> None:
    assert RESERVED == {"t", *CONSTANTS}


def test_unquoted_names_with_operators_are_found_and_quoted() -> None:
    known = ["a", "b", "a-b", "left-hip", "dleft-hip", "1", "c d"]
    assert readings("2*a-b + 1", known) == [("a-b", "2*`a-b` + 1")]
    assert not readings("2*a - b", known) and not readings("`a`-`b`", known) and not readings("sin(1)", known)
    assert with_quotes("-20*left-hip - 2*dleft-hip", known) == "-20*`left-hip` - 2*`dleft-hip`"
    assert with_quotes("c d + `c d`", known) == "`c d` + `c d`" and with_quotes("2*e-f", known) == ""
    assert text_among(parse("a/b"), ["a/b", "a", "b"], ()) == "`a`/`b`"


def hips() -> sf.System:
    joints = ("left-hip", "a", "b", "a-b", "oor", "door", "t")
    bodies = [
        sf.RigidBody(
            f"l{k}", sf.Joint(name, "revolute", "world", axis=(0, 1, 0)), sf.Inertia(1, (0.1, 0, 0), (1, 1, 1))
        )
        for k, name in enumerate(joints)
    ]
    return sf.System("hips", bodies, inputs=[sf.Input("sin"), sf.Input("u/1")])


def test_an_ambiguous_formula_is_refused_in_a_description() -> None:
    joint = sf.Joint("c", "revolute", effort=("2*a-b",))
    with pytest.raises(sf.DescriptionError, match="could also mean 'a-b'"):
        sf.compile(hips().with_bodies(sf.RigidBody("l9", joint, sf.Inertia(1, (0, 0, 0), (1, 1, 1)))))


def test_unambiguous_formulas_are_accepted() -> None:
    texts = ["`left-hip` + 10*d`left-hip`", "`a-b`", "a - b", "`a`-`b`", "`door`", "d`oor`", "t + `t`", "`sin` + `u/1`"]
    model = sf.compile(hips(), sf.Options(backend="interpreter"))
    q, u, v = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], [1.5, 2.5], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]
    kernel = model.formulas(texts, derivatives=False)
    (values,) = kernel.run(
        1, kernel.prepare(np.zeros((1, 0))), [np.array([q]), np.array([v]), np.array([u]), np.array([[9.0]])]
    )
    expected = [1.0 + 10 * 0.1, 4.0, 2.0 - 3.0, 2.0 - 3.0, 6.0, 0.5, 9.0 + 7.0, 1.5 + 2.5]
    np.testing.assert_allclose(values[0], expected, rtol=1e-15)


def test_the_remedy_for_an_undeclared_symbol_is_to_correct_or_declare_it() -> None:
    body = sf.RigidBody("a", sf.Joint("q1", "revolute"), sf.Inertia("m*L1", (0, 0, 0), (1, 1, 1)))
    with pytest.raises(sf.DescriptionError) as caught:
        sf.compile(sf.System("s", [body], parameters=[sf.Parameter("m", 1.0), sf.Parameter("p1", 1.0)]))
    assert caught.value.problem.remedy == "did you mean 'p1'? Otherwise declare it under parameters: L1"


def test_speeds_in_conditions_and_virtual_power_use_formula_syntax() -> None:
    joints = [sf.Joint(name, "revolute") for name in ("oor", "door", "left-hip")]
    bodies = [sf.RigidBody(f"b{i}", joint, sf.Inertia(1.0, (1, 0, 0))) for i, joint in enumerate(joints)]
    for key in ("d`oor`", "d`left-hip`"):
        bound = sf.Nonholonomic("c", ((key, 1.0), ("ddoor", 1.0)))
        model = sf.compile(sf.System("s", bodies, constraints=(bound,)), sf.Options(backend="interpreter"))
        G = model.constraint_jacobian(np.zeros(3))[0]
        assert G.tolist() == [float(key == "d`oor`"), 1.0, float(key == "d`left-hip`")]
