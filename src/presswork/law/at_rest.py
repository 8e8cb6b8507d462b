# SPDX-License-Identifier: Apache-2.0
"""What the law of a solid keeps at its points before anything moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.law.elastic_plastic import SolidLaw
from presswork.law.umat import UNDEFORMED
from presswork.model import POROSITY, FloatArray


def history_at_rest(
    law: _core.VonMises | SolidLaw | _core.Umat,
    size: tuple[int, ...],
    components: int,
    *,
    rolling: Sequence[float] = (1.0, 0.0, 0.0),
    porosity: float = 0.0,
) -> FloatArray:
    """Return what a law of a stress of 4 or 6 components keeps behind stress and plastic strain (*size, n_history).

    rolling: unit vector along the law's x; porosity: of a metal with pores.
    """
    if isinstance(law, _core.VonMises):
        return np.zeros((*size, 0))
    if isinstance(law, _core.Umat):
        history = np.zeros((*size, law.n_state + _core.umat_history_size(components)))
        history[..., law.n_state + UNDEFORMED] = 1.0
        if porosity > 0.0:
            history[..., POROSITY] = porosity
        return history
    history = np.zeros((*size, _core.kept_values(law)))
    if isinstance(law, _core.SolidLaw):
        across = np.cross([0.0, 0.0, 1.0], rolling)
        length = float(np.linalg.norm(across))
        history[..., -6:-3] = rolling
        history[..., -3:] = across / length if length > 1e-6 else (1.0, 0.0, 0.0)
    else:
        history[..., -2:] = rolling[:2]
    return history
