"""The multibody benchmarks of the IFToMM library, simulated to their ends with our own methods.

Thresholds are the library's where it publishes one; the figures are those of the models' own files beside this one.
A01, the pendulum, is a study of `python -m validation stability`.
"""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models.closed.four_bars import n_four_bar
from tests.models import compiled, sampled
from tests.reference import test_andrews_squeezer as andrews
from tests.reference import test_bricard as bricard
from tests.reference import test_n_four_bar as four_bars

# s of the slider every second, for a shaft that starts with one turn a second; reduced equations by an implicit method.
GOVERNOR = (
    0.5,
    0.5014209223797202,
    0.5059092942965489,
    0.5132460783402598,
    0.5232233710264914,
    0.5355631037220336,
    0.5499286659059833,
    0.5659381577196505,
    0.5831783367098178,
    0.6012184020472857,
    0.6196229170612926,
)


class TestFourBars:
    """A02: N windows that fall flat twice a turn, where the constraints lose rank; 0.1 J may be lost in 10 s."""

    @pytest.mark.parametrize("stabilisation", ["projection", "baumgarte"])
    @pytest.mark.parametrize("n", [1, 2])
    def test_four_bars_match_the_reference_over_ten_seconds(self, n: int, stabilisation: str) -> None:
        energy, motion = four_bars.MOTION[n]
        run = self.run(n, 10.0, 5e-3, stabilisation, output=1.0)
        assert np.abs(run.energy - energy).max() < 1e-6
        np.testing.assert_allclose(run["crank0"], [angle for angle, _ in motion], atol=1e-6)
        np.testing.assert_allclose(run["dcrank0"], [rate for _, rate in motion], atol=1e-5)

    @pytest.mark.parametrize("n", sampled((10, 40), [10]))
    def test_many_loops_pass_their_flat_posture(self, n: int) -> None:
        run = self.run(n, 1.0, 1e-2, "projection")
        cranks = [i for i, name in enumerate(run.model.names.q) if name.startswith("crank")]
        # All stay parallel: none takes the other branch.
        assert np.ptp(run.q[:, cranks], axis=1).max() < 1e-9
        assert np.abs(run.energy - run.energy[0]).max() < 0.1

    @staticmethod
    def run(n: int, t_end: float, dt: float, stabilisation: str, output: float | None = None) -> sf.Trajectory:
        model = sf.compile(n_four_bar(n))
        upright = [(1.0 if name.startswith("crank") else -1.0) for name in model.names.q]
        q, v = np.pi / 2 * np.array(upright), -np.array(upright)
        run = sf.simulate(model, q, v, t_end, dt=dt, stabilisation=stabilisation, output=output)  # type: ignore[arg-type]
        assert run.outcome.ok, run.outcome
        return run


class TestAndrews:
    """A03, and the IVP test set: angles at 0.03 s."""

    @staticmethod
    def run(method: str, **settings: float) -> sf.Trajectory:
        model = andrews.model()
        run = sf.simulate(model, andrews.ours(andrews.START), t_end=0.05, method=method, output=0.01, **settings)  # type: ignore[arg-type]
        assert run.outcome.ok, run.outcome
        return run

    @pytest.mark.parametrize("method", ["dop853", "dopri5", "rodas4"])
    def test_eight_digits_of_the_angles_match_the_reference(self, method: str) -> None:
        run = self.run(method, rtol=1e-12 if method != "rodas4" else 1e-11, atol=1e-12)
        angles, rates, _ = andrews.MOTION[0.03]
        at = int(np.argmin(np.abs(run.t - 0.03)))
        off = np.abs(run.q[at] / andrews.ours(angles) - 1.0)
        # Digits as the IVP test set counts them: of its seven angles.
        assert -np.log10(off.max()) > 8.0
        # Rates of the test set itself are good to 7 digits: its integrator controls angles.
        np.testing.assert_allclose(run.v[at], andrews.ours(rates), rtol=1e-7)

    def test_states_at_all_tabulated_times_match(self) -> None:
        run = self.run("dop853", rtol=1e-12, atol=1e-12)
        for k, time in ((1, 0.01), (2, 0.02), (5, 0.05)):
            angles, rates, _ = andrews.MOTION[time]
            np.testing.assert_allclose(run.q[k], andrews.ours(angles), rtol=1e-9)
            np.testing.assert_allclose(run.v[k], andrews.ours(rates), rtol=2e-8)


class TestBricard:
    """A04: five conditions of rank four, ten seconds."""

    @pytest.mark.parametrize(
        ("method", "settings"), [("dop853", {"rtol": 1e-10, "atol": 1e-10}), ("rk4", {"dt": 5e-3})]
    )
    def test_bricard_matches_the_reference_over_ten_seconds(self, method: str, settings: dict[str, float]) -> None:
        times = [row[0] for row in bricard.MOTION]
        run = sf.simulate(compiled("bricard"), t_end=10.0, method=method, output=times, **settings)  # type: ignore[arg-type]
        assert run.outcome.ok
        wanted = np.array([(a, b, a, b, a) for *_, a, b in bricard.MOTION])
        np.testing.assert_allclose(run.q, wanted, atol=1e-7)
        assert np.ptp(run.energy) < 1e-6


class TestGovernor:
    """A05: springs of 8e5 N/m, a mode of -8117 1/s: an explicit method needs steps of a third of a millisecond."""

    def run(self, method: str, **settings: float) -> sf.Trajectory:
        model = compiled("flyball_governor")
        start = [0.0, np.pi / 6, np.pi / 6, 0.5]
        return sf.simulate(model, start, [2 * np.pi, 0, 0, 0], 10.0, method=method, output=1.0, **settings)  # type: ignore[arg-type]

    def test_the_stiff_method_matches_the_reference(self) -> None:
        run = self.run("rodas4", rtol=1e-8, atol=1e-8)
        assert run.outcome.ok
        np.testing.assert_allclose(run["s"], GOVERNOR, atol=1e-6)

    def test_explicit_methods_need_many_steps_or_diverge(self) -> None:
        stiff, explicit = self.run("rodas4", rtol=1e-5, atol=1e-6), self.run("dopri5", rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(stiff["s"], GOVERNOR, atol=1e-3)
        assert explicit.statistics.evaluations > 20 * stiff.statistics.evaluations
        blown = self.run("rk4", dt=1e-3)
        assert blown.outcome.kind == "diverged" and "implicit" in blown.outcome.advice
