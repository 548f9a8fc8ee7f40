"""C that says which events a package looks for, and what they do: sym_event_plan of symofros_instance.h."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from symofros.base.c_text import doubles, integers, strings
from symofros.base.events import Event
from symofros.compiler import Compilation
from symofros.errors import ExportError
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord, SwitchRecord
from symofros.simulation.actions import StatedActions, places_of, plan_actions
from symofros.simulation.events import events_of, named_events, opens_of

# Targets whose steps look for events.
TARGETS = ("c", "fmu2", "fmu3", "mex", "wasm")


@dataclass(frozen=True)
class EventPlan:
    """The events of a package.

    Attributes:
        lines: C of the plan, NAME_event_plan.
        files: File name -> C text of the formulas, which the lines include.
    """

    lines: tuple[str, ...]
    files: Mapping[str, str] = field(repr=False)


def event_plan(
    compilation: Compilation, model: Model, given: Mapping[str, Any] | None, c_name: str, target: str
) -> EventPlan | None:
    """The events of a package; None where there are none.

    Args:
        compilation: Compilation of the system, which writes formulas as C.
        model: The same as a model.
        given: Name -> formula or Event.
        c_name: Prefix of names in C.
        target: Target of the export.

    Raises:
        ExportError: The target has no steps of its own, or can't end where an event does.
        SymofrosError: An action can't be done.
    """
    if target not in TARGETS:
        model.record.refuse_sticking(f"export: '{target}'")
        model.record.refuse_rigid_contacts(f"export: '{target}'")
        _refuse(named_events(given), target)
        return None  # Those of the description are left out, with a note.
    events = events_of(model, given)
    if not events:
        return None
    if target != "c":
        refuse_ends(events)
    actions = plan_actions(model, events)
    model.formulas([event.formula for event in events], derivatives=False, reactions=True)  # Refuses what is none.
    sources: dict[str, Sequence[Any]] = {
        "events": [event.formula for event in events],
        "actions": actions.stated.formulas if actions else (),
        "contacts": [formula for ball in model.record.rigid_contacts for formula in ball.state],
    }
    files = {
        f"{c_name}_{kind}.inc": compilation.formulas_source(formulas, f"{c_name}_{kind}", reactions=kind == "events")
        for kind, formulas in sources.items()
        if formulas
    }
    return planned(c_name, events, actions.stated if actions else None, model.record, files)


def _refuse(events: Sequence[Event], target: str) -> None:
    if events:
        what, rule = f"export: '{target}' looks for no events", f"events are of {', '.join(TARGETS)}"
        remedy = "leave `events` out, and look for them in the host; or take one of these targets"
        raise ExportError(what, ", ".join(event.name for event in events), rule, remedy)


def refuse_ends(events: Iterable[Event]) -> None:
    """Refuse events that end the motion of an FMU, or of a call of a MEX function.

    Raises:
        ExportError: One does.
    """
    ending = [event.name for event in events if event.terminal]
    if ending:
        what, rule = (
            f"export: event '{ending[0]}' ends the motion",
            "callers decide when the motion of an FMU or a MEX function ends",
        )
        remedy = "an action, such as one that locks what moves; or events={'NAME': None}, which leaves it out"
        raise ExportError(what, "terminal=True", rule, remedy)


def planned(
    name: str,
    events: Sequence[Event],
    actions: StatedActions | None,
    record: ModelRecord,
    files: Mapping[str, str],
) -> EventPlan:
    """The plan of some events.

    Args:
        name: Prefix of names in C.
        events: The events, ends of modes last.
        actions: What they do; None: nothing.
        record: Names and switches of what moves.
        files: File name -> C text of their formulas, NAME_events, of their actions', NAME_actions, and of the states of
            rigid contacts, NAME_contacts.
    """
    return EventPlan(tuple(_lines(name, events, actions, record, tuple(files))), files)


def _lines(
    name: str, events: Sequence[Event], actions: StatedActions | None, record: ModelRecord, files: Sequence[str]
) -> list[str]:
    """C of the plan."""
    switches = record.switches
    turning = [switch for switch in switches if switch.rotation]
    sticking = [f"{{{one.q}, {one.v}, {one.mode}, {one.row}}}" for one in record.sticking]
    balls = record.rigid_contacts
    contacts = [
        f"{{{one.mode}, {{{integers(one.pushes)}}}, {{{integers(one.way)}}}, {one.apart}, {one.pole},"
        f" {{{integers(one.rows)}}}}}"
        for one in balls
    ]
    places = [f"{{{', '.join(map(str, place))}}}" for place in (places_of(record, actions) if actions else ())]
    arrays = {
        "direction": [event.sign for event in events],
        "cut": [event.cut for event in events],
        "acts": [int(event.acts) for event in events],
        "once": [int(event.once) for event in events],
    }
    restitution = [event.coefficient for event in events]
    frames = [frame for switch in turning for frame in switch.frames]
    held = [
        f"static const int32_t {name}_switch{i}[] = {{{integers((*rows, *places_of, *switch.rotation))}}};"
        for i, switch in enumerate(switches)
        for rows, places_of in (tuple(zip(*switch.offsets, strict=True)) or ((), ()),)
    ]
    counts = f"{len(places)}, {len(switches)}, {len(frames)}"
    pointers = ", ".join(f"{name}_event_{key}" for key in (*arrays, "restitution", "opens"))
    models = f"{name}_events_model, {f'{name}_actions_model' if actions else 'NULL'}"
    return [
        *(f'#include "{file}"' for file in files),
        f"static const char *const {name}_event_names[] = {{{strings([event.name for event in events])}}};",
        *(f"static const int32_t {name}_event_{key}[] = {{{integers(of)}}};" for key, of in arrays.items()),
        f"static const double {name}_event_restitution[] = {{{doubles(restitution)}}};",
        f"static const int32_t {name}_event_opens[] = {{{integers(opens_of(events))}}};",
        f"static const sym_assignment {name}_assignments[] = {{{', '.join(places) or '{0, 0, 0, 0}'}}};",
        *held,
        f"static const sym_switch {name}_switches[] = {{{_switches(name, switches)}}};",
        f"static const sym_sticking {name}_sticking[] = {{{', '.join(sticking) or '{0, 0, 0, 0}'}}};",
        *([f"static const sym_rigid_contact {name}_rigid_contacts[] = {{{', '.join(contacts)}}};"] if balls else ()),
        f"static const char *const {name}_pose_frames[] = {{{strings(frames)}}};",
        f"static const sym_event_plan {name}_event_plan = {{",
        f"    {len(events)}, {name}_event_names, {pointers},",
        f"    {counts}, {name}_assignments, {name}_switches, {name}_pose_frames,",
        f"    {len(sticking)}, {actions.first_mode if actions else len(events)}, {name}_sticking, {models},",
        f"    {len(balls)}, " + (f"{name}_rigid_contacts, {name}_contacts_model" if balls else "NULL, NULL"),
        "};",
    ]


def _switches(name: str, switches: Sequence[SwitchRecord]) -> str:
    """Initialisers of the switches, whose rows, places and rotation lie in one array each."""
    structs, pose = [], 0
    for i, switch in enumerate(switches):
        n, at = len(switch.offsets), f"{name}_switch{i}"
        rotation = f"{at} + {2 * n}" if switch.rotation else "NULL"
        structs.append(f"{{{int(switch.moment)}, {n}, {at}, {at} + {n}, {rotation}, {pose}}}")
        pose += 2 * bool(switch.rotation)
    return ", ".join(structs) or "{0, 0, NULL, NULL, NULL, 0}"
