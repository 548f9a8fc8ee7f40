"""Scripts in fewer words: what they compute stays, and those of the report are as short as they are said to be."""

from __future__ import annotations

import statistics
from pathlib import Path

import numpy as np
import pytest

from validation.engines.models.formats import formats, texts
from validation.engines.models.kinds import tree_of
from validation.engines.models.readers import readings
from validation.engines.plugins import OWN
from validation.engines.proving import closing, files
from validation.engines.proving.folding import folded, xml_lines
from validation.engines.proving.plainness import plain
from validation.engines.proving.shortening import picked, shortened, still

SCRIPTS = sorted((Path(__file__).parents[3] / "reports" / "engines").glob("*.py"))


def ran(script: str) -> object:
    names: dict[str, object] = {}
    exec(script, names)
    return names["value"]


def test_names_that_are_used_once_go_where_they_are_used() -> None:
    script = (
        "import numpy as np\nimport math\nq, v = np.array([1.0, 2.0]), np.zeros(2)\nw = q + v\nvalue = w + q + math.pi"
    )
    assert shortened(script) == (
        "import numpy as np, math\nq = np.array([1.0, 2.0])\nw = q + np.zeros(2)\nvalue = w + q + math.pi"
    )
    np.testing.assert_array_equal(ran(script), ran(shortened(script)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "script",
    [
        "c = []\nd = c.append(1)\nvalue = c",
        "k = 0\nfor i in range(3): k += i\nvalue = k",
        "n = [1]\nm = n\nm.append(2)\nvalue = [n, m]",
        "q = [1.0]\ndef f(): return q\nvalue = f()",
        "class A:\n    def createData(self): return vars(self).copy()\nm = A()\nd = m.createData()\nm.x = 1\nvalue = d",
    ],
)
def test_what_may_do_something_stays_where_it_is(script: str) -> None:
    assert ran(shortened(script)) == ran(script)


def test_of_a_list_the_one_item_is_worked_out() -> None:
    script = "fs = [len('ab'), len('abc')]\nother = 1\nvalue = [[f, f + other] for f in fs]"
    found = picked(script, (1, 0))
    assert found == ("f = len('abc')\nother = 1", "np.array([f, f + other])[0]")
    assert picked("value = 0\nprint(value)", ()) is None
    assert picked("a = 2\nvalue = a * 3", ()) == ("a = 2", "a * 3")


def test_what_is_set_to_zero_is_left_out() -> None:
    script = "s.setVelocities(np.zeros(2))\np.SetPositions(c, np.array([1.0]))\ns.step(np.zeros(1))"
    assert still(script) == "p.SetPositions(c, np.array([1.0]))\ns.step(np.zeros(1))"


def test_long_lines_are_broken_and_mean_the_same() -> None:
    numbers = ", ".join(f"[{k / 7!r}, {k / 11!r}]" for k in range(12))
    xml = '<robot name="r">' + "".join(f'<link name="l{k}"><mass value="{k}"/></link>' for k in range(9)) + "</robot>"
    script = f"# {'word ' * 40}end\nrows = [{numbers}]\nvalue = len(rows), {xml!r}.replace('\\n', '')\n"
    short = folded(script)
    assert max(map(len, short.splitlines())) <= 120 and short.count("\n") > 5
    assert ran(short) == ran(script)
    assert xml_lines(xml).replace("\n", "") == xml


def test_plain_files_state_the_same_numbers() -> None:
    text = '<origin xyz="0.0 -0.0 0.0" rpy="0.0 0.0 0.0"/><mass value="10.0"/><axis xyz="1.0 0.0 0.5"/>[1.0, 2.0]'
    assert plain(text) == '<mass value="10"/><axis xyz="1 0 0.5"/>[1.0, 2.0]'
    assert plain(text, defaults=False).startswith('<origin xyz="0 0 0" rpy="0 0 0"/>')


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco"])
def test_simpler_files_state_their_simpler_trees(engine: str) -> None:
    """Each simplification of every hand-written file, read by an engine that reads the file itself right."""
    from validation.engines.matrix import SEED, Truths, judged
    from validation.engines.workers import Job

    plugin = OWN[engine]
    for name, one in readings().items():
        if one.form not in plugin.formats or "mimic" in name:
            continue
        for simpler in files.simpler(files.File(one.form, one.text, one.tree, ((),) * len(one.tree.links))):
            job = Job(engine, simpler.tree, ("mass_matrix", "bias"), SEED, form=simpler.form, text=simpler.text)
            assert {cell.cell.verdict for cell in judged(plugin, job, Truths(0))} <= {"right", "not offered"}, simpler


def test_files_that_are_written_from_trees_are_told_from_others() -> None:
    known = formats()["urdf of six oblique hinges"]
    assert texts(known.tree)["urdf"] == known.text
    assert all(texts(one.tree).get(one.form) != one.text for one in readings().values())


def test_loops_meet_with_all_coordinates_zero() -> None:
    from validation.engines.matrix import SEED
    from validation.engines.models.loops import trees
    from validation.engines.proving.pieces import taken
    from validation.engines.workers import Job, answered

    tree = trees()["weld between branches"]
    (answer,) = answered(Job("pinocchio", tree, ("constraint_jacobian",), SEED))
    assert answer.layout is not None and answer.state is not None
    count = 0
    for variant, pieces in closing.at_zero(tree, taken(answer.layout, answer.state)):
        (again,) = answered(Job("pinocchio", variant, ("constraint_jacobian",), pieces=pieces))
        if again.state is not None:
            assert not np.any(again.state.q), variant
            count += 1
    assert count > 5


def test_armature_is_on_every_axis_that_states_it() -> None:
    """Newton's joints of several axes had none, and were called wrong for it."""
    for kind, axes in (("universal with armature", 2), ("planar with armature", 3)):
        text = OWN["newton"].building(tree_of(kind))  # type: ignore[attr-defined]
        assert text.count("armature=0.75") == axes


def test_scripts_of_the_report_are_about_ten_lines() -> None:
    counts = {path.name: len(path.read_text().splitlines()) for path in SCRIPTS}
    assert statistics.median(counts.values()) <= 12
    assert not {name: count for name, count in counts.items() if count > 25}
    assert all(len(line) <= 120 for path in SCRIPTS for line in path.read_text().splitlines())
