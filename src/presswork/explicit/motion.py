# SPDX-License-Identifier: Apache-2.0
"""How far a tool has gone at a time: smooth strokes, tables of velocity or force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from presswork.explicit.input_checks import ExplicitError
from presswork.model import Drive

Array = npt.NDArray[np.float64]
FIT = 1e-3
"""Part of the stroke by which a velocity curve may miss it."""


class Motion(Protocol):
    """A travel along a line as a function of time."""

    def position(self, time: Array) -> Array:
        """Return the travel [mm] at times (n) [s]."""
        ...


@dataclass(frozen=True)
class SmoothStroke:
    """A stroke [mm] in a duration [s] from `start` on: velocity rises as half a cosine, is constant, falls likewise.

    rise: part of the duration that the rise takes, and the fall, at most 0.5, which is a bell without a constant part.
    speed: the constant velocity [mm/s], where it is to be checked against stroke and duration.

    >>> stroke = SmoothStroke(30.0, 0.02, rise=0.25)
    >>> float(stroke.peak)
    2000.0
    >>> stroke.position(np.array([0.0, 0.01, 0.02])).tolist()
    [0.0, 15.0, 30.0]
    """

    stroke: float
    duration: float
    rise: float = 0.2
    start: float = 0.0
    speed: float | None = None

    def __post_init__(self) -> None:
        if not self.duration > 0:
            raise ExplicitError(f"duration = {self.duration:g} s: it must be above zero")
        if not 0 < self.rise <= 0.5:
            raise ExplicitError(f"rise = {self.rise:g}: the rise takes above 0 and at most 0.5 of the duration")
        if self.speed is not None and abs(self.speed - self.peak) > FIT * abs(self.peak):
            raise ExplicitError(
                f"speed = {self.speed:g} mm/s does not fit: a stroke of {self.stroke:g} mm in {self.duration:g} s with "
                f"rise = {self.rise:g} needs {self.peak:g} mm/s, or {self.duration * self.peak / self.speed:g} s"
            )

    @property
    def peak(self) -> float:
        """The constant velocity [mm/s]."""
        return self.stroke / (self.duration * (1.0 - self.rise))

    def position(self, time: Array) -> Array:
        """Return the travel [mm] at times (n) [s]."""
        t = np.clip(np.asarray(time, dtype=float) - self.start, 0.0, self.duration)
        ramp = self.rise * self.duration

        def rising(since: Array) -> Array:
            return 0.5 * self.peak * (since - ramp / np.pi * np.sin(np.pi * since / ramp))

        left = self.duration - t
        constant = 0.5 * self.peak * ramp + self.peak * (t - ramp)
        return np.where(t < ramp, rising(t), np.where(left < ramp, self.stroke - rising(left), constant))


@dataclass(frozen=True)
class DrivenStroke:
    """The part of a stage's travel that a ram has done, times `scale`, from `start` [s] on.

    Where the duration of the stage depends on its course, all moves evenly.
    """

    drive: Drive
    scale: float = 1.0
    start: float = 0.0

    def position(self, time: Array) -> Array:
        """Return the travel at times (n) [s]."""
        since = np.clip(np.asarray(time, dtype=float) - self.start, 0.0, self.drive.duration)
        if not self.drive.is_prescribed:
            return np.asarray(self.scale * since / self.drive.duration)
        return self.scale * np.array([self.drive.part_at(float(t)) for t in np.atleast_1d(since)]).reshape(since.shape)


@dataclass(frozen=True)
class EvenMotion:
    """A constant velocity [mm/s]."""

    velocity: float

    def position(self, time: Array) -> Array:
        """Return the travel [mm] at times (n) [s]."""
        return np.asarray(self.velocity * np.asarray(time, dtype=float))


class VelocityCurve:
    """Velocity [mm/s] at times [s], straight between them and zero outside; stroke [mm]: what it must come to."""

    def __init__(self, times: npt.ArrayLike, velocities: npt.ArrayLike, *, stroke: float | None = None) -> None:
        self.times, self.velocities = check_table(times, velocities, "velocity")
        steps = 0.5 * (self.velocities[1:] + self.velocities[:-1]) * np.diff(self.times)
        self._travelled = np.concatenate([[0.0], np.cumsum(steps)])
        if stroke is not None and abs(self._travelled[-1] - stroke) > FIT * abs(stroke):
            raise ExplicitError(
                f"stroke = {stroke:g} mm, but the velocity curve comes to {self._travelled[-1]:g} mm: scale the "
                f"velocities by {stroke / self._travelled[-1] if self._travelled[-1] else np.inf:g}, or correct the "
                "stroke"
            )

    def position(self, time: Array) -> Array:
        """Return the travel [mm] at times (n) [s]."""
        t = np.clip(np.asarray(time, dtype=float), self.times[0], self.times[-1])
        at = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        since = t - self.times[at]
        slope = np.diff(self.velocities)[at] / np.diff(self.times)[at]
        return np.asarray(self._travelled[at] + (self.velocities[at] + 0.5 * slope * since) * since)


def check_table(times: npt.ArrayLike, values: npt.ArrayLike, name: str) -> tuple[Array, Array]:
    """Give times and values as arrays; raise ExplicitError where they are no table over rising times."""
    t, v = (np.atleast_1d(np.asarray(a, dtype=float)) for a in (times, values))
    if t.ndim != 1 or t.shape != v.shape or len(t) < 2:
        raise ExplicitError(f"{name} curve: {t.shape} times and {v.shape} values; give at least two of each")
    if not (np.isfinite(t).all() and np.isfinite(v).all()):
        raise ExplicitError(f"{name} curve: a value is not a finite number")
    if not (np.diff(t) > 0).all():
        raise ExplicitError(
            f"{name} curve: times must rise, but {t[np.argmin(np.diff(t) > 0) + 1]:g} s comes too early"
        )
    return t, v
