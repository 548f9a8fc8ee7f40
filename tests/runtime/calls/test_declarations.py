"""The C interface in Python: parsed once a machine, and the same wherever it comes from."""

import re
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import pytest

from symofros.native import native_text
from symofros.runtime.calls import declarations
from symofros.runtime.calls.binding import constants
from symofros.runtime.calls.declarations import interface

interface_anew = declarations._interface.__wrapped__
STRUCTS = ("sym_model", "sym_function", "sym_lanes", "sym_strided")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    return tmp_path


def test_a_cached_interface_equals_the_parsed_one(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    parsed, kept = interface_anew(), interface_anew()
    assert [path.suffix for path in sorted(folder.iterdir())] == [".digest", ".py"]
    for struct in STRUCTS:
        assert parsed.sizeof(struct) == kept.sizeof(struct) > 0
        assert [name for name, _ in kept.typeof(struct).fields] == [name for name, _ in parsed.typeof(struct).fields]
    assert "".join(capfd.readouterr()) == ""


def test_a_damaged_declaration_file_is_parsed_again(folder: Path) -> None:
    interface_anew()
    (kept,) = folder.glob("*.py")
    sound = kept.read_text()
    kept.write_text("raise SystemExit('damaged')\n")
    assert interface_anew().sizeof("sym_model") > 0 and kept.read_text() == sound


def test_constants_match_the_headers() -> None:
    enums = re.findall(r"typedef enum (?:.|\n)*?}", native_text("stepping/symofros_stepper.h"))
    stated = re.findall(r"\b(SYM_\w+) *= *(-?\d+)", "".join(enums))
    assert len(stated) > 2
    assert {name: constants()[name] for name, _ in stated} == {name: int(value) for name, value in stated}


def test_threads_that_ask_at_the_same_time_have_one_interface(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two would have types of their own, and pointers of one are refused by the other."""
    started = threading.Event()
    made: list[object] = []

    def slowly() -> object:
        started.set()
        time.sleep(0.05)
        made.append(object())
        return made[-1]

    monkeypatch.setattr(declarations, "_interface", cache(slowly))
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(interface)
        assert started.wait(60.0)
        assert interface() is first.result() and len(made) == 1


WARM = """
import sys
import symofros as sf
model = sf.compile(sf.load(sys.argv[1]))
print(model.mass_matrix(model.neutral()).shape)
loaded = {name.split(".")[0] for name in list(sys.modules)}  # Threads that compile may still import.
slow = loaded & {"pydantic", "ruamel", "pycparser", "http", "ssl", "sympy", "scipy"}
print(*sorted(slow), file=sys.stderr)
"""


def test_a_compiled_urdf_loads_no_parser_of_yaml_nor_of_c() -> None:
    """The first second of a user: each of those takes a twentieth to a fifth of it."""
    arm = Path(__file__).parents[3] / "reference_models/arm.urdf"
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", WARM, str(arm)], capture_output=True, text=True)
        assert done.returncode == 0 and done.stdout == "(3, 3)\n", done.stderr
    assert done.stderr.strip() == ""
