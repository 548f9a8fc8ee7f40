"""Saving and loading changes nothing that a file means, whatever its things are called."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.description.hostile.hostile_names import HOSTILE, hostile_system
from tests.description.sdf import models as sdf_models
from tests.description.usd import models as usd_models

ROOT = Path(__file__).parents[3]
SEEDS = range(300)
PRINTABLE = [name for name in HOSTILE if name.isprintable()]
INTERPRETER = sf.Options(backend="interpreter")
FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "constraint", "constraint_jacobian", "potential_energy")


def corpus() -> list[Path]:
    """Files of other formats in the repository."""
    folders = ("reference_models", "validation/corpus", "docs", "examples")
    found = (path for folder in folders for path in (ROOT / folder).rglob("*"))
    return sorted(path for path in found if path.suffix in (".urdf", ".xml", ".sdf", ".usda", ".usd"))


def same_meaning(system: sf.System, folder: Path) -> sf.System:
    """The system that is read from what is written of one, with the same names and the same bits."""
    sf.save(system, folder / "again.yaml")
    again = sf.load(folder / "again.yaml")
    one, two = (sf.compile(each, INTERPRETER) for each in (system, again))
    assert one.names == two.names
    rng = np.random.default_rng(0)
    for _ in range(2):
        q, v = one.integrate(one.neutral(), rng.uniform(-0.5, 0.5, one.nv)), rng.uniform(-1, 1, one.nv)
        u = np.array(one.record.u_default) + (0.0 if one.record.driven else rng.uniform(-1, 1, one.nu))
        for name in FUNCTIONS if one.nc else FUNCTIONS[:3]:
            given = {"q": q, "v": v, "u": u}
            results = [_results(model, name, given) for model in (one, two)]
            assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*results, strict=True)), name
    return again


def _results(model: sf.Model, name: str, given: dict[str, np.ndarray]) -> list[np.ndarray]:
    wanted = {"bias": "qv", "generalized_force": "qvu"}.get(name, "q")
    return [np.asarray(getattr(model, name)(*(given[x] for x in wanted)))]


@pytest.mark.parametrize("seed", [s if s % 25 == 0 else pytest.param(s, marks=pytest.mark.slow) for s in SEEDS])
def test_hostile_names_survive_saving(seed: int, tmp_path: Path) -> None:
    system = hostile_system(seed)
    assert same_meaning(system, tmp_path) == system


@pytest.mark.parametrize("name", MODELS)
def test_reference_models_survive_saving(name: str, tmp_path: Path) -> None:
    sf.save(MODELS[name], tmp_path / "again.yaml")
    again = sf.load(tmp_path / "again.yaml")
    assert again == MODELS[name]
    sf.save(again, tmp_path / "thrice.yaml")
    assert (tmp_path / "thrice.yaml").read_bytes() == (tmp_path / "again.yaml").read_bytes()


@pytest.mark.parametrize("file", corpus(), ids=lambda file: str(file.relative_to(ROOT)))
def test_files_of_other_formats_survive_saving(file: Path, tmp_path: Path) -> None:
    same_meaning(sf.load(file), tmp_path)


INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def urdf(names: list[str]) -> str:
    """A chain whose joints have these names; the last one mimics the first."""
    links = "".join(f"<link name={quoteattr('l' + name)}>{INERTIAL}</link>" for name in names)
    parents = ["base", *("l" + name for name in names)]
    joints = "".join(
        f'<joint name={quoteattr(name)} type="continuous"><parent link={quoteattr(parents[k])}/>'
        f'<child link={quoteattr("l" + name)}/><axis xyz="0 1 0"/>'
        + (f"<mimic joint={quoteattr(names[0])} multiplier='2' offset='0.1'/>" if k == len(names) - 1 else "")
        + "</joint>"
        for k, name in enumerate(names)
    )
    return f'<robot name="r"><link name="base"/>{links}{joints}</robot>'


def mjcf(names: list[str], actuators: list[str]) -> str:
    """A chain whose joints, with motors, have these names; the last one follows the first by an equality."""
    opened = "".join(
        f'<body name={quoteattr("b" + name)}><joint name={quoteattr(name)} axis="0 1 0"/>'
        '<geom type="sphere" size="0.1" pos="0.3 0 0"/>'
        for name in names
    )
    driven = "".join(
        f'<position name={quoteattr(a)} joint={quoteattr(j)} kp="20" kv="2"/>'
        for a, j in zip(actuators, names, strict=False)
    )
    bound = f'<joint joint1={quoteattr(names[-1])} joint2={quoteattr(names[0])} polycoef="0.1 2 0 0 0"/>'
    return (
        f'<mujoco model="m"><worldbody>{opened}{"</body>" * len(names)}</worldbody>'
        f"<actuator>{driven}</actuator><equality>{bound}</equality></mujoco>"
    )


def chunks(names: list[str], size: int = 16) -> list[list[str]]:
    """Names in groups, each of a chain."""
    return [names[i : i + size] for i in range(0, len(names), size)]


# What XML changes in attributes, or libraries in names, is no name of a file: blanks at the ends.
IN_FILES = [name for name in PRINTABLE if name.strip() == name and name]


@pytest.mark.parametrize("names", chunks(IN_FILES), ids=repr)
def test_urdf_joints_may_have_any_name(names: list[str], tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(urdf(names), encoding="utf-8")
    system = sf.load(file, mimic=True)
    model = sf.compile(system, INTERPRETER)
    assert model.names.q == tuple(names)
    q = np.linspace(0.1, 0.4, len(names))
    np.testing.assert_allclose(model.constraint(q), q[-1] - 2 * q[0] - 0.1, atol=1e-15)
    np.testing.assert_array_equal(
        sf.compile(same_meaning(system, tmp_path), INTERPRETER).constraint(q), model.constraint(q)
    )


@pytest.mark.parametrize("names", chunks(IN_FILES), ids=repr)
def test_mjcf_joints_and_actuators_may_have_any_name(names: list[str], tmp_path: Path) -> None:
    file = tmp_path / "m.xml"
    joints = [f"{name}_j" for name in names]
    file.write_text(mjcf(joints, names), encoding="utf-8")
    system = sf.load(file)
    model = sf.compile(system, INTERPRETER)
    assert model.names.q == tuple(joints) and model.names.u == tuple(names)
    q, v, u = np.linspace(0.1, 0.4, len(names)), np.linspace(1, 2, len(names)), np.linspace(-1, 1, len(names))
    np.testing.assert_allclose(model.generalized_force(q, v, u), 20 * (u - q) - 2 * v, rtol=1e-14)
    same_meaning(system, tmp_path)
    file.write_text(mjcf(names, joints), encoding="utf-8")
    same_meaning(sf.load(file), tmp_path)


@pytest.mark.parametrize("names", chunks([n for n in IN_FILES if "::" not in n and not n.startswith("__")]), ids=repr)
def test_sdf_joints_may_have_any_name(names: list[str], tmp_path: Path) -> None:
    parents = ["world", *(f"l{k}" for k in range(len(names)))]
    joints = (
        f'<joint name={quoteattr(name)} type="revolute"><parent>{parents[k]}</parent><child>l{k}</child>'
        "<axis><xyz>0 1 0</xyz><dynamics><damping>0.5</damping></dynamics></axis></joint>"
        for k, name in enumerate(names)
    )
    links = (sdf_models.link(f"l{k}", "", 1) for k in range(len(names)))
    file = tmp_path / "m.sdf"
    file.write_text(sdf_models.document("".join([*links, *joints])), encoding="utf-8")
    system = same_meaning(sf.load(file), tmp_path)
    assert sf.compile(system, INTERPRETER).names.q == tuple(names)


@pytest.mark.parametrize("names", [["t", "pi"], ["sin", "x"], ["door", "oor"], ["null", "e"]], ids=repr)
def test_usd_joints_may_have_names_reserved_in_formulas(names: list[str], tmp_path: Path) -> None:
    pytest.importorskip("pxr")
    bodies = [usd_models.body(f"b{k}", mass=1.0, diagonalInertia=(1, 1, 1)) for k in range(2)]
    joints = [usd_models.joint("Revolute", name, "b0" if k else "", f"b{k}", axis="Y") for k, name in enumerate(names)]
    file = tmp_path / "m.usda"
    file.write_text(usd_models.stage(*bodies, *joints))
    system = same_meaning(sf.load(file), tmp_path)
    assert sf.compile(system, INTERPRETER).names.q == tuple(names)


@pytest.mark.parametrize(("name", "body"), [("a\nb", "b"), ("s", "c\nd"), ("s", "")])
def test_names_that_load_would_refuse_are_not_saved(tmp_path: Path, name: str, body: str) -> None:
    bodies = (sf.RigidBody(body, sf.Joint("q", "revolute", "world"), sf.Inertia(1.0, (1, 0, 0))),)
    with pytest.raises(sf.DescriptionError, match="unusable name"):
        sf.save(sf.System(name, bodies), tmp_path / "s.yaml")
    assert not (tmp_path / "s.yaml").exists()
