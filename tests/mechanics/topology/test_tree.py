from __future__ import annotations

import symofros as sf
from symofros.mechanics.topology.tree import BASE, build_tree

SOLID = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))


def body(name: str, parent: str, kind: str = "revolute", frames: tuple[str, ...] = (), **joint: object) -> sf.RigidBody:
    stated = sf.Joint(f"q_{name}", kind, parent, **joint)  # type: ignore[arg-type]
    return sf.RigidBody(name, stated, SOLID, [sf.Frame(frame) for frame in frames])


def test_depth_first_in_the_order_of_description() -> None:
    stated = sf.System("s", [body("b", "a"), body("x", "world"), body("a", "world"), body("c", "b"), body("d", "a")])
    assert [link.name for link in build_tree(stated).links] == ["x", "a", "b", "c", "d"]


def test_fixed_bodies_are_merged_as_inertias_and_frames() -> None:
    stated = sf.System(
        "s", [body("a", "world"), body("flange", "a", "fixed", ("tool",)), body("b", "flange", frame="tool")]
    )
    tree = build_tree(stated)
    assert [link.name for link in tree.links] == ["a", "b"]
    assert [len(link.inertias) for link in tree.links] == [2, 1]
    assert {frame.name: frame.link for frame in tree.frames} == {"world": BASE, "a": 0, "flange": 0, "tool": 0, "b": 1}
    assert len(tree.links[1].placement) == 3  # flange on a, tool on flange, P in tool


def test_what_is_fixed_to_the_base_has_frames_but_no_inertia() -> None:
    tree = build_tree(sf.System("s", [body("post", "world", "fixed", ("top",)), body("a", "post")]))
    assert tree.frame("post.top").link == BASE
    assert [len(link.inertias) for link in tree.links] == [1]


def test_coordinates_are_named_by_joint_and_component() -> None:
    tree = build_tree(sf.System("s", [body("a", "world", "free"), body("b", "a", "ball"), body("c", "b", "prismatic")]))
    names = tree.coordinates
    assert names.q[:7] == tuple(f"q_a.{s}" for s in ("px", "py", "pz", "qx", "qy", "qz", "qw"))
    assert names.v[:6] == tuple(f"q_a.{s}" for s in ("vx", "vy", "vz", "wx", "wy", "wz"))
    assert names.q[11:] == ("q_c",) and names.v[9:] == ("q_c",)
    assert names.symbols["dq_c"].group == "v" and names.symbols["dq_c"].index == 9


def test_actuated_joints_add_inputs_after_the_stated_ones() -> None:
    stated = sf.System(
        "s", [body("a", "world", actuated=True), body("b", "a", "ball", actuated=True)], inputs=[sf.Input("u1")]
    )
    assert build_tree(stated).coordinates.u == ("u1", "q_a", "q_b.wx", "q_b.wy", "q_b.wz")


def test_constants_are_not_parameters() -> None:
    stated = sf.System("s", [body("a", "world")], [sf.Parameter("m", 1.0), sf.Parameter("g", 9.81, constant=True)])
    names = build_tree(stated).coordinates
    assert names.par == ("m",) and names.constants == {"g": 9.81}


def test_frame_names_are_short_where_they_can_be() -> None:
    stated = sf.System("s", [body("a", "world", frames=("tip", "eye")), body("b", "a", frames=("tip", "b"))])
    names = [frame.name for frame in build_tree(stated).frames]
    assert names == ["world", "a", "a.tip", "eye", "b", "b.tip", "b.b"]


def test_a_deep_chain_is_no_recursion() -> None:
    bodies = [body(f"b{i}", f"b{i - 1}" if i else "world") for i in range(3000)]
    assert len(build_tree(sf.System("deep", bodies)).links) == 3000
