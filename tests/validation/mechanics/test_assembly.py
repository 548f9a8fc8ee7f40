import numpy as np

import symofros as sf
from tests.validation.subjects import UNIT, every_kind
from validation.mechanics.assembly import BASE, assemble


def joint(name: str, kind: str, parent: str, **more: object) -> sf.Joint:
    return sf.Joint(name, kind, parent, **more)


def test_joints_are_ordered_depth_first_by_description() -> None:
    system = sf.System(
        "t",
        [
            sf.RigidBody("c", joint("jc", "revolute", "a")),  # Described before its parent.
            sf.RigidBody("a", joint("ja", "ball", "world")),
            sf.RigidBody("b", joint("jb", "free", "world")),
            sf.RigidBody("d", joint("jd", "prismatic", "a")),
        ],
    )
    assembly = assemble(system)
    assert [m.body for m in assembly.movers] == ["a", "c", "d", "b"]
    assert [m.parent for m in assembly.movers] == [BASE, 0, 0, BASE]
    assert [(m.q.start, m.v.start) for m in assembly.movers] == [(0, 0), (4, 3), (5, 4), (6, 5)]
    assert (assembly.nq, assembly.nv) == (13, 11)
    assert assembly.leaves() == [1, 2, 3]


def test_order_is_the_models_own() -> None:
    subject = every_kind()
    model = sf.compile(subject.system, sf.Options(functions=("mass_matrix",), backend="interpreter"))
    assembly = assemble(subject.system)
    assert (model.nq, model.nv) == (assembly.nq, assembly.nv)
    for mover in assembly.movers:
        assert all(name.startswith(mover.joint.name) for name in model.names.v[mover.v])
    assert set(assembly.frames) == set(model.names.frames)


def test_fixed_bodies_are_merged() -> None:
    system = sf.System(
        "t",
        [
            sf.RigidBody("arm", joint("j", "revolute", "world"), sf.Inertia(1.0, moments=(1, 1, 1))),
            sf.RigidBody("plate", joint("f", "fixed", "arm", position=(0, 0, 1)), None, [sf.Frame("hole", (1, 0, 0))]),
            sf.RigidBody("tool", joint("g", "fixed", "plate", frame="hole", position=(0, 1, 0)), sf.Inertia(3.0)),
        ],
    )
    assembly = assemble(system)
    merged = assembly.movers[0].merged()
    assert merged.mass == 4.0
    assert np.allclose(merged.p_BC, np.array([1, 1, 1]) * 0.75)
    # Two point masses 1 and 3 kg, a distance sqrt(3) apart: reduced mass 0.75.
    offset = np.array([1, 1, 1])
    assert np.allclose(merged.J_BC, np.eye(3) + 0.75 * (3 * np.eye(3) - np.outer(offset, offset)))
    assert np.allclose(assembly.frames["tool"].X_BF.p, [1, 1, 1])


def test_bodies_fixed_to_the_base_have_no_inertia() -> None:
    system = sf.System(
        "t",
        [
            sf.RigidBody("ground", None, UNIT),
            sf.RigidBody("pillar", joint("f", "fixed", "ground", position=(0, 0, 2)), UNIT),
            sf.RigidBody("arm", joint("j", "revolute", "pillar"), UNIT),
        ],
    )
    assembly = assemble(system)
    assert [mass.body for mass in assembly.movers[0].masses] == ["arm"]
    assert assembly.frames["pillar"].mover == BASE
    assert np.allclose(assembly.movers[0].X_AP.p, [0, 0, 2])


def test_inertia_about_the_body_origin_and_turned_axes_is_converted() -> None:
    about_body = sf.Inertia(2.0, (1, 0, 0), (1, 3, 4), about="body")
    turned = sf.Inertia(2.0, (1, 0, 0), (1, 1, 2), rotation=sf.Rotation.rpy(0, 0, np.pi / 2))
    for inertia, moments in ((about_body, (1, 1, 2)), (turned, (1, 1, 2))):
        body = sf.RigidBody("b", joint("j", "revolute", "world"), inertia)
        assert np.allclose(assemble(sf.System("t", [body])).movers[0].merged().J_BC, np.diag(moments))


def test_frames_get_unique_names() -> None:
    frames = [sf.Frame("tip"), sf.Frame("left")]
    system = sf.System(
        "t",
        [
            sf.RigidBody("a", joint("ja", "revolute", "world"), UNIT, frames),
            sf.RigidBody("b", joint("jb", "revolute", "a"), UNIT, [sf.Frame("tip"), sf.Frame("a")]),
        ],
    )
    assert set(assemble(system).frames) == {"world", "a", "b", "a.tip", "b.tip", "left", "b.a"}


def test_formulas_are_evaluated() -> None:
    body = sf.RigidBody("b", joint("j", "revolute", "world", position=("L/2", 0, 0), axis=(0, "L", 0)), UNIT)
    system = sf.System("t", [body], [sf.Parameter("L", 3.0)], gravity=(0, 0, "-3*L"))
    assembly = assemble(system)
    assert np.allclose(assembly.movers[0].X_AP.p, [1.5, 0, 0])
    assert np.allclose(assembly.movers[0].axis, [0, 1, 0])
    assert np.allclose(assembly.gravity, [0, 0, -9])
