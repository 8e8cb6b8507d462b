# SPDX-License-Identifier: Apache-2.0
"""A material law that refused an increment, and what a law from a shared library learns about an increment."""

from __future__ import annotations

from dataclasses import dataclass

from presswork import _core
from presswork.law.umat import STATUS_MESSAGES
from presswork.outcome import BadGuess, Step

_CUT = {
    _core.LawStatus.not_finite: 0.5,
    _core.LawStatus.no_stress: 0.5,
    _core.LawStatus.overrun: 0.0,
    _core.LawStatus.stopped: 0.0,
    _core.LawStatus.components: 0.0,
}
"""Factor that cuts an increment; 0 gives up."""


@dataclass(frozen=True)
class LawFailed(BadGuess):
    """A law that refused the trial displacement; the increment must be cut."""

    block: int
    cell: int
    status: _core.LawStatus
    step_factor: float
    """Factor that cuts the step."""

    @classmethod
    def of(cls, block: int, fault: _core.LawFault) -> LawFailed:
        """Return what a block's fault asks for."""
        return cls(block, fault.cell, fault.status, _CUT.get(fault.status, fault.step_factor))

    @property
    def is_final(self) -> bool:  # type: ignore[override]
        """Whether the law has decided what to do, so that no shorter correction is tried."""
        return self.status not in (_core.LawStatus.not_finite, _core.LawStatus.no_stress)

    @property
    def factor(self) -> float:
        """Return the factor that cuts the increment."""
        return self.step_factor

    def __str__(self) -> str:
        return f"{STATUS_MESSAGES[self.status]} in cell {self.cell} of block {self.block}"


def place_increment(step: Step) -> _core.UmatPlace:
    """Return the increment's place in the run, as a law from a shared library receives it."""
    return _core.UmatPlace(
        stage=step.stage + 1,
        increment=step.number,
        stage_time=step.stage_time_n,
        time=step.time_n,
        dt=step.dt,
    )
