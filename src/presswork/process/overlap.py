# SPDX-License-Identifier: Apache-2.0
"""By how much a sheet that touches itself overlaps: column of the history, summary and warning of both procedures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import Model

OVERLAP = "overlap"
"""Column of the history: by how much two parts of the sheet overlap most [mm], their thickness counted."""
WORTH_A_WARNING = 0.05
"""Part of the thickness by which they may."""


def summarise_overlap(model: Model, history: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Return the largest overlap in any row [mm] of a sheet that touches itself."""
    return {"overlap_mm": float(np.max(history[OVERLAP], initial=0.0))} if model.self_contact else {}


def warn_of_overlap(model: Model, history: Mapping[str, NDArray[Any]]) -> list[str]:
    """Return a warning where the sheet has sunk into itself."""
    deep, thickness = summarise_overlap(model, history).get("overlap_mm", 0.0), model.sheet[0].thickness
    if deep <= WORTH_A_WARNING * thickness:
        return []
    share = 100.0 * deep / thickness
    other = "drive them slower" if model.explicit else "set implicit.contact_stiffness higher"
    return [
        f"the sheet overlaps itself by up to {deep:.3g} mm, {share:.2g} % of its thickness: leave tools more room "
        f"(less stroke), {other}, or refine the mesh"
    ]
