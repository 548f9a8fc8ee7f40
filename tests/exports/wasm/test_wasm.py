"""WebAssembly modules: the bits of native C under Node and wasmtime; a page that simulates by itself."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.exports.wasm import wasm
from symofros.native import native_text
from tests.docs.pages import blocks
from tests.exports.cases import PLANAR, need, run
from tests.late import require
from tests.studio.waiting import until

# The double as 16 hexadecimal digits, so that no digit is lost on the way.
PROGRAM = Path(__file__).with_name("ask.mjs.in").read_text()


# How many pixels of the plot have the colours of "speed of q1" and of "q1".
PLOTTED = Path(__file__).with_name("plotted.js").read_text()


def doubles(words: list[str]) -> np.ndarray:
    return np.array([int(word, 16) for word in words], dtype=np.uint64).view(np.float64)


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flexible robot with inputs; compiling for WebAssembly the first time takes a minute or two."""
    folder = tmp_path_factory.mktemp("package") / "wasm"
    sf.export(PLANAR, "wasm", folder, start={"q1": 0.4, "dq1": 1.0}, dt=1e-3)
    return folder


@pytest.fixture(scope="module")
def answers(package: Path, native: dict[str, Any]) -> dict[str, Any]:
    need("node")
    (package / "ask.mjs").write_text(PROGRAM.replace("NAME", "planar"))
    given = {key: native[key].ravel().tolist() for key in ("q", "v", "u")} | {"n": len(native["q"]), "t": 0.25}
    return json.loads(run("node", "ask.mjs", json.dumps(given), cwd=package))  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def native() -> dict[str, Any]:
    """Random states and the interpreter's numbers, which C without fused products has bit for bit."""
    model = sf.compile(PLANAR, sf.Options(backend="interpreter"))
    rng = np.random.default_rng(5)
    states = [model.random_state(rng) for _ in range(9)]
    q, v = (np.array(each) for each in zip(*states, strict=True))
    u = rng.standard_normal((9, model.nu))
    return {"q": q, "v": v, "u": u, **dict(zip("MhQ", model.dynamics(q, v, u), strict=True))}


@pytest.mark.tools
def test_wasm_results_equal_native_bits(answers: dict[str, Any], native: dict[str, Any]) -> None:
    """Odd numbers of states: one of two lanes is left over at the end."""
    assert answers["selftest"] == 0.0
    for name in "MhQ":
        np.testing.assert_array_equal(doubles(answers["batch"][name]), native[name].ravel())
        np.testing.assert_array_equal(doubles(answers["one"][name]), native[name][0].ravel())


@pytest.mark.tools
def test_the_code_of_the_page_on_exports_runs(package: Path, native: dict[str, Any]) -> None:
    need("node")
    (block,) = (one for one in blocks("docs/exports.md", "js") if "planar_robot" in one.text)
    load, *lines = block.text.splitlines()
    given = [f"const {key} = {native[key][0].tolist()};" for key in ("q", "v", "u")]
    assert "./robot/planar_robot.mjs" in load
    program = [load.replace("robot/planar_robot", "planar"), *given, *lines, "console.log(M.length, robot.t, batch.n)"]
    (package / "page.mjs").write_text("\n".join(program))
    entries, t, *_ = run("node", "page.mjs", cwd=package).split()
    assert int(entries) == native["M"][0].size and float(t) == 2.0


@pytest.mark.tools
def test_a_wasm_run_matches_strict_native_code(answers: dict[str, Any], tmp_path: Path) -> None:
    sf.export(PLANAR, "c", tmp_path, start={"q1": 0.4, "dq1": 1.0}, dt=1e-3)
    sources = sorted(path.name for path in tmp_path.glob("*.c"))
    run("gcc", "-std=c99", "-O1", "-ffp-contract=off", *sources, "-lm", "-o", "example", cwd=tmp_path)
    lines = [line.split() for line in run("./example", "0.25", "0.001", "--fast", cwd=tmp_path).splitlines()]
    reported = {words[0]: np.array(list(map(float, words[1:]))) for words in lines if words[0] in ("q", "v")}
    for name in "qv":
        np.testing.assert_array_equal(doubles(answers["end"][name]), reported[name])


@pytest.mark.tools
def test_wrong_names_and_sizes_are_refused(answers: dict[str, Any]) -> None:
    unknown, parameters, misspelt, size, number, memory, freed, *gone = answers["refusals"]
    assert "no function 'mass'" in unknown and "forward_dynamics" in unknown
    # They were passed over: accelerations at L = 1.2 m were those of the default, 0.8 m, 52 % off.
    assert "dynamics takes no 'par'" in parameters and "an instance" in parameters and "takes no 'qdot'" in misspelt
    assert "'q' has 5 numbers; it takes 2" in size
    assert "1.5 states; it takes a whole number" in number
    assert "no memory for" in memory and "the batch was freed" in freed
    assert gone == ["the instance was freed"] * 5  # Of address zero, memory of others would be read and written.


@pytest.mark.tools
def test_reused_memory_does_not_grow(answers: dict[str, Any]) -> None:
    first, second, third = answers["memory"]
    assert first == second == third < 2**25


@pytest.mark.tools
def test_arrays_of_a_prepared_batch_survive_memory_growth(answers: dict[str, Any]) -> None:
    """An array that memory has left is refused as an input; one that is taken anew has the numbers of before."""
    before, refused, after, freed = answers["grown"]
    assert before == after and "memory has grown since q were taken" in refused and "the batch was freed" in freed


@pytest.mark.tools
def test_wasmtime_runs_the_module_without_imports(package: Path) -> None:
    """Without a single import: any runtime will do."""
    wasmtime = require("wasmtime", "dev")
    store = wasmtime.Store()
    module = wasmtime.Module.from_file(store.engine, str(package / "planar.wasm"))
    assert not module.imports
    exports = wasmtime.Instance(store, module, []).exports(store)
    exports["_initialize"](store)
    assert exports["js_selftest"](store) == 0.0


@pytest.mark.tools
def test_the_wasm_package_passes_its_selftest_and_is_small(package: Path) -> None:
    need("node")
    assert run("node", "selftest.mjs", cwd=package).startswith("selftest 0.000e+0")
    assert (package / "planar.wasm").stat().st_size < 200_000


@pytest.mark.tools
def test_requested_functions_are_in_the_module(tmp_path: Path) -> None:
    need("node")
    asked = ["mass_matrix", "forward_dynamics_derivatives", "inverse_dynamics_vjp", "joint_wrenches"]
    sf.export(MODELS["double_pendulum"], "wasm", tmp_path, functions=asked)
    assert run("node", "selftest.mjs", cwd=tmp_path).startswith("selftest 0.000e+0")
    types = next(tmp_path.glob("*.d.ts")).read_text()
    assert all(f'"{name}"' in types for name in asked)


@pytest.mark.tools
@pytest.mark.browser
def test_the_page_simulates_without_a_server(package: Path, chromium: Any) -> None:
    page = chromium.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto((package / "index.html").as_uri())
    until(page, lambda: bool(page.evaluate("parseFloat(document.getElementById('time').textContent) > 0.3")))
    colours = page.evaluate(
        "new Set(new Uint32Array(document.querySelector('canvas').getContext('2d')"
        ".getImageData(0, 0, 800, 600).data.buffer)).size"
    )
    page.get_by_role("checkbox", name="speed of q1").check()
    page.get_by_role("checkbox", name="q1", exact=True).uncheck()
    until(page, lambda: (drawn := page.evaluate(PLOTTED))["speed"] > 20 and drawn["angle"] == 0)
    page.get_by_role("button", name="Pause").click()
    drawn = page.evaluate(PLOTTED)
    value = float(page.locator("#signals label", has_text="speed of q1").locator("output").inner_text())
    nameless = page.evaluate("[...document.querySelectorAll('input')].filter((x) => !x.ariaLabel).length")
    page.close()
    assert not faults and colours > 2 and nameless == 0
    # The colour of the third signal chosen is there, that of the first no longer is; numbers stand beside the names.
    assert drawn["speed"] > 20 and drawn["angle"] == 0 and np.isfinite(value)


def test_without_zig_the_remedy_names_the_extra(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(wasm.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(sf.CompileError, match=r"pip install 'symofros\[zig\]'"):
        sf.export(PLANAR, "wasm", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_names_cannot_end_the_script_of_the_page() -> None:
    assert "<" not in wasm.as_json({"name": "</script><!--<script"})


def test_each_failure_status_has_a_message() -> None:
    """As the header states them, one for each negative status."""
    header = native_text("stepping/symofros_stepper.h")
    codes = re.findall(r"SYM_\w+ = (-\d+)", header)
    words = wasm.statuses()
    assert list(words) == codes and words["-7"] == "a beam is bent beyond second-order theory"
    assert "STATUSES[status]" in native_text("exports/symofros_wasm.mjs")
