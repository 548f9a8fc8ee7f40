import symofros as sf
from tests.validation.subjects import UNIT
from validation.inputs.frames import chosen_frames
from validation.mechanics.assembly import assemble


def star(arms: int) -> sf.System:
    bodies = [sf.RigidBody("hub", sf.Joint("h", "free"), UNIT)]
    for i in range(arms):
        bodies.append(sf.RigidBody(f"arm{i}", sf.Joint(f"a{i}", "revolute", "hub"), UNIT, [sf.Frame(f"tip{i}")]))
    return sf.System("star", bodies)


def test_tips_first_then_what_carries_them() -> None:
    assert chosen_frames(assemble(star(2))) == ("tip1", "tip0", "hub")
