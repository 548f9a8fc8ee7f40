"""What is played: where in a motion the picture is, by the clock."""

from __future__ import annotations

from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.playing.motion import PlayedMotion, positive


class Player:
    """The position in a motion; no clock of its own.

    Args:
        motion: Motion to play.
        speed: Seconds of the motion a second.
        loop: Whether it begins again at its end.
        run: Trajectory that the motion is of, if it is of one.

    Raises:
        SymofrosError: The speed is not a number above 0.
    """

    def __init__(
        self, motion: PlayedMotion, speed: float = 1.0, loop: bool = True, run: Trajectory | None = None
    ) -> None:
        self.motion, self.run = motion, run
        self.speed, self.loop = positive("speed", speed), loop
        self.time = motion.start
        self.playing = False

    def seek(self, time: float) -> None:
        """Go to a time [s], the first or the last if it is outside."""
        self.time = min(max(time, self.motion.start), self.motion.end)

    def start(self) -> None:
        """Play on; from the beginning if it is at its end."""
        self.playing = True
        if self.time >= self.motion.end:
            self.time = self.motion.start

    def advance(self, elapsed: float) -> float:
        """The time to show after so much of the clock [s]; it stops at the end unless it loops."""
        if not self.playing:
            return self.time
        time, length = self.time + self.speed * elapsed, self.motion.end - self.motion.start
        if time >= self.motion.end:
            if self.loop and length > 0.0:
                time = self.motion.start + (time - self.motion.start) % length
            else:
                self.playing, time = False, self.motion.end
        self.time = time
        return time
