"""Fixtures that every test may use."""

from __future__ import annotations

import dataclasses
import datetime
import functools
import gc
import os
import shutil
import subprocess
import sys
import zlib
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from typing import Any

import hypothesis
import numpy as np
import pytest

from symofros.base.options import Options
from symofros.harness import claim
from tests import draw
from tests.absent import CACHED, by_need, summary
from tests.progress import Progress

# The names of a checkout, whatever is installed; under those of a wheel, which pages and examples have, they are the
# same modules.
claim("validation")
claim("reference_models")

# Tests assert no time; Hypothesis would, of each example, and a machine that does other work exceeds it.
hypothesis.settings.register_profile("untimed", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow])
hypothesis.settings.load_profile("untimed")

# Compiled models are kept between runs and shared by parallel workers, apart from the user's own cache.
_CACHE = Path(__file__).parent.parent / ".pytest_cache"
os.environ.setdefault("SYMOFROS_CACHE", str(_CACHE / "models"))
# zig would use the home folder, which a machine of CI may lack; it does not end where it can't be made.
os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(_CACHE / "zig"))
# A worker a core: linear algebra with a thread for each core would have them wait for each other at full load.
for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")
# Nothing here is drawn by MuJoCo, whose import would look for a display in every process.
os.environ.setdefault("MUJOCO_GL", "disable")

# Tests start some hundred processes: each would translate the package's text again where bytecode is not kept.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Compiling is half of a run's time, and half of that is optimisation. Tests of other things than generated code and its
# compilation do without, but for files that are drawn by the day, for runs with --slow or a part of it and for
# benchmarks, which compile as users do. Tests of motions, whose models are many and small, have them on tape,
# with the bits of C, where they ask for no backend.
_STATED_FLAGS = os.environ.get("SYMOFROS_CFLAGS")
_OPTIMISED = {"generator", "native"}
_ON_TAPE = {"blocks", "diagrams", "simulation"}
_BACKEND = [field.name for field in dataclasses.fields(Options)].index("backend")

# What every worker needs, at a first run ten seconds of a compiler each: made while they collect.
_AHEAD = """
from concurrent.futures import ThreadPoolExecutor
from symofros.generator.codegen.tape import machine_text
from symofros.runtime.calls.binding import native_library
from symofros.runtime.calls.tape import tape_machine
with ThreadPoolExecutor() as pool:
    pool.submit(native_library), pool.submit(tape_machine, machine_text())
"""

# The browser's tests name Playwright's types as they are collected.
_PLAYWRIGHT = find_spec("playwright") is not None
collect_ignore = [] if _PLAYWRIGHT else ["studio/editor/browser"]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="also run what a run leaves out for its time")
    parser.addoption("--part", metavar="I/N", help="only every N-th of the tests, from the I-th on")
    parser.addoption("--draw", metavar="WORD", help="what long tests and flags are drawn by; else the date")
    parser.addoption("--update-seconds", action="store_true", help="write what a case takes to tests/seconds.txt")
    parser.addoption("--tools", action="store_true", help="also run tests of programs that .ci/run installs")
    parser.addoption("--browser", action="store_true", help="also run tests that look at pages with Chromium")
    parser.addoption("--update-golden", action="store_true", help="rewrite the expected texts that tests compare with")


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--browser") and not _PLAYWRIGHT:
        raise pytest.UsageError("--browser needs Playwright: pip install -e '.[dev]'")
    if config.option.draw is None:  # Workers are given it, so that midnight does not divide them.
        config.option.draw = datetime.datetime.now(datetime.UTC).date().isoformat()
    if config.getoption("--update-seconds") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(draw.Measurement())


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Freeze all objects made during collection: the garbage collector need not look at them."""
    gc.disable()
    if session.config.getoption("numprocesses", None) and session.config.pluginmanager.has_plugin("terminalreporter"):
        session.config.pluginmanager.register(Progress(session.config.get_terminal_writer()))
        if _folders(session.config):
            ahead = partial(subprocess.run, [sys.executable, "-c", _AHEAD], capture_output=True)
            Thread(target=ahead, daemon=True).start()


@pytest.hookimpl(tryfirst=True)
def pytest_collection(session: pytest.Session) -> None:
    """Workers import a share of the files first: at a first run, each would translate all of them at the same time."""
    worker = getattr(session.config, "workerinput", None)
    if worker is None or not _folders(session.config):
        return
    root = Path(__file__).parent
    files = {file for argument in session.config.args for file in Path(argument).absolute().rglob("test_*.py")}
    files -= {file for name in collect_ignore for file in (root / name).glob("*.py")}
    for file in sorted(files)[int(worker["workerid"].removeprefix("gw")) :: worker["workercount"]]:
        with suppress(Exception, pytest.skip.Exception):  # Collecting it says what is wrong.
            import_module(".".join(file.relative_to(root.parent).with_suffix("").parts))


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """In one line, how much was left out for which option and for which extra; which tests, in pytest's cache."""
    skipped = [
        (report.nodeid, str(report.longrepr[2]))
        for report in terminalreporter.stats.get("skipped", [])
        if isinstance(report.longrepr, tuple)
    ]
    needs = by_need(skipped)
    if said := summary(needs):
        terminalreporter.write_line(said)
    if terminalreporter.stats.keys() & {"failed", "error"}:
        terminalreporter.write_line(
            f"the same cases and flags of the compiler again: --draw {config.getoption('--draw')}"
        )
    cache = getattr(config, "cache", None)
    if cache is not None:
        cache.set(CACHED, {need: sorted(set(tests)) for need, tests in needs.items() if need.startswith("extra ")})


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()
    # Models and modules that live on make each garbage collection expensive; graphs of expressions, made by the
    # hundred thousand, hold no garbage. Collecting less often saves a tenth of a run's time.
    gc.set_threshold(50_000)


def _folders(config: pytest.Config) -> bool:
    """Whether a run is of folders, and not of files and tests that someone works on."""
    return any(Path(argument).is_dir() for argument in config.args)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Workers of `-n auto`: one a core for folders; none for files and single tests, or where output is to be seen."""
    if not _folders(config) or config.getoption("capture") == "no" or config.getoption("benchmark_enable"):
        return 0
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _draw(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the cases that are not drawn as slow; cases asked for by their ids stay, and one of each test of a file."""
    if any("[" in argument for argument in config.args):
        return
    cases = [item.nodeid for item in items if item.get_closest_marker("slow") is None]
    seconds = draw.read(draw.FILE.read_text())
    gone = draw.left_out(cases, seconds, config.getoption("--draw"), named=not _folders(config))
    for item in items:
        if item.nodeid in gone:
            item.add_marker("slow")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    _draw(config, items)
    if config.getoption("--part"):
        _keep_a_part(config, items)
    needs = {"slow": "left out for its time", "tools": "needs programs of the system", "browser": "needs Chromium"}
    for word, why in needs.items():
        if not config.getoption(f"--{word}"):
            for item in items:
                if item.get_closest_marker(word) is not None:  # Its keywords have the names of folders, too.
                    item.add_marker(pytest.mark.skip(reason=f"{why}; run with --{word}"))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Backend and flags of the compiler for a test and its fixtures; flags for processes that it starts, too."""
    if _STATED_FLAGS is None:
        asked = any(map(item.config.getoption, ("--slow", "--benchmark-enable")))
        file = item.path.relative_to(Path(__file__).parent)
        drawn = draw.is_optimised(file.as_posix(), item.config.getoption("--draw"))
        as_users_do = asked or drawn or file.parts[0] in _OPTIMISED
        os.environ["SYMOFROS_CFLAGS"] = "" if as_users_do else "-O0"
        stated: Any = Options.__init__
        backend = "tape" if file.parts[0] in _ON_TAPE and not as_users_do else "c"
        stated.__defaults__ = (*stated.__defaults__[:_BACKEND], backend, *stated.__defaults__[_BACKEND + 1 :])


def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """A file's own caches end with it: the machine of tapes holds a thousand functions of models that live."""
    module = getattr(item, "module", None)
    if module is not None and module is not getattr(nextitem, "module", None):
        for value in vars(module).values():
            if isinstance(value, functools._lru_cache_wrapper) and value.__module__ == module.__name__:
                value.cache_clear()


def _keep_a_part(config: pytest.Config, items: list[pytest.Item]) -> None:
    """One of N parts of about equal time, without tests that state their minutes, which take as long as a part."""
    index, count = map(int, config.getoption("--part").split("/"))
    kept, others = [], []
    for item in items:
        stated = (marker := item.get_closest_marker("slow")) is not None and marker.kwargs
        in_part = not stated and zlib.crc32(item.nodeid.encode()) % count == index % count
        (kept if in_part else others).append(item)
    config.hook.pytest_deselected(items=others)
    items[:] = kept


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20261121)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """A browser, one for all tests: Playwright has one loop a process. $CHROMIUM names its program."""
    names = ("chromium", "chromium-browser", "google-chrome")
    program = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    assert program, "no Chromium: install it, or name it in $CHROMIUM"
    with import_module("playwright.sync_api").sync_playwright() as playwright:
        # Pages in three dimensions are drawn without a graphics card.
        drawn = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
        # A browser binds a socket in its TMPDIR, whose name may be long; a socket's may not.
        environment = {**os.environ, "TMPDIR": "/tmp"}
        # Five seconds, the bound that expectations have of themselves, are too few where others want the cores.
        import_module("playwright.sync_api").expect.set_options(timeout=60_000)
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", *drawn], env=environment)
        yield browser
        browser.close()
