# SPDX-License-Identifier: Apache-2.0
"""The stable step of a sheet's mesh as a whole, which is longer than that of its worst shell by itself.

A copy of the sheet, elastic, free and at rest where the sheet is now, is set in small random motion and run by a step
that is too long. Central differences multiply a mode of frequency w by -mu a step, with mu + 1/mu = (w dt)^2 - 2 where
w dt > 2, so the highest modes soon outgrow all others, and their growth shows the highest frequency. The cycles are
those of Chebyshev's polynomials of the mesh's matrix: no other n products with it estimate its largest eigenvalue much
better (Saad 2011, chapter 4). Supports and plastic flow only lower it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from presswork.explicit.blocks import Shells
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.space import Precision, SpaceDynamics
from presswork.model import FloatArray

FIRST, BEYOND, FAR = 1.5, 1.06, 1.1
"""The step tried: over the shells' own bound at first, over the last answer then; again where it is so far too long."""
CYCLES, MOST = 5, 80
"""Number of cycles between two looks at the growth, and in all."""
CLEAR, ENOUGH = 1e2, 1e9
"""Growth that is no beat of stable modes, and that at which the highest modes are alone."""
SMALL = 1e-20
"""Size of the random motion at the start, a step [mm]; grown by `ENOUGH`, five cycles later, it is still elastic."""


class MeshStep:
    """Finds the stable step of the mesh over the bound of its shells, time after time."""

    def __init__(self, shells: ExplicitShells, precision: Precision) -> None:
        """Make the copy of the sheet that is tried."""
        undamaged = [replace(block, damage=()) for block in shells.blocks if isinstance(block, Shells)]
        self._copy = SpaceDynamics(shells.start, undamaged, precision=precision, hanging=shells.hanging)
        self.cycles = 0
        """Run so far, each as long as one of the sheet without its tools."""

    def find_factor(self, shells: ExplicitShells, last: float) -> float:
        """Return by which factor the sheet's mesh bears a longer step now than its worst shell by itself, at least 1.

        last: the last answer for this mesh, or 0. Where nothing grows, the step tried is stable, and the answer: it
        rises by 6 % at most from one to the next, and falls as far as it must.
        """
        tried = BEYOND * last if last > 0.0 else FIRST
        found = self._try(shells, tried)
        if tried > FAR * found:  # so many modes grow then that the highest is not alone
            found = self._try(shells, BEYOND * found)
        return max(found, 1.0)

    def _try(self, shells: ExplicitShells, factor: float) -> float:
        """Return the factor that the mesh bears, or the one given where no motion grows with that."""
        loop: Any = self._copy._loop  # of the same precision as the sheet's
        dt = factor * shells.stable_step()
        loop.take_shape(shells._loop)
        motion = np.zeros((len(shells.start), 6))
        motion[:, :3] = SMALL / dt * np.random.default_rng(1).standard_normal((len(motion), 3))
        loop.velocity = motion
        weight = loop.inverse_mass
        weight = np.repeat(np.divide(1.0, weight, where=weight > 0, out=np.zeros_like(weight)), 3, axis=1)
        size = first = _measure(loop.velocity, weight)
        growth, cycles = 1.0, 0
        while cycles < MOST and size < ENOUGH * first:
            for n in (CYCLES - 1, 1):
                before = size
                loop.advance(0.0, dt, dt, np.zeros(n), np.zeros(n), damping=0.0)
                size = _measure(loop.velocity, weight)
            growth = size / before
            cycles += CYCLES
        self.cycles += cycles
        if size < CLEAR * first:
            return factor
        if not 1.0 < growth < np.inf:  # no mode by itself: the shells' own bound is sure
            return 1.0
        return factor * 2.0 / float(np.sqrt(growth + 1.0 / growth + 2.0))


def _measure(velocity: FloatArray, weight: FloatArray) -> float:
    """Return the root of twice the kinetic energy of small velocities."""
    largest = float(np.abs(velocity).max())
    return largest * float(np.sqrt((weight * (velocity / largest) ** 2).sum())) if largest > 0 else 0.0
