from __future__ import annotations

from dataclasses import replace

import pytest

import symofros as sf
from symofros.mechanics.topology.coordinates import coordinate_names
from symofros.mechanics.topology.sticking import sticking_coordinates
from symofros.mechanics.topology.tree import build_tree, coupled_speeds

SOLID = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))


def body(name: str, parent: str, kind: str = "revolute", frames: tuple[str, ...] = (), **joint: object) -> sf.RigidBody:
    stated = sf.Joint(f"q_{name}", kind, parent, **joint)  # type: ignore[arg-type]
    return sf.RigidBody(name, stated, SOLID, [sf.Frame(frame) for frame in frames])


def test_links_are_numbered_depth_first_in_order_of_description() -> None:
    stated = sf.System("s", [body("b", "a"), body("x", "world"), body("a", "world"), body("c", "b"), body("d", "a")])
    assert [link.name for link in build_tree(stated).links] == ["x", "a", "b", "c", "d"]


def test_constants_are_not_parameters() -> None:
    stated = sf.System("s", [body("a", "world")], [sf.Parameter("m", 1.0), sf.Parameter("g", 9.81, constant=True)])
    names = build_tree(stated).coordinates
    assert names.par == ("m",) and names.constants == {"g": 9.81}


def test_deep_chains_do_not_exhaust_the_stack() -> None:
    bodies = [body(f"b{i}", f"b{i - 1}" if i else "world") for i in range(3000)]
    assert len(build_tree(sf.System("deep", bodies)).links) == 3000


def test_speeds_of_one_joint_are_coupled_with_each_other_and_those_of_branches_are_not() -> None:
    legs = [body(f"leg{k}", "base") for k in range(4)]
    assert coupled_speeds(build_tree(sf.System("s", [body("base", "world", "free"), *legs]))) == (15 + 4 * 6) / 10


def test_coordinates_of_a_general_joint_have_different_names() -> None:
    for names in (("a", "a"), ("a", "b", "a")):
        joint = sf.Joint("g", "general", coordinates=names, moving_position=("a", 0, 0))
        with pytest.raises(sf.DescriptionError, match="joint 'g': coordinates of the same name"):
            build_tree(sf.System("s", [sf.RigidBody("b", joint, sf.Inertia(1.0))]))


def test_a_coordinate_sticks_with_all_its_friction() -> None:
    """Break-away forces of several elements on one coordinate add up; those that don't stick, and of others, don't."""

    def friction(static: object, coordinate: int = 0, sticks: bool = True) -> sf.Friction:
        return sf.Friction(1.0, static, viscous=0.1, coordinate=coordinate, sticks=sticks)  # type: ignore[arg-type]

    elements = friction("s"), friction(5.0, 1), friction(7.0, sticks=False), friction("2*s")
    joint = sf.Joint("x", "cylindrical", axis=(0, 0, 1), elements=elements)
    found = list(sticking_coordinates(joint))
    assert [one.coordinate for one in found] == list(coordinate_names(joint))
    assert [sf.evaluate(one.breakaway, {"s": 2.0}) for one in found] == [6.0, 5.0]
    assert not list(sticking_coordinates(replace(joint, prescribed=True)))


def test_frames_whose_names_have_dots_are_found_by_one_name_each() -> None:
    """A frame 'b.tip' of body a is not what 'b.tip' means where body b has a frame 'tip'."""
    tree = build_tree(sf.System("s", [body("a", "world", frames=("tip", "b.tip")), body("b", "a", frames=("tip",))]))
    assert [frame.name for frame in tree.frames] == ["world", "a", "a.tip", "a.b.tip", "b", "b.tip"]
    assert tree.frame("b.tip").link == 1 and tree.frame("a.b.tip").link == 0


@pytest.mark.parametrize("other", ["a.tip", "world.tip"])
def test_a_body_called_as_the_frame_of_another_is_refused(other: str) -> None:
    """What was fixed to frame 'tip' of body 'a' was fixed to body 'a.tip'."""
    ground = sf.RigidBody("world", frames=[sf.Frame("tip")])
    stated = [ground, body(other, "world"), body("a", "world", frames=("tip",))]
    with pytest.raises(sf.DescriptionError, match=f"two frames called '{other}'"):
        build_tree(sf.System("s", stated))


BEAM = sf.Beam("bm", sf.Joint("clamp", "fixed"), length=1.0, rhoA=1.0, EI_z=1.0, bend_y=1)
BRISTLES = (sf.LuGre(1.0, 5.0),)
TOUCH = sf.Contact("c", ("a", None), ("world", None), points=((0, 0, 0), (1, 0, 0)), stiffness=1e3, radius=0.1)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (sf.System("s", [BEAM, sf.RigidBody("a", sf.Joint("bm.tip", "revolute", "bm"), SOLID)]), "two joints called"),
        (
            sf.System(
                "s", [body("a", "world", "free")], connections=[TOUCH, replace(TOUCH, name="c.0", points=((0, 0, 0),))]
            ),
            "two balls called 'c.0'",
        ),
        (
            sf.System(
                "s",
                [body("a", "world", "free")],
                constraints=[sf.Closure("c", ("a", None), ("world", None), ("x",), ()), sf.Coupling("c.x", "q_a.py")],
            ),
            "two conditions called 'c.x'",
        ),
        (
            sf.System(
                "s",
                [body("a", "world", elements=BRISTLES), sf.RigidBody("b", sf.Joint("q_a.bristle", "revolute"), SOLID)],
            ),
            "'q_a.bristle' is also a state",
        ),
    ],
)
def test_names_made_of_stated_ones_are_nobody_elses(stated: sf.System, said: str) -> None:
    """A formula of coordinate 'q_a.bristle' had the state of the bristles of q_a; others were listed twice."""
    with pytest.raises(sf.DescriptionError, match=said):
        build_tree(stated)


def test_conditions_know_their_constraints_by_more_than_a_dot() -> None:
    """Constraints 'hand', 'hand.left' and 'hand.right' were one to blocks and to what asks how closures face."""
    couplings = [sf.Coupling("hand.left", "q_b"), sf.Coupling("hand.right", "2*q_b")]
    weld = sf.Closure("hand", ("a", None), ("world", None), rotations=("x", "y", "z"))
    stated = sf.System("s", [body("a", "world", "free"), body("b", "world")], constraints=[*couplings, weld])
    record = sf.compile(stated, sf.Options(backend="interpreter")).record
    assert record.constraint_owners == (*["hand"] * 6, "hand.left", "hand.right")
    assert record.facing_conditions == (0, 0, 0)
