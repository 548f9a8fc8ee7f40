"""Instances of packages: states near unit length are taken at it, others don't move."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import packaged
from tests.interop.turning import SYSTEMS
from tests.runtime.test_unit_quaternions import with_length

# Lines of q and v to lines of: status and q of a projection; status, q and v after a while; accelerations before it. At
# the end the status of all that with parameters that are refused.
DRIVER = Path(__file__).with_name("quaternions.c").read_text()


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packaged(SYSTEMS["hopper"](), tmp_path_factory.mktemp("hopper") / "c", DRIVER)


def test_instances_normalise_or_refuse_quaternions(package: Path) -> None:
    m = sf.compile(SYSTEMS["hopper"]())
    q, v = m.random_state(np.random.default_rng(4))
    a = m.forward_dynamics(q, v, np.zeros(m.nu))
    last = sf.simulate(m, q, v, 0.02, dt=1e-3).q[-1]
    lengths = (1.0, 1.0 + 1e-12, 1.0 + 1e-6, 1.0 - 9e-4, 1.1, 1e-3, 1e150, float("nan"))
    rows = [np.concatenate([with_length(m, q, length), v]) for length in lengths]
    text = "\n".join(" ".join(map(repr, row.tolist())) for row in rows)
    done = subprocess.run([package], input=text, capture_output=True, text=True, check=True)
    *lines, negative, not_finite = done.stdout.splitlines()
    said = np.array([line.split()[0] for line in lines], dtype=int).reshape(len(lengths), 3)
    numbers = [np.array(line.split()[1:], dtype=np.float64) for line in lines]
    assert negative == not_finite == "-9 -9 -9 -9"
    for k, length in enumerate(lengths):
        accelerations, projected, moved = numbers[3 * k : 3 * k + 3]
        if np.isnan(length):
            assert said[k].tolist() == [-1, 0, -1]  # A number that is none, as of other coordinates.
            continue
        assert said[k, 0] == 0 and accelerations == pytest.approx(a, rel=1e-12, abs=1e-12 * np.abs(a).max())
        if abs(length - 1.0) < 1e-3:
            assert said[k, 1:].tolist() == [0, 1]
            assert projected == pytest.approx(q, abs=1e-14) and moved == pytest.approx(last, abs=1e-12)
        else:
            assert said[k, 1:].tolist() == [-10, -10]
