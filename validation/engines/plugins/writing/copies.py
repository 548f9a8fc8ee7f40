"""What an engine has copied, stored and read again, or moved to another place: it answers as what it was made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from .source import Way

# What says most of a model's parts, and of a state.
OF_MODELS = (
    *("mass_matrix", "bias", "forward_dynamics", "potential_energy", "link_poses", "passive_forces"),
    *("tendon_lengths", "actuator_arms", "actuator_forces", "frame_poses", "accelerometers"),
)


def of_model(first: Mapping[str, Way], how: Mapping[str, str], asked: Iterable[str] = OF_MODELS) -> dict[str, Way]:
    """Functions of a model that statements make of the one that was built.

    Args:
        first: Ways of the model that was built.
        how: What the engine calls the making -> the statements, which run once, before those of the way.
        asked: Functions; those without a way are left out.
    """
    made = {}
    for call, statements in how.items():
        lines = (f"made_by = {call!r}", *statements.splitlines())
        once = "".join([f"if globals().get('made_by') != {call!r}:", *(f"\n    {line}" for line in lines)])
        for name, way in ((name, first[name]) for name in asked if name in first):
            made[f"{name}:{call}"] = way._replace(native=f"{call}, {way.native}", code=f"{once}\n{way.code}")
    return made


def of_state(first: Mapping[str, Way], how: Mapping[str, tuple[str, str]], asked: Iterable[str]) -> dict[str, Way]:
    """Functions at a state that has been stored, left and taken up again.

    Args:
        first: Ways of the state that was set.
        how: What the engine calls it -> the statements that set a state, and those that follow them.
        asked: Functions.
    """
    made = {}
    for call, (setting, statements) in how.items():
        for name, way in ((name, first[name]) for name in asked):
            code = way.code.replace(setting, f"{setting}{statements}")
            made[f"{name}:{call}"] = way._replace(native=f"{call}, {way.native}", code=code)
    return made
