"""Status codes of a run, read from native/stepping/symofros_stepper.h, which says what each means."""

from __future__ import annotations

from enum import IntEnum

from symofros.runtime.calls import constants

_C = constants()


class Status(IntEnum):
    """How a run stands: not below zero while it can go on or has come to a proper end."""

    RUNNING = _C["SYM_RUNNING"]
    FINISHED = _C["SYM_FINISHED"]
    RECORDS_FULL = _C["SYM_RECORDS_FULL"]
    TERMINAL_EVENT = _C["SYM_TERMINAL_EVENT"]
    DIVERGED = _C["SYM_DIVERGED"]
    SINGULAR = _C["SYM_SINGULAR"]
    STEP_TOO_SMALL = _C["SYM_STEP_TOO_SMALL"]
    CALLBACK_FAILED = _C["SYM_CALLBACK_FAILED"]
    NO_CONVERGENCE = _C["SYM_NO_CONVERGENCE"]
    PROJECTION_FAILED = _C["SYM_PROJECTION_FAILED"]
    BEYOND_THEORY = _C["SYM_BEYOND_THEORY"]
    ENERGY_LOST = _C["SYM_ENERGY_LOST"]
    NO_ROTATION = _C["SYM_NO_ROTATION"]
    ENGAGED_APART = _C["SYM_ENGAGED_APART"]
    ACTION_REFUSED = _C["SYM_ACTION_REFUSED"]
    ACTS_WITHOUT_END = _C["SYM_ACTS_WITHOUT_END"]
    MODES_UNDECIDED = _C["SYM_MODES_UNDECIDED"]
    HELD_TWICE = _C["SYM_HELD_TWICE"]
    WRONG_CONTACT = _C["SYM_WRONG_CONTACT"]
    NO_CONTACT_FORCE = _C["SYM_NO_CONTACT_FORCE"]
    CONTACTS_AMBIGUOUS = _C["SYM_CONTACTS_AMBIGUOUS"]
    FLAT_RIM = _C["SYM_FLAT_RIM"]
