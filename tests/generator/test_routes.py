"""Routes: what the table says is what decides, what is listed is what is generated, and options obey."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

import symofros as sf
from reference_models import MODELS
from reference_models.closed.four_bars import n_four_bar
from reference_models.rigid.random_tree import random_tree
from symofros.base import routes
from symofros.base.route import Choice, Route
from symofros.base.routes import ROUTES
from symofros.compiler import Compilation
from symofros.generator import units
from symofros.generator.codegen.model import model_text
from tests.generator.codegen.limbs.test_plan import quadruped

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/operations.md"
ROWS = [route for methods in ROUTES.values() for route in methods.values()]
FORWARD, SLOPES, BY_PAR = "forward_dynamics", "forward_dynamics_derivatives", "forward_dynamics_by_par"
REVERSE, HESSIAN = "forward_dynamics_vjp", "forward_dynamics_hessian"
# Of each row: a function, a model where it takes that route, and the options that this needs.
CASES: dict[tuple[str, str], tuple[str, str, dict[str, object]]] = {
    (quantity, method): (function, name, options)
    for quantity, method, function, name, options in YAML(typ="safe").load(Path(__file__).with_name("routes.yaml"))
}


def system(name: str) -> sf.System:
    made: dict[str, Callable[[], sf.System]] = {"many four-bars": lambda: n_four_bar(20), "quadruped": quadruped}
    return made[name]() if name in made else MODELS[name]


def choices_of(model: sf.Model, function: str) -> dict[str, Choice]:
    """The choices of a function by quantity."""
    return {choice.quantity: choice for choice in model.routes[function]}


def test_each_row_has_a_case() -> None:
    assert CASES.keys() == {(row.quantity, row.method) for row in ROWS}


@pytest.mark.parametrize("row", CASES, ids=" - ".join)
def test_each_case_takes_its_route_and_a_contrasting_model_another(
    row: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a quantity has one method there is no other case; elsewhere each case takes none of the other rows."""
    function, name, options = CASES[row]
    if row[1] == "routine":
        monkeypatch.setattr(routes, "MOST_STEPS", -1)
    if row[1] == "sweeps":
        monkeypatch.setattr(routes, "SWEPT", -1)
    choice = choices_of(sf.compile(system(name), sf.Options(**options)), function)[row[0]]  # type: ignore[arg-type]
    assert choice.method == row[1] and choice.route in ROWS
    assert choice.asked == bool(options and row[0] != "derivatives of constrained motion")
    assert choice.route not in choice.others


def test_the_last_route_of_each_quantity_applies_always() -> None:
    for quantity, methods in ROUTES.items():
        unconditional = [row.method for row in methods.values() if row.applies == "always"]
        assert unconditional, quantity
        assert [*methods.values()][-1].applies == "always" or quantity == "values by vectors"  # Scalars: no vectors.


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.quantity} - {row.method}")
def test_cited_theory_sections_exist(row: Route) -> None:
    page, section, *equations = row.theory.split(", ")
    text = (ROOT / "docs/theory" / page).read_text(encoding="utf-8")
    assert re.search(rf"^##+ {re.escape(section)}\.? ", text, re.MULTILINE), row.theory
    for number in re.findall(r"\(\d+a?\)", " ".join(equations)):
        assert re.search(rf" {re.escape(number)}$", text, re.MULTILINE), f"{row.theory}: {number}"


@pytest.mark.parametrize("way", ["articulated", "factors"])
def test_all_relatives_of_forward_dynamics_follow_the_option(way: str) -> None:
    """First derivatives, in forward and reverse mode, of parameters too; second ones say that they can't."""
    model = sf.compile(MODELS["heavy_top"], sf.Options(forward_dynamics=way))  # type: ignore[arg-type]
    for function in (FORWARD, SLOPES, BY_PAR, REVERSE):
        assert model.routes[function][0].method == way, function
    assert model.routes[HESSIAN][0].route.chosen.endswith("whatever is asked of the motion")
    together = (FORWARD, SLOPES, REVERSE)
    chosen = sf.Options(together, (), forward_dynamics=way, backend="interpreter")  # type: ignore[arg-type]
    of_chosen = sf.compile(MODELS["heavy_top"], chosen).routes
    assert [of_chosen[function][0].method for function in together] == [way] * 3


@pytest.mark.parametrize("function", [FORWARD, SLOPES, REVERSE])
def test_graphics_processors_take_the_method_of_the_function(function: str) -> None:
    """The kernel's text is another one by each method, and that of "auto" is the one that is listed."""
    texts = {}
    for way in ("articulated", "factors", "auto"):
        made = Compilation(MODELS["heavy_top"], sf.Options(forward_dynamics=way))
        code = made._units(None).device_code((function, ""), "double").text
        texts[way] = code.replace(made.record.hash, "")
    method = sf.compile(MODELS["heavy_top"]).routes[function][0].method
    assert texts["articulated"] != texts["factors"] and texts["auto"] == texts[method]


# What the text of a function has if it tells one of these quantities with their methods, and only then.
MARKERS: dict[str, set[tuple[str, str]]] = {
    r"\bsym_system_solve\b": {("constrained motion", "multipliers")},
    r"\bsym_null_space\b": {("constrained motion", "null_space")},
    r"static const struct sym_sparse sparse": {("constrained system", "sparse")},
    r"\bsym_(differentiate|transpose)\(": {
        ("derivatives of the acceleration", "routine"),
        ("derivatives of constrained motion", "multipliers"),
    },
    r"\bsym_respond\(": {("derivatives of the acceleration", "sweeps")},
    r"\bsym_hessian\(": {("second derivatives of the motion", "multipliers")},
    r"#if SYM_PART < 8": {("values by vectors", "by processor")},
    r"\bsym_pack \w+ =": {("values by vectors", "packs"), ("values by vectors", "by processor")},
    r"for \(.* < \d+; ": {("equal parts", "loops")},
    r"\bsym_(pair|quad) \w+ =": {("equal parts", "limbs")},
}


def check_markers(of: sf.System, function: str, asked: dict[str, object]) -> None:
    """What a model tells of a function is in its text, and what it does not tell is not."""
    options = sf.Options((function,), (), **asked)  # type: ignore[arg-type]
    made = Compilation(of, options)
    text = model_text(made.program, made.record, "test", packs="where they pay").code
    text = text[text.index("_init_par(") :]  # Without the routines that stand before it.
    choices = {(choice.quantity, choice.method) for choice in sf.compile(of, asked_for(options)).routes[function]}
    for marker, rows in MARKERS.items():
        assert bool(re.search(marker, text)) == bool(choices & rows), (function, marker, choices)


def asked_for(options: sf.Options) -> sf.Options:
    """The same, of a model that compiles what is called."""
    return replace(options, functions=None, frames=None)


@settings(max_examples=2)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 6))
def test_reported_routes_of_random_trees_match_the_text(seed: int, n: int) -> None:
    """The method of the acceleration by text: that of "auto" is the one of the method choices_of, to the character."""
    tree = random_tree(seed, n)
    for function in (FORWARD, SLOPES):
        check_markers(tree, function, {})
    method = choices_of(sf.compile(tree), FORWARD)["acceleration of trees"].method
    texts = {}
    for way in ("auto", "articulated", "factors"):
        made = Compilation(tree, sf.Options((FORWARD,), (), forward_dynamics=way))
        texts[way] = made.source().replace(made.record.hash, "")
    assert texts["auto"] == texts[method]


@pytest.mark.parametrize(
    ("name", "function", "asked"),
    [
        *(("four_bar", function, {}) for function in (FORWARD, SLOPES, REVERSE)),
        ("four_bar", FORWARD, {"constraints": "null_space"}),
        ("many four-bars", FORWARD, {}),
        ("many four-bars", "constraint", {}),
        ("quadruped", "dynamics", {}),
        ("double_pendulum", HESSIAN, {}),
    ],
)
def test_reported_routes_match_the_text(name: str, function: str, asked: dict[str, object]) -> None:
    check_markers(system(name), function, asked)


def test_cached_models_report_the_same_routes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cold, warm, and before the first call; a warm model has generated nothing to be called."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    ahead = sf.compile(MODELS["cart_pole"])
    stated_ahead = ahead.routes[FORWARD]
    assert dict(ahead.routes) == {} and len(ahead.routes) == 0
    cold = sf.compile(MODELS["cart_pole"])
    cold.forward_dynamics([0.1, 0.2], [0.0, 0.0], np.zeros(cold.nu))
    monkeypatch.setattr(units, "model_source", lambda *_, **__: pytest.fail("a known model was generated again"))
    warm = sf.compile(MODELS["cart_pole"])
    warm.forward_dynamics([0.1, 0.2], [0.0, 0.0], np.zeros(warm.nu))
    assert dict(warm.routes) == dict(cold.routes) == {FORWARD: stated_ahead}
    assert str(warm.routes).startswith(f"{FORWARD}\n  acceleration of trees: ")


def page_table() -> str:
    """The table as the page shows it."""
    lines = [
        "| quantity | method | applies | is taken when | keeps | theory | asked for by |",
        "|---|---|---|---|---|---|---|",
    ]
    for quantity, methods in ROUTES.items():
        for i, row in enumerate(methods.values()):
            asked = f"`{row.option}`" if row.option else ""
            cells = ["" if i else quantity, row.method, row.applies, row.chosen, row.accuracy, row.theory, asked]
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def test_the_page_shows_the_table(request: pytest.FixtureRequest) -> None:
    page = PAGE.read_text(encoding="utf-8")
    (shown,) = re.findall(r"^\| quantity \| method \|(?:.*\n)+?(?=\n)", page, re.MULTILINE)
    if request.config.getoption("--update-golden"):
        PAGE.write_text(page.replace(shown, page_table() + "\n"), encoding="utf-8")
    else:
        assert shown == page_table() + "\n", "python -m pytest tests/generator/test_routes.py --update-golden"
