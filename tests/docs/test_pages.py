"""Every block of code on every page: Python runs, YAML is valid, commands of the shell run or are understood."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import socket
import subprocess
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from ruamel.yaml import YAML

import symofros as sf
from tests.docs.pages import ELSEWHERE, GIVEN, ROOT, TAKEN, Block, blocks, pages, unseen
from tests.docs.shell import commands, try_out
from tests.late import needs_extra
from validation.campaigns import plan
from validation.dashboard.catalogue import TOPICS

# What is not run here: quotations, and code for Node that its test runs.
LANGUAGES = {"text": "", "js": "tests/exports/wasm/test_wasm.py"}
SCHEMA = json.loads((ROOT / "symofros/description/yaml/schema.json").read_text())
# Pages whose code takes minutes: frameworks that compile and train.
LONG = {"docs/interop.md": 4}
WITH_CODE = [
    pytest.param(page, marks=pytest.mark.slow(minutes=LONG[page])) if page in LONG else page
    for page in pages()
    if blocks(page) and page not in ELSEWHERE and "tutorial/" not in page
]


def validated(block: Block, folder: Path) -> None:
    """A whole file is read; a part of a model's file fits the schema that is published for it."""
    data: Any = YAML(typ="safe").load(block.text)
    path = folder / (block.said("file: ") or "part.yaml")
    path.write_text(block.text, encoding="utf-8")
    if "symofros" in data:
        sf.compile(sf.load(path), sf.Options(backend="interpreter"))
    elif "symofros_diagram" in data:
        sf.Simulation(sf.load_diagram(path))
    elif "outputs" in data:
        sf.load_scene(path)
    else:
        entry = block.said("part of ")
        parts = {entry: data} if entry else data
        assert parts.keys() <= SCHEMA["properties"].keys(), f"{block.page}:{block.line}: entries of no model"
        for name, part in parts.items():
            jsonschema.validate(part, {**SCHEMA["properties"][name], "$defs": SCHEMA["$defs"]})


def stated(block: Block) -> None:
    """A plan of a campaign is one; other TOML is at least TOML."""
    data = tomllib.loads(block.text)
    if "kind" in data:
        plan.make(data, block.page)


def declared(block: Block) -> None:
    """C is accepted by a compiler, where there is one; the page may have exported the headers to `out`."""
    compiler = shutil.which("cc")
    if compiler is not None:
        command = [compiler, "-std=c99", "-Wall", "-Werror", "-fsyntax-only", "-Iout", "-x", "c", "-"]
        done = subprocess.run(command, input=block.text, capture_output=True, text=True)
        assert done.returncode == 0, f"{block.page}:{block.line}\n{done.stderr}"


@pytest.fixture
def folder(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of a reader who has the repository's models and the files that the page takes for granted."""
    for name, path in GIVEN.get(page, {}).items():
        shutil.copy(ROOT / path, tmp_path / name)
    for name in ("validation", "reference_models"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


@pytest.mark.parametrize("page", WITH_CODE)
def test_the_code_of_a_page_runs(page: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {"__name__": "__main__"}
    absent = ""
    for block in blocks(page):
        package = block.said("needs ")
        if not block.runs:
            continue
        if package and find_spec(package) is None:
            absent = package
            continue
        where = f"{page}:{block.line}"
        if block.language == "python":
            exec(compile("\n" * block.line + block.text, page, "exec"), names)
        elif block.language == "yaml":
            validated(block, folder)
        elif block.language == "toml":
            stated(block)
        elif block.language == "sh":
            for command in commands(block):
                try_out(command, folder)
        elif block.language == "c":
            declared(block)
        else:
            assert block.language in LANGUAGES, f"{where}: a block of language '{block.language}'"
            test = LANGUAGES[block.language]
            assert not test or page in (ROOT / test).read_text(encoding="utf-8"), f"{where}: {test} does not run it"
    if absent:  # All other blocks ran; extras of frameworks are called like their packages.
        pytest.skip(needs_extra(absent, absent))


def test_report_commands_in_the_readme_are_valid(tmp_path: Path) -> None:
    table = (ROOT / "reports/README.md").read_text(encoding="utf-8")
    stated = re.findall(r"^\| \[\w+\]\(.*?\) \| `(.*?)` \|", table, re.MULTILINE)
    assert len(stated) == len(TOPICS)
    for command in stated:
        try_out(command, tmp_path)


@pytest.mark.parametrize("page", sorted(ELSEWHERE))
def test_pages_run_by_other_tests_are_read_there(page: str, folder: Path) -> None:
    assert Path(page).name in (ROOT / ELSEWHERE[page]).read_text(encoding="utf-8")
    assert {block.language for block in blocks(page)} <= TAKEN[page]
    for block in blocks(page, "sh"):
        for command in commands(block):
            try_out(command, folder)


@pytest.mark.parametrize("page", ["docs/howto/gravity_compensation.md"])
def test_the_guides_control_loop_holds_the_weight(page: str, folder: Path) -> None:
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")
    names: dict[str, Any] = {}
    for block in blocks(page, "python"):
        exec(compile(block.text, page, "exec"), names)
    (program,) = blocks(page, "c")
    (folder / program.said("file: ")).write_text(program.text, encoding="utf-8")
    (lines,) = (block.text.splitlines() for block in blocks(page, "sh"))
    subprocess.run(shlex.split(lines[0]), check=True)
    printed = subprocess.run(["./compensate", "3"], check=True, capture_output=True, text=True).stdout.split()
    assert np.allclose([float(number) for number in printed], names["model"].gravity_force(names["q"]), atol=1e-6)
    assert " ".join(printed) in lines[1] and f"# {' '.join(printed)} N m" in "".join(
        b.text for b in blocks(page, "python")
    )


@pytest.mark.parametrize("page", ["docs/howto/controller_as_c.md"])
def test_two_processes_in_lock_step_have_the_bits_of_one_program(page: str, folder: Path) -> None:
    if shutil.which("gcc") is None or not hasattr(socket, "AF_UNIX"):
        pytest.skip("needs gcc and the sockets of POSIX")
    names: dict[str, Any] = {}
    for block in blocks(page, "python"):
        if not block.mark:
            exec(compile(block.text, page, "exec"), names)
    (program,) = (block for block in blocks(page, "c") if block.mark)
    (folder / program.said("file: ")).write_text(program.text, encoding="utf-8")
    build, lock_step, _ = blocks(page, "sh")
    ports = [free_port(), free_port()]
    text = f"{build.text}{lock_step.text}wait\n".replace("47000", ports[0]).replace("47001", ports[1])
    subprocess.run(["/bin/sh", "-e"], input=text, text=True, check=True, timeout=120)
    apart = np.array([[float(x) for x in line.strip(",").split(",")] for line in Path("apart.csv").read_text().split()])
    together = np.loadtxt("together.csv", delimiter=",", skiprows=1)[:, 1:]
    assert apart.shape == together.shape == (2001, 6)
    assert (apart == together).all()
    python = np.column_stack([names["run"][name] for name in ("plant.q", "plant.v", "controller.effort")])
    np.testing.assert_allclose(apart, python, rtol=0.0, atol=1e-11)  # Fused products, of efforts of 50 N m/rad.


def free_port() -> str:
    """A port of UDP on this machine that nobody listens to."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        asked.bind(("127.0.0.1", 0))
        return str(asked.getsockname()[1])


@pytest.mark.parametrize("page", pages())
def test_no_block_is_left_out_silently(page: str) -> None:
    assert unseen(page) == []


@pytest.mark.parametrize(
    "text",
    [
        "- an item\n\n  ```python\n  raise SystemExit\n  ```\n",
        "~~~python\nraise SystemExit\n~~~\n",
        "```{code-block} python\nraise SystemExit\n```\n",
        "```{code-cell} python\nraise SystemExit\n```\n",
        "```python\nraise SystemExit\n",
    ],
)
def test_an_unmarked_skipped_block_is_detected(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "page.md").write_text(text)
    monkeypatch.setattr("tests.docs.pages.ROOT", tmp_path)
    assert unseen("page.md")


def test_code_blocks_that_do_not_run_give_a_reason() -> None:
    unmarked = [block for page in pages() for block in blocks(page) if block.mark]
    assert all(re.match(r"(not run: .{12,}|file: [\w./]+|part of \w+|needs \w+)$", block.mark) for block in unmarked)
    left_out = [block for block in unmarked if not block.runs]
    assert len(left_out) <= 8, [f"{block.page}:{block.line}" for block in left_out]


@pytest.mark.parametrize("page", pages())
def test_links_lead_to_files_that_exist(page: str) -> None:
    text = re.sub(r"^```.*?^```$", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        assert target.startswith(("http", "mailto:")) or (ROOT / page).parent.joinpath(target).exists(), target


def test_every_page_of_the_site_is_in_a_table_of_contents() -> None:
    """A page that is in none can't be found, and ends the build of the site."""
    docs = ROOT / "docs"
    site = {path for path in docs.rglob("*.md") if path.relative_to(docs).parts[0] not in ("ci", "site_extensions")}
    listed = {docs / "index.md"}
    for page in site:
        for table in re.findall(
            r"^```\{toctree\}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
        ):
            entries = [line for line in table.splitlines() if line and not line.startswith(":")]
            listed |= {(page.parent / f"{entry}.md") for entry in entries}
    assert sorted(site - listed) == []


def test_the_first_readme_example_is_short_and_prints_what_it_states(capsys: pytest.CaptureFixture[str]) -> None:
    first, *_ = blocks("README.md", "python")
    assert len(first.text.strip().splitlines()) <= 25
    exec(compile(first.text, "README.md", "exec"), {})
    assert "(1000, 2, 2) (6, 2)" in capsys.readouterr().out
