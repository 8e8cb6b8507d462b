# SPDX-License-Identifier: Apache-2.0
"""Limits beyond which a state has no physical meaning."""

from __future__ import annotations

from dataclasses import dataclass

FEW_OUTSIDE = 1e-3
"""Share of points and increments outside the window of a law below which the law is not doubted."""
FULL_DIE = 0.98
"""Part of a die's wall with metal on it from which on the die counts as full."""


@dataclass(frozen=True)
class Goal:
    """A value of a column of the history at which a run is complete."""

    column: str
    above: float | None = None
    """Reached where the column is at least this."""
    below: float | None = None
    """Reached where the column is at most this."""

    def is_reached(self, value: float) -> bool:
        """Return whether a value of the column completes the run."""
        return (self.above is not None and value >= self.above) or (self.below is not None and value <= self.below)


@dataclass(frozen=True)
class Limits:
    """A run stops at the first converged state beyond one of these; docs/howto/gave_up.md has the reasons."""

    stop: bool = True
    """False: the run continues, and warns."""
    penetration: float = 0.5
    """Penetration of a tool, or of another body, into an edge of a solid, over the edge's length at the start; into the
    surface of a sheet, over its thickness."""
    thinning: float = 0.7
    """Thinning of a sheet, over its thickness at the start."""
    hydrostatic_stress: float = 30.0
    """Hydrostatic stress, tension or compression, over the flow stress."""
    mean_pressure: float = 10.0
    """Mean pressure in a body between tools, over its mean flow stress: a closed cavity. It holds whatever `stop`."""
    force: float | None = None
    """Largest force of the press on a tool that moves [N]; the run goes on beyond it, and its verdict fails."""
    contact_pressure: float | None = None
    """Largest contact pressure that the tools bear [MPa]; the run goes on beyond it, and its verdict fails."""
    end: tuple[Goal, ...] = ()
    """The run is complete at the first row that reaches one of these."""
