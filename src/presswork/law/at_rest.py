# SPDX-License-Identifier: Apache-2.0
"""What the law of a solid keeps at its points before anything moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.law.history import DEFORMATION_GRADIENT, EQPS, POROSITY, History, list_history
from presswork.model import FloatArray

UNDEFORMED = np.array([0, 4, 8])
"""Diagonal of a deformation gradient."""


def history_at_rest(
    law: _core.VonMises | _core.AdiabaticMises | _core.PlaneLaw | _core.SolidLaw | _core.Umat,
    size: tuple[int, ...],
    components: int,
    *,
    rolling: Sequence[float] = (1.0, 0.0, 0.0),
    porosity: float = 0.0,
    beside: Sequence[str] = (EQPS,),
) -> FloatArray:
    """Return what a law of a stress of 4 or 6 components keeps behind the stress (*size, n_history).

    rolling: unit vector along the law's x; porosity: of a metal with pores; beside: parts that have arrays of their
    own.
    """
    return fill_history(list_history(law, components).without(*beside), size, rolling=rolling, porosity=porosity)


def fill_history(
    history: History,
    size: tuple[int, ...],
    *,
    rolling: Sequence[float] = (1.0, 0.0, 0.0),
    porosity: float = 0.0,
) -> FloatArray:
    """Return the parts of a history before anything moves (*size, n_history), as history_at_rest."""
    values = np.zeros((*size, history.size))
    for axes in history.axes:
        values[..., axes] = _find_axes(np.asarray(rolling, dtype=float))[: axes.stop - axes.start]
    if DEFORMATION_GRADIENT in history:
        values[..., history[DEFORMATION_GRADIENT]][..., UNDEFORMED] = 1.0
    if porosity > 0.0:
        values[..., history[POROSITY]] = porosity
    return values


def _find_axes(rolling: FloatArray) -> FloatArray:
    """Return x and y of a law in space (6,); y lies across x in the plane of x and y, as far as there is one."""
    across = np.cross([0.0, 0.0, 1.0], rolling)
    length = float(np.linalg.norm(across))
    return np.concatenate([rolling, across / length if length > 1e-6 else (1.0, 0.0, 0.0)])
