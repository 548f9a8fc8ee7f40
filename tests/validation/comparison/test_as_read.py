"""What engines' own readers make of files is what ours makes of them, and a comparison can fail."""

from dataclasses import replace
from importlib import import_module
from typing import Any

import pytest
from typer.testing import CliRunner

import symofros as sf
from validation.__main__ import app
from validation.comparison.as_read import READERS, as_read
from validation.inputs.cases import ROBOTS, robot_case, robot_file


@pytest.mark.parametrize("engine", READERS)
@pytest.mark.parametrize("robot", ["ur5", "panda", "solo12", "talos"])
def test_engines_read_robots_as_we_do(engine: str, robot: str) -> None:
    found = as_read(robot_file(ROBOTS[robot].file), engine, robot_case(robot).reading.floating_base)
    assert found.same, str(found)


def test_another_reading_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    module = import_module("validation.adapters.pinocchio.as_read")
    stated = module.description

    def description(*given: Any) -> sf.System:
        system: sf.System = stated(*given)
        link = next(body for body in system.bodies if body.name == "forearm_link")
        assert isinstance(link, sf.RigidBody) and link.inertia is not None
        return system.with_bodies(replace(link, inertia=replace(link.inertia, mass=1.0)))

    monkeypatch.setattr(module, "description", description)
    file = str(robot_file(ROBOTS["ur5"].file))
    done = CliRunner().invoke(app, ["diff", file, "--as", "pinocchio"])
    assert done.exit_code == 1 and "mass of link 'forearm_link'" in done.output
    refused = CliRunner().invoke(app, ["diff", file, "--as", "nobody"])
    assert refused.exit_code == 2 and "no reader" in refused.output
