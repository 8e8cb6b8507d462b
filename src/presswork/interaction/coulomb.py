# SPDX-License-Identifier: Apache-2.0
"""Friction with a limit by return mapping: of nodes on tools in the plane and in space, and of drawbeads.

What touches hangs on an elastic spring. The spring's force at the end of an increment is a trial; where it exceeds what
the law allows, mu N of Coulomb's law for instance, it is shortened to that and keeps its direction.

Bodies on each other have the same law inside their kernel (cpp/contact/interface.cpp), which takes its derivative by
the nodes of both bodies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray


@dataclass(frozen=True)
class Returned:
    """Friction of n points with one or d components."""

    force: FloatArray
    """(n,) or (n, d) [N]."""
    slides: BoolArray
    """(n,)."""
    size: FloatArray
    """Size of the trial force where the point slides, else 1 (n,) [N]."""
    along: FloatArray
    """The trial over `size`: where the point slides, the unit vector of its friction; in the form of force."""


def return_to_limit(trial: FloatArray, limit: FloatArray) -> Returned:
    """Return the friction that a trial (n,) or (n, d) [N] leads to; limit: the largest that the law allows (n,) [N]."""
    whole = np.abs(trial) if trial.ndim == 1 else np.linalg.norm(trial, axis=1)
    slides = np.asarray(whole > limit, dtype=bool)
    size, kept = np.where(slides, whole, 1.0), np.where(slides, limit, 0.0)
    if trial.ndim == 1:
        along = trial / size
        return Returned(np.where(slides, kept * along, trial), slides, size, along)
    along = trial / size[:, None]
    return Returned(np.where(slides[:, None], kept[:, None] * along, trial), slides, size, along)
