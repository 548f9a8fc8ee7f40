"""The state that a command starts from: neutral, but for what its options state by name."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

import symofros as sf
from symofros.base.arrays import Array
from symofros.base.names import coordinate_of, quoted, speed_of
from symofros.commands.shared import number, refuse
from symofros.errors import did_you_mean


def stated_state(model: sf.Model, given: Mapping[str, str]) -> tuple[sf.Model, Array, Array]:
    """The model at its stated run-time parameters, and the neutral state (nq), (nv) with what is stated of it.

    A name of a coordinate or a speed comes before that of a parameter; another one is reported, and ends the command.
    """
    _refuse_split(given, (*model.names.q, *model.names.v, *model.names.par))
    stated = {name: number(name, text) for name, text in given.items()}
    states = (*model.names.q, *model.names.v)
    parameters = {name: parameter for name in stated if (parameter := coordinate_of(name, model.names.par))}
    parameters = {name: parameter for name, parameter in parameters.items() if parameter not in states}
    model = model.with_parameters(**{parameter: stated[name] for name, parameter in parameters.items()})
    q, v = model.neutral(), np.zeros(model.nv)
    for name in (name for name in stated if name not in parameters):
        if coordinate := coordinate_of(name, model.names.q):
            q[model.names.q.index(coordinate)] = stated[name]
        elif speed := speed_of(name, model.names.v):
            v[model.names.v.index(speed)] = stated[name]
        else:
            known = (*model.names.q, *(f"d{speed}" for speed in model.names.v), *model.names.par)
            missing = f"--set: no coordinate, speed or run-time parameter '{name}'"
            listed = ", ".join(known[:12]) + (", …" if len(known) > 12 else "")
            rule = "--set gives first coordinates, speeds (dNAME) and run-time parameters"
            raise refuse(sf.UnknownNameError(missing, listed, rule, did_you_mean(name, known)))
    return model, q, v


def _refuse_split(given: Mapping[str, str], known: Collection[str]) -> None:
    """Report a known name with an equals sign that lacks its backquotes, and so was taken for its beginning."""
    for name, text in given.items():
        whole = f"{name}={text}"
        meant = next((other for other in known if "=" in other and whole.startswith(f"{other}=")), None)
        if meant is not None and name not in known:
            rule = "a name with an equals sign stands between backquotes"
            remedy = f"write '{quoted(meant)}={whole[len(meant) + 1 :]}'"
            raise refuse(sf.UnknownNameError(f"--set: no '{name}'", f"'{whole}'", rule, remedy))
