"""MJCF: MuJoCo's own numbers for the same file, what is left out, and what a hostile file can't do."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

import symofros as sf
from symofros.description.mjcf import files as mjcf_files
from tests.description.mjcf.models import MODELS, PENDULUM, document
from tests.description.reading import faults
from validation.mechanics.geometry import quaternion_matrix

NOT_A_NUMBER = PENDULUM.replace('name="q"', 'name="q" armature="nan"')
FLOOR = '<worldbody><geom type="plane" size="1 1 1"/></worldbody>'
# Sums of some dozen products of doubles; measured: 2e-15 of the largest entry.
ROUNDING = 1e-12
STATES = 20


def write(folder: Path, body: str, name: str = "model.xml") -> Path:
    path = folder / name
    path.write_text(document(body))
    return path


def world(text: str) -> str:
    return f"<worldbody>{text}</worldbody>"


def notes(folder: Path, body: str) -> str:
    return "\n".join(sf.load(write(folder, body)).notes)


class Reference:
    """MuJoCo's own model of the file, at one state that is given in our coordinates."""

    def __init__(self, path: Path) -> None:
        mujoco.set_mju_user_warning(lambda text: None)  # It would log them into the current folder.
        try:
            self.m = mujoco.MjModel.from_xml_path(str(path))
        finally:
            mujoco.set_mju_user_warning(None)
        self.d = mujoco.MjData(self.m)
        # What never moves has no energy here, and forces of gravity's compensation count as passive.
        self.m.body_mass[self.m.body_treeid < 0] = 0.0
        self.m.jnt_actgravcomp[:] = 0

    def at(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Go to a state; returns T with v_mujoco = T v, and leaves T' v in `self.carried`."""
        m, d = self.m, self.d
        T, self.carried = np.eye(m.nv), np.zeros(m.nv)
        d.qpos[:] = q
        for j in range(m.njnt):
            at, dof = m.jnt_qposadr[j], m.jnt_dofadr[j]
            is_free = m.jnt_type[j] == int(mujoco.mjtJoint.mjJNT_FREE)
            if is_free or m.jnt_type[j] == int(mujoco.mjtJoint.mjJNT_BALL):
                at += 3 * is_free
                d.qpos[at : at + 4] = np.roll(q[at : at + 4], 1)
            if is_free:
                R = quaternion_matrix(q[at : at + 4][None])[0]
                T[dof : dof + 3, dof : dof + 3] = R
                self.carried[dof : dof + 3] = R @ np.cross(v[dof + 3 : dof + 6], v[dof : dof + 3])
        d.qvel[:] = T @ v
        mujoco.mj_forward(m, d)
        mujoco.mj_energyPos(m, d)
        mujoco.mj_energyVel(m, d)
        return T

    def mass_matrix(self) -> np.ndarray:
        M = np.zeros((self.m.nv, self.m.nv))
        mujoco.mj_fullM(self.m, self.d, M)
        return M


def close(ours: np.ndarray, theirs: np.ndarray, scale: float = 0.0) -> None:
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=ROUNDING * max(scale, float(np.abs(theirs).max()), 1e-3))


@pytest.mark.parametrize("name", MODELS)
def test_mujoco_has_the_same_equations(tmp_path: Path, name: str) -> None:
    path = write(tmp_path, MODELS[name])
    system = sf.load(path)
    model = sf.compile(system, sf.Options(backend="interpreter"))
    reference = Reference(path)
    m, d = reference.m, reference.d
    assert (model.nq, model.nv) == (m.nq, m.nv)
    rng = np.random.default_rng(0)
    for _ in range(STATES):
        q, v = model.random_state(rng)
        T = reference.at(q, v)
        M = reference.mass_matrix()
        M_v = M @ d.qvel
        close(model.mass_matrix(q), T.T @ M @ T)
        force = float(np.abs(M_v).max() + np.abs(d.qfrc_bias).max())
        close(model.bias(q, v), T.T @ (d.qfrc_bias + M @ reference.carried), force)
        close(model.generalized_force(q, v, np.zeros(model.nu)), T.T @ d.qfrc_passive, force)
        close(model.kinetic_energy(q, v), d.energy[1])
        close(model.potential_energy(q), d.energy[0], float(np.abs(m.body_mass).sum() * 10))
        for body in range(m.nbody):
            p, R = model.frame_pose(m.body(body).name or f"body{body}", q)
            close(p, d.xpos[body], 1.0)
            close(R, d.xmat[body].reshape(3, 3))
        for site in range(m.nsite):
            p, R = model.frame_pose(m.site(site).name or f"site{site}", q)
            close(p, d.site_xpos[site], 1.0)
            close(R, d.site_xmat[site].reshape(3, 3))


def test_rounded_numbers_become_exact_unless_disabled(tmp_path: Path) -> None:
    path = write(tmp_path, world(f'<frame euler="90 0 0">{PENDULUM}</frame>'))

    def entries(system: sf.System) -> list[float]:
        joint = system.body("a").joint
        assert joint is not None
        return [abs(sf.evaluate(value, {})) for value in joint.rotation]

    assert set(entries(sf.load(path))) == {0.0, 1.0}
    assert any("made exact" in note for note in sf.load(path).notes)
    assert 0.0 < max(x for x in entries(sf.load(path, snap_tol=0.0)) if x < 0.5) < 1e-15


# Meshes.

TETRAHEDRON = "\n".join(["v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "f 1 3 2", "f 1 2 4", "f 1 4 3", "f 2 3 4"])
MESH_BODY = '<body name="a"><joint name="q"/><geom type="mesh" mesh="part" {extra}/></body>'
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def with_mesh(extra: str = "", file: str = "part.obj", compiler: str = "") -> str:
    asset = f'<compiler {compiler}/><asset><mesh name="part" file="{file}"/></asset>'
    return asset + world(MESH_BODY.format(extra=extra))


def test_a_mesh_gives_a_body_its_inertia(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "part.obj").write_text(TETRAHEDRON)
    system = sf.load(write(tmp_path, with_mesh(compiler='meshdir="parts"', extra='density="6"')))
    inertia = system.body("a").inertia
    assert inertia is not None and inertia.mass == pytest.approx(1.0) and inertia.center_of_mass[0] == 0.25


# Includes.


def test_includes_are_expanded_in_place(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xml").write_text('<mujocoinclude><include file="deeper.xml"/></mujocoinclude>')
    (tmp_path / "parts" / "deeper.xml").write_text(f"<mujocoinclude>\n{PENDULUM}</mujocoinclude>")
    system = sf.load(write(tmp_path, world('<include file="parts/arm.xml"/>')))
    assert system.origin["body", "a"].endswith("deeper.xml:2")


# Faults: those that are found by us are in mjcf.txt.


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (world('\n<body name="a"><joint name="q"/>\n</body>'), "mass and inertia of moving bodies"),
        (world('\n<body pos="a b c"/>'), "bad format in attribute 'pos'"),
        (world('\n<body quat="0 0 0 0"/>'), "MuJoCo refuses"),
    ],
)
def test_mujoco_errors_are_reported_with_their_line(tmp_path: Path, text: str, said: str) -> None:
    message = faults(write(tmp_path, text))
    assert said in message and "model.xml:2" in message, message


def test_faults_name_the_line_of_an_included_file(tmp_path: Path) -> None:
    (tmp_path / "part.xml").write_text('<mujocoinclude>\n\n<body pos="x"/></mujocoinclude>')
    assert "part.xml:3" in faults(write(tmp_path, world('<include file="part.xml"/>')))


def test_without_mujoco_the_remedy_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert "pip install 'symofros[mjcf]'" in faults(write(tmp_path, world(PENDULUM)))


# Hostile files.


@pytest.fixture
def cage(tmp_path: Path) -> Path:
    """A folder for the model, beside things that it must not read."""
    (tmp_path / "secret.xml").write_text(f"<mujocoinclude>{PENDULUM}</mujocoinclude>")
    (tmp_path / "secret.obj").write_text(TETRAHEDRON)
    folder = tmp_path / "cage"
    folder.mkdir()
    for name in ("secret.xml", "secret.obj"):
        (folder / f"link_{name}").symlink_to(tmp_path / name)
    return folder


@pytest.mark.parametrize("where", ["../secret", "{outside}/secret", "sub/../../secret", "link_secret", "..\\\\secret"])
@pytest.mark.parametrize("kind", ["include", "mesh", "meshdir"])
def test_nothing_outside_of_the_folder_is_read(cage: Path, where: str, kind: str) -> None:
    where = where.format(outside=cage.parent)
    text = {
        "include": world(f'<include file="{where}.xml"/>'),
        "mesh": with_mesh(file=f"{where}.obj"),
        "meshdir": with_mesh(
            file="secret.obj" if "link" not in where else "link_secret.obj",
            compiler=f'meshdir="{where.removesuffix("secret").removesuffix("link_")}"',
        ),
    }[kind]
    assert "leaves the model's folder" in faults(write(cage, text))


def test_attributes_cannot_add_elements(tmp_path: Path) -> None:
    text = world(PENDULUM.replace('name="a"', 'name="a&quot;/>&lt;include file=&quot;x.xml"'))
    assert sf.load(write(tmp_path, text)).bodies[1].name == 'a"/><include file="x.xml'


def test_a_default_cannot_name_a_file(cage: Path) -> None:
    asset = f'<default><mesh file="{cage.parent}/secret.obj"/></default><asset><mesh name="part"/></asset>'
    message = faults(write(cage, asset + world(MESH_BODY.format(inertial="", extra=""))))
    assert "MuJoCo refuses" in message and "secret" not in message


def test_deeply_nested_includes_are_refused(tmp_path: Path) -> None:
    for i in range(60):
        inner = f'<frame><frame><include file="part{i + 1}.xml"/></frame></frame>'
        (tmp_path / f"part{i}.xml").write_text(f"<mujocoinclude>{inner}</mujocoinclude>")
    (tmp_path / "part60.xml").write_text(f"<mujocoinclude>{PENDULUM}</mujocoinclude>")
    assert "nested deeper than 100" in faults(write(tmp_path, world('<include file="part0.xml"/>')))


def test_sizes_of_mjcf_models_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path, '<size memory="1000G"/>' + world(PENDULUM))
    assert sf.load(path).bodies
    monkeypatch.setattr(mjcf_files, "MAX_ELEMENTS", 4)
    assert "too large" in faults(path)
    (tmp_path / "part.obj").write_text(TETRAHEDRON)
    monkeypatch.undo()
    monkeypatch.setattr(mjcf_files, "MAX_BYTES", 40)
    assert "too large" in faults(path)


def test_nothing_is_left_in_the_user_s_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo logs its warnings into the current folder, by default."""
    monkeypatch.chdir(tmp_path)
    assert "not a finite number" in faults(write(tmp_path, world(NOT_A_NUMBER)))
    assert [path.name for path in tmp_path.iterdir()] == ["model.xml"]
