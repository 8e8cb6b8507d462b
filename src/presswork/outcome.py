# SPDX-License-Identifier: Apache-2.0
"""The task of an increment, how its iteration went, and how a run ends that cannot go on."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class IterationLog:
    """Relative residual, relative correction and contact changes of every iteration of an increment."""

    residual: list[float] = field(default_factory=list)
    correction: list[float] = field(default_factory=list)
    contact_changes: list[int] = field(default_factory=list)
    solutions: list[str] = field(default_factory=list)
    """How an iterative solver found the corrections; empty where they came from factors."""
    augmented: list[int] = field(default_factory=list)
    """Iterations after which multipliers were taken over, and equilibrium was sought anew."""
    start: int = 1
    """First iteration towards the present equilibrium: what contact asks for has been changed on purpose before it."""

    def __len__(self) -> int:
        return len(self.residual)

    def forget_last(self) -> None:
        """Take the last iteration back, to note it again."""
        for row in (self.residual, self.correction, self.contact_changes):
            row.pop()

    def extend(self, other: IterationLog) -> None:
        """Add the iterations of another attempt at the same increment."""
        self.residual += other.residual
        self.correction += other.correction
        self.contact_changes += other.contact_changes
        self.solutions += other.solutions

    @property
    def since_augmented(self) -> int:
        """Iterations before the present multipliers were taken over; 0: those that the increment began with."""
        return self.augmented[-1] if self.augmented else 0

    @property
    def smooth_iterations(self) -> int:
        """Iterations less those that changes of contact cost, about two each, which no smaller increment saves."""
        return len(self) - 2 * sum(changes > 0 for changes in self.contact_changes)


@dataclass(frozen=True)
class Converged:
    """The trial state is in equilibrium."""

    log: IterationLog


@dataclass(frozen=True)
class Failed:
    """The increment cannot be solved; try again with `factor` of it."""

    log: IterationLog
    reason: str
    factor: float


class TooCoarse(Failed):
    """The increment is in equilibrium, but too long to be accurate."""


@dataclass(frozen=True)
class Step:
    """Where an increment leads: a fraction of a stage, from the fraction before."""

    stage: int
    fraction_n: float
    fraction: float
    number: int
    """Number of the increment, counted from 1 over all stages."""
    time_n: float
    """When it begins [s]."""
    dt: float
    """Time that it takes [s]."""
    stage_time_n: float
    """Since the stage began, when it begins [s]."""

    @property
    def is_at_rest(self) -> bool:
        """Whether it leads nowhere: equilibrium on a new mesh."""
        return self.fraction == self.fraction_n


class BadGuess:
    """Why a guess at the nodes' displacement cannot be evaluated; the correction is shortened or the increment cut."""

    is_final = False
    """Whether a shorter correction is not to be tried."""

    @property
    def factor(self) -> float:
        """Return the factor that cuts the increment."""
        return 0.5


@dataclass(frozen=True)
class PassedThrough(BadGuess):
    """Bodies whose surfaces the trial displacement has moved through each other."""

    contact: str

    def __str__(self) -> str:
        return f"surfaces of contact {self.contact!r} passed through each other"


class GaveUpError(Exception):
    """The procedure cannot go on; the state of the last report is kept."""


class GoalReachedError(Exception):
    """The run is complete before its last stage ends."""


class StartError(Exception):
    """Nothing can be computed from this start; raised before the output folder is touched."""


class ShortOfMemoryError(StartError):
    """The computation takes more memory than there is."""
