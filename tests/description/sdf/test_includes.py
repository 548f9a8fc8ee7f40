"""<include> of SDFormat: an included model is what the same file states whole, placed and named as SDFormat has it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.description.sdf import includes
from tests.description.reading import refused
from tests.description.sdf.models import MODELS, document, link
from tests.models import interpreted

WHEEL = '<sdf version="1.9"><model name="wheel">{}</model></sdf>'
CONFIG = '<model><name>x</name><sdf version="1.5">old.sdf</sdf><sdf version="1.9">new.sdf</sdf></model>'


def write(folder: Path, text: str, name: str = "model.sdf") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return folder / name


def including(inside: str, **attributes: str) -> str:
    stated = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f'<sdf version="1.11"><model name="outer"><include{stated}>{inside}</include></model></sdf>'


@pytest.mark.parametrize("merge", ["false", "true"])
@pytest.mark.parametrize("name", MODELS)
def test_an_included_model_is_the_same_mechanism(tmp_path: Path, name: str, merge: str) -> None:
    """Drake's numbers hold for the files (test_sdf.py): whole, as a nested model, and merged into another one."""
    whole = write(tmp_path / "arm", MODELS[name].text)
    outer = write(tmp_path / "outer", including("<uri>model://arm</uri>", merge=merge))
    theirs, ours = interpreted(sf.load(whole)), interpreted(sf.load(outer))
    prefix = "" if merge == "true" else "arm::"
    assert ours.names.q == tuple(prefix + q for q in theirs.names.q)
    q, v = theirs.random_state(np.random.default_rng(3))
    np.testing.assert_allclose(ours.mass_matrix(q), theirs.mass_matrix(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(ours.bias(q, v), theirs.bias(q, v), rtol=1e-12, atol=1e-11)
    for frame in theirs.names.frames:
        mine = frame if frame == "world" else prefix + frame.replace("_at_", f"_at_{prefix}")
        for a, b in zip(ours.frame_pose(mine, q), theirs.frame_pose(frame, q), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-13)


@pytest.mark.parametrize("merge", ["false", "true"])
def test_an_include_states_name_pose_and_static(tmp_path: Path, merge: str) -> None:
    """The pose is stated in a frame of the model around it, and takes the place of the model's own."""
    own = "<pose>9 9 9 0 0 0</pose>" + link("w", "<pose>0 0 1 0 0 0</pose>", 1)
    write(tmp_path / "wheel", WHEEL.format(own))
    pose = '<pose relative_to="hub">0 2 0 0 0 0</pose>'
    inside = f'<uri>model://wheel</uri><name>left</name>{pose}</include><frame name="hub"><pose>1 0 0 0 0 0</pose>'
    text = including(inside, merge=merge).replace("</include></model>", "</frame></model>")
    system = sf.load(write(tmp_path / "cart", text))
    name = "w" if merge == "true" else "left::w"
    model = interpreted(system)
    assert [body.name for body in system.bodies if body.joint is not None] == [name]
    # It floats: the coordinates of a free body are its place; where the file puts it, the frame of the hub says.
    frame = {f.name: f for body in system.bodies for f in body.frames}["hub"]
    np.testing.assert_allclose(np.array(frame.position, dtype=float), (0.0, -2.0, -1.0), atol=1e-15)
    assert model.nv == 6
    world = '<sdf version="1.9"><world name="x"><include><uri>model://wheel</uri><static>true</static>{}</include>{}'
    free = WHEEL.format(link("w", "", 1)).replace('<sdf version="1.9">', "").replace("</sdf>", "</world></sdf>")
    free = free.replace('"wheel"', '"other"')
    fixed = sf.load(write(tmp_path / "cart", world.format("<pose>1 2 3 0 0 0</pose>", free)))
    joint = fixed.body("wheel::w").joint
    assert joint is not None and joint.kind == "fixed" and joint.position == (1.0, 2.0, 4.0)


def test_a_merged_model_refers_to_the_frame_that_stands_for_its_own(tmp_path: Path) -> None:
    arm = (
        "<pose>0 0 5 0 0 0</pose>" + link("a", "", 1) + '<frame name="f"><pose>0 1 0 0 0 0</pose></frame>'
        '<joint name="j" type="revolute"><parent>world</parent><child>a</child>'
        '<axis><xyz expressed_in="__model__">1 0 0</xyz></axis></joint>'
    )
    write(tmp_path / "wheel", WHEEL.format(arm))
    pose = "<pose>1 0 0 0 0 1.5707963267948966</pose>"
    outer = including(f"<uri>model://wheel</uri>{pose}", merge="true").replace(
        "<include", link("own", "", 1) + "<include"
    )
    system = sf.load(write(tmp_path / "cart", outer), snap_tol=1e-9)
    joint = system.body("a").joint
    assert joint is not None and joint.position == (1.0, 0.0, 0.0) and joint.axis == (1.0, 0.0, 0.0)
    model = interpreted(system)
    q = model.neutral()
    np.testing.assert_allclose(model.frame_pose("f", q)[0], (0.0, 0.0, 0.0), atol=1e-9)  # (1, 0) and then along -x.
    np.testing.assert_allclose(model.frame_pose("_merged__wheel__model__", q)[0], (1.0, 0.0, 0.0), atol=1e-9)


@pytest.mark.parametrize(
    ("inside", "said"),
    [
        ('<plugin name="p" filename="x"/>', "<plugin> of <include> ignored: 1 include (line 1)"),
        ("<name>left</name><pose>0 0 1 0 0 0</pose><static>false</static>", ""),
    ],
)
def test_ignored_entries_of_an_include_are_reported(tmp_path: Path, inside: str, said: str) -> None:
    held = '<joint name="j" type="ball"><parent>world</parent><child>w</child></joint>'
    write(tmp_path / "wheel", WHEEL.format(link("w", "", 1) + held))
    notes = sf.load(write(tmp_path / "cart", including(f"<uri>model://wheel</uri>{inside}"))).notes
    assert notes == (said,) * bool(said)


def test_included_models_are_found_below_beside_and_in_given_folders(tmp_path: Path) -> None:
    wheel = WHEEL.format(link("w", "", 1))
    below = write(tmp_path / "below", including("<uri>parts/wheel</uri>"))
    write(tmp_path / "below/parts/wheel", wheel)
    assert sf.load(below).body("wheel::w")
    one_file = write(tmp_path / "below", including("<uri>model://parts/wheel/model.sdf</uri>"), "file.sdf")
    assert sf.load(one_file).body("wheel::w")
    # The file of the latest version that model.config names.
    write(tmp_path / "below/parts/wheel", wheel.replace('name="w"', 'name="new"'), "new.sdf")
    write(tmp_path / "below/parts/wheel", CONFIG, "model.config")
    assert sf.load(below).body("wheel::new")
    elsewhere = write(tmp_path / "worlds", including("<uri>model://wheel</uri>"), "a.sdf")
    write(tmp_path / "models/wheel", wheel)
    error = refused(elsewhere)
    assert len(error.problems) == 1 and "load(…, packages={'wheel': 'FOLDER'})" in str(error)
    assert "--package wheel=FOLDER" in error.in_shell()
    for name, folder in (("wheel", "models/wheel"), ("models", "models")):
        assert sf.load(elsewhere, packages={name: tmp_path / folder}).body("wheel::w")


@pytest.mark.parametrize("link_to", ["folder", "file", "config"])
def test_links_out_of_the_folder_are_not_followed(tmp_path: Path, link_to: str) -> None:
    """What a link beside the model's folder, or in it, leads to is not read."""
    outside = write(tmp_path / "secret", WHEEL.format(link("w", "", 1)))
    main = write(tmp_path / "home/cart", including("<uri>model://wheel</uri>"))
    wheel = tmp_path / "home/wheel"
    if link_to == "folder":
        wheel.symlink_to(outside.parent)
    else:
        wheel.mkdir()
        target = wheel / "model.sdf"
        if link_to == "config":
            write(wheel, CONFIG, "model.config")
            target = wheel / "new.sdf"
        target.symlink_to(outside)
    assert len(refused(main).problems) == 1


@pytest.mark.parametrize(
    "uri", ["../../secret", "/etc", "file:///etc", "http://x/y", "model://..", "", "a\\0b", "x" * 5000]
)
def test_uris_out_of_the_folders_are_refused(tmp_path: Path, uri: str) -> None:
    write(tmp_path / "secret", WHEEL.format(link("w", "", 1)))
    main = write(tmp_path / "home/cart", including(f"<uri>{uri}</uri>"))
    assert len(refused(main).problems) == 1


@pytest.mark.parametrize(
    ("inside", "attributes", "said"),
    [
        ("<uri>model://wheel</uri><placement_frame>w</placement_frame>", {}, "placement_frame 'w'"),
        ("<uri>model://wheel</uri><static>true</static>", {"merge": "true"}, "with <static>"),
        ("<uri>model://gone</uri>", {}, "'model://gone' is not found"),
        ("<uri>model://two</uri>", {}, "no model, or several"),
        ("<uri>model://broken</uri>", {}, "not well-formed"),
        ("<uri>model://old</uri>", {}, "no SDFormat of version"),
        ("<uri>model://outer</uri>", {}, "nested too deep"),
    ],
)
def test_consequences_of_a_fault_are_not_reported(
    tmp_path: Path, inside: str, attributes: dict[str, str], said: str
) -> None:
    wheel = link("w", "", 1)
    write(tmp_path / "wheel", WHEEL.format(wheel))
    write(tmp_path / "two", f'<sdf version="1.9"><model name="a">{wheel}</model><model name="b">{wheel}</model></sdf>')
    write(tmp_path / "broken", "<sdf")
    write(tmp_path / "old", '<sdf version="1.2"/>')
    follows = '<joint name="j" type="fixed"><parent>world</parent><child>wheel::w</child></joint></model>'
    main = write(tmp_path / "outer", including(inside, **attributes).replace("</model>", follows))
    error = refused(main)
    assert len(error.problems) == 1 and said in str(error), str(error)


def test_the_number_of_includes_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each file includes the next one twice: a billion models after thirty files."""
    monkeypatch.setattr(includes, "MAX_INCLUDES", 50)
    for i in range(12):
        two = "".join(f"<include><uri>model://m{i + 1}</uri><name>{k}</name></include>" for k in "ab")
        write(tmp_path / f"m{i}", f'<sdf version="1.9"><model name="m">{two}</model></sdf>')
    write(tmp_path / "m12", WHEEL.format(link("w", "", 1)))
    assert "includes too much" in str(refused(tmp_path / "m0/model.sdf"))


def test_refused_includes_count_towards_the_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(includes, "MAX_INCLUDES", 50)
    many = "<include><uri>gone</uri></include>" * 51
    assert "includes too much" in str(
        refused(write(tmp_path, f'<sdf version="1.9"><model name="m">{many}</model></sdf>'))
    )


@pytest.mark.parametrize(
    ("uri", "proposed"),
    [
        ("../plain/plain.sdf", "plain"),
        ("../plain", "plain"),
        ("../../top/plain.sdf", "../top"),
        ("typo.sdf", None),
        ("../plain/typo.sdf", None),
        ("../../../up/plain.sdf", None),
        ("../" * 40 + "etc/hosts", None),
        ("link.sdf", None),
    ],
)
def test_proposed_folders_work_and_open_nothing_else(tmp_path: Path, uri: str, proposed: str | None) -> None:
    folder = tmp_path.resolve() / "a/b"
    for place in ("plain", "../top", "../../up"):
        write(folder / place, WHEEL.format(link("w", "", 1)), "plain.sdf")
    write(folder / "plain", WHEEL.format(link("w", "", 1)))
    main = write(folder / "cart", including(f"<uri>{uri}</uri>"), "main.sdf")
    (folder / "cart/link.sdf").symlink_to(folder / "plain/plain.sdf")
    error = refused(main)
    (problem,) = error.problems
    if proposed is None:
        assert problem.argument is None and "mend its <uri>" in problem.remedy and "load(" not in str(error)
        assert ("may not be read" in problem.found) == (uri != "typo.sdf")
        return
    assert problem.argument is not None and Path(problem.argument.value) == (folder / proposed).resolve()
    assert sf.load(main, packages={problem.argument.key: problem.argument.value}).body("wheel::w")


def test_lines_of_included_files_are_named(tmp_path: Path) -> None:
    write(tmp_path / "wheel", WHEEL.format('\n<link name="w"><pose>1 2</pose></link>'))
    main = write(tmp_path / "cart", including("<uri>model://wheel</uri>"))
    assert re.search(r"wheel/model\.sdf:2: link 'wheel::w': <pose> is bad", str(refused(main)))


def test_included_files_are_sources(tmp_path: Path) -> None:
    """`symofros compile` knows a model as long as none of its files changes."""
    from symofros.loading import load_with_sources

    write(tmp_path / "wheel", WHEEL.format(link("w", "", 1)))
    main = write(tmp_path / "cart", including("<uri>model://wheel</uri>"))
    names = [Path(source.file).parent.name for source in load_with_sources(main)[1]]
    assert names == ["cart", "wheel"]


def test_older_sdf_versions_keep_their_rules(tmp_path: Path) -> None:
    """A pose of 1.6 names its frame by `frame`, in a file that one of 1.11 includes."""
    old = document(link("a", "<pose>0 0 1 0 0 0</pose>", 1) + link("b", '<pose frame="a">0 1 0 0 0 0</pose>', 1), "1.6")
    write(
        tmp_path / "arm",
        old.replace("</model>", '<joint name="q" type="fixed"><parent>a</parent><child>b</child></joint></model>'),
    )
    system = sf.load(write(tmp_path / "cart", including("<uri>model://arm</uri>")))
    joint = system.body("arm::b").joint
    assert joint is not None and joint.position == (0.0, 1.0, 0.0)
