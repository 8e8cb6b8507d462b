# SPDX-License-Identifier: Apache-2.0
"""What drives the tools that move in a stage: the ram of a press, by its kinematics or by its energy.

The travel of the ram is counted from where the stage begins. It is that of the tool that moves farthest, or twice as
far where a symmetry plane across it stands for the other half of the workpiece.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from presswork.model.arrays import FloatArray


@dataclass(frozen=True)
class SpeedTable:
    """A speed over the travel, such as a hydraulic press has."""

    rows: FloatArray
    """Travel [mm], increasing from 0, and speed there [mm/s], above 0 (n, 2); linear between the rows and constant
    after the last."""

    def speed_at(self, travel: float) -> float:
        """Return the speed [mm/s]."""
        return float(np.interp(travel, *self.rows.T))

    def time_at(self, travel: float) -> float:
        """Return the time until it has gone so far [s]: the integral of ds/v, exact for a speed linear in s."""
        travels, speeds, times = self._table()
        k = min(int(np.searchsorted(travels, travel, side="right")) - 1, len(travels) - 1)
        first, last = float(speeds[k]), self.speed_at(travel)
        return float(times[k]) + (travel - float(travels[k])) / _mean_speed(first, last)

    def travel_at(self, time: float) -> float:
        """Return how far it has gone after a time [mm]: the inverse of time_at."""
        travels, speeds, times = self._table()
        k = min(int(np.searchsorted(times, time, side="right")) - 1, len(travels) - 1)
        since, speed = time - float(times[k]), float(speeds[k])
        slope = 0.0
        if k + 1 < len(travels):
            slope = float((speeds[k + 1] - speeds[k]) / (travels[k + 1] - travels[k]))
        grown = slope * since
        stretch = since if grown == 0.0 else since * math.expm1(grown) / grown
        return float(travels[k]) + speed * stretch

    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return travels, speeds and times of the rows."""
        travels, speeds = self.rows.T
        means = [_mean_speed(float(a), float(b)) for a, b in itertools.pairwise(speeds)]
        steps = np.diff(travels) / np.array(means)
        return travels, speeds, np.concatenate([[0.0], np.cumsum(steps)])


@dataclass(frozen=True)
class Crank:
    """A slider-crank drive that turns at constant speed, from an angle before bottom dead centre on.

    At an angle a before bottom dead centre the ram stands r (1 - cos a) + (l - sqrt(l^2 - r^2 sin^2 a)) above it, r
    being the radius of the crank and l the length of the connecting rod.
    """

    radius: float
    """Half the stroke of the press [mm]."""
    rod_ratio: float
    """Radius over the length of the connecting rod, 0 to below 1; 0: a rod of infinite length."""
    speed: float
    """Speed of the crank [rad/s]."""
    start: float
    """Distance from bottom dead centre where the stage begins [mm], at most the stroke."""
    rated_height: float = 0.0
    """Distance from bottom dead centre below which the press bears its rated force [mm]; above, the torque of that
    force at that height limits it."""

    def angle_at(self, travel: float) -> float:
        """Return the angle before bottom dead centre [rad], 0 to pi, by the law of cosines."""
        d, r, ratio = max(self.start - travel, 0.0), self.radius, self.rod_ratio
        versine = d * (2.0 * r - ratio * d) / (2.0 * r * (r + ratio * (r - d)))  # 1 - cos a
        return 2.0 * math.asin(math.sqrt(min(0.5 * versine, 1.0)))

    def height_at(self, angle: float) -> float:
        """Return the distance from bottom dead centre [mm] at an angle before it [rad]."""
        r, ratio = self.radius, self.rod_ratio
        sine, half = math.sin(angle), math.sin(0.5 * angle)
        return 2.0 * r * half * half + r * ratio * sine * sine / (1.0 + math.sqrt(1.0 - (ratio * sine) ** 2))

    def speed_at(self, travel: float) -> float:
        """Return the speed of the ram [mm/s]."""
        angle = self.angle_at(travel)
        sine, ratio = math.sin(angle), self.rod_ratio
        bent = ratio * math.cos(angle) / math.sqrt(1.0 - (ratio * sine) ** 2)
        return self.speed * self.radius * sine * (1.0 + bent)

    def share_borne(self, speed: float) -> float:
        """Return the force that torque allows at a speed of the ram [mm/s], over the rated force, up to 1.

        Torque times the crank's speed is force times the ram's. A quarter turn before bottom dead centre a crank rated
        at 30 degrees bears half of its rated force.

        >>> crank = Crank(100.0, 0.0, 1.0, 100.0, rated_height=100.0 * (1.0 - math.cos(math.pi / 6)))
        >>> round(crank.share_borne(crank.speed_at(0.0)), 12), crank.share_borne(crank.speed_at(95.0))
        (0.5, 1.0)
        """
        rated = self.speed_at(self.start - self.rated_height)
        return min(rated / speed, 1.0) if speed > 0.0 else 1.0

    def time_at(self, travel: float) -> float:
        """Return the time until it has gone so far [s]."""
        return (self.angle_at(0.0) - self.angle_at(travel)) / self.speed

    def travel_at(self, time: float) -> float:
        """Return how far it has gone after a time [mm]; it stays at bottom dead centre."""
        return self.start - self.height_at(max(self.angle_at(0.0) - self.speed * time, 0.0))


@dataclass(frozen=True)
class Blow:
    """A ram that its own kinetic energy drives until the workpiece has taken it: hammers and screw presses."""

    energy: float
    """Energy that the workpiece takes [N mm]: the kinetic energy times the efficiency of the blow."""
    velocity: float
    """Velocity of the ram when it strikes [mm/s]."""
    number: int = 1
    """Counted from 1 over the blows of this press."""

    def speed_with(self, left: float) -> float:
        """Return the speed of the ram [mm/s] when so much of the energy is left [N mm]."""
        return self.velocity * math.sqrt(min(max(left, 0.0) / self.energy, 1.0))


@dataclass(frozen=True)
class Drive:
    """The ram of a press in one stage."""

    motion: SpeedTable | Crank | Blow
    travel: float
    """Travel of the ram over the whole stage [mm]."""
    whole: float = 1.0
    """Work of the ram over that of the moved tools, as modelled: mirror images work, too."""
    press: str = ""
    """Name of the press; empty: the stage gives a velocity."""
    force: float = math.inf
    """Force at which the ram stops, and the stage ends [N]."""
    power: float = math.inf
    """Largest power [N mm/s]: the ram is slowed down so that its force times its speed does not exceed it."""
    rated_force: float = math.inf
    """Force that the press bears [N]: beyond it the run goes on and warns."""
    rated_energy: float = math.inf
    """Energy that it gives in one stroke [N mm]: beyond it the run goes on and warns."""

    @property
    def duration(self) -> float:
        """Time of the stage [s]; of a blow and of limited force or power an estimate: the course decides."""
        if isinstance(self.motion, Blow):
            return 2.0 * self.travel / self.motion.velocity
        return self.motion.time_at(self.travel)

    @property
    def is_prescribed(self) -> bool:
        """Whether the time follows from the travel alone."""
        return not isinstance(self.motion, Blow) and math.isinf(self.power)

    @property
    def may_end_early(self) -> bool:
        """Whether the stage may end before its whole travel is complete."""
        return isinstance(self.motion, Blow) or math.isfinite(self.force)

    def time_between(self, start: float, end: float) -> float:
        """Return the time between two fractions of the travel, where it follows from the travel alone [s]."""
        assert not isinstance(self.motion, Blow), "the time of a blow follows from its course"
        return self.motion.time_at(end * self.travel) - self.motion.time_at(start * self.travel)

    def speed_at(self, part: float) -> float:
        """Return the speed [mm/s] at a fraction of the travel, where it follows from the travel alone."""
        assert not isinstance(self.motion, Blow), "the speed of a blow follows from its course"
        return self.motion.speed_at(part * self.travel)

    def force_borne(self, speed: float) -> float:
        """Return the force that the press bears where its ram has a speed [mm/s] in the stage [N]."""
        return self.rated_force * (self.motion.share_borne(speed) if isinstance(self.motion, Crank) else 1.0)

    def part_at(self, time: float) -> float:
        """Return the fraction of the travel that is complete after a time [s], where it follows from the time alone."""
        assert not isinstance(self.motion, Blow), "the travel of a blow follows from its course"
        return min(self.motion.travel_at(time) / self.travel, 1.0)


def _mean_speed(first: float, last: float) -> float:
    """Return the travel over the time between two speeds, speed being linear in the travel: their logarithmic mean."""
    ratio = (last - first) / first
    return first if abs(ratio) < 1e-14 else first * ratio / math.log1p(ratio)
