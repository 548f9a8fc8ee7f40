import symofros as sf
from tests.validation.subjects import UNIT, every_kind, subject_of
from validation.inputs.frames import MOST_FRAMES, chosen_frames
from validation.mechanics.assembly import assemble


def star(arms: int) -> sf.System:
    bodies = [sf.RigidBody("hub", sf.Joint("h", "free"), UNIT)]
    for i in range(arms):
        bodies.append(sf.RigidBody(f"arm{i}", sf.Joint(f"a{i}", "revolute", "hub"), UNIT, [sf.Frame(f"tip{i}")]))
    return sf.System("star", bodies)


def test_tips_first_then_what_carries_them() -> None:
    assert chosen_frames(assemble(star(2))) == ("tip1", "tip0", "hub")


def test_too_many_tips_are_spread_evenly() -> None:
    frames = chosen_frames(assemble(star(3 * MOST_FRAMES)))
    assert len(frames) == len(set(frames)) == MOST_FRAMES
    assert frames[0] == f"tip{3 * MOST_FRAMES - 1}" and all(name.startswith("tip") for name in frames)


def test_a_frame_that_was_fixed_to_a_body_is_farther_out() -> None:
    tool = sf.RigidBody("tool", sf.Joint("f", "fixed", "arm0"))
    assert "tool" in chosen_frames(assemble(star(1).with_bodies(tool)))


def test_every_moving_body_of_a_small_model_has_one() -> None:
    assert len(every_kind().frames) == 6
    assert subject_of(star(1)).frames == ("tip0", "hub")
