# SPDX-License-Identifier: Apache-2.0
"""The depth to which a sheet that touches itself overlaps."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.observe.contract import History, Measure, Observed, Observer, Row

OVERLAP = "overlap"
"""Column of the history: by how much two parts of the sheet overlap most [mm], their thickness counted."""
WORTH_A_WARNING = 0.05
"""Part of the thickness by which they may."""


class Overlap(Observer):
    """The overlap of a sheet that may touch itself."""

    def columns(self, run: Observed) -> list[str]:
        """Return one where the sheet may touch itself."""
        return [OVERLAP] if run.model.self_contact else []

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the overlap."""
        return {OVERLAP: run.overlap()} if run.model.self_contact else {}

    def measures(self, run: Observed) -> list[Measure]:
        """Return the overlap, by the thickness of the sheet at the start."""
        if not run.model.self_contact:
            return []
        depth, thickness = run.overlap(), run.model.thickest
        fact = f"the sheet of {thickness:g} mm overlaps itself by {depth:.3g} mm"
        return [Measure("penetration", depth / thickness, fact)]

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the largest overlap in any row [mm]."""
        return {"overlap_mm": float(np.max(history[OVERLAP], initial=0.0))} if run.model.self_contact else {}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return a warning where the sheet has sunk into itself."""
        if not run.model.self_contact:
            return []
        deep, thickness = self.summary(run, history)["overlap_mm"], run.model.thickest
        if deep <= WORTH_A_WARNING * thickness:
            return []
        share = 100.0 * deep / thickness
        other = "drive them slower" if run.model.explicit else "set implicit.contact_stiffness higher"
        return [
            f"the sheet overlaps itself by up to {deep:.3g} mm, {share:.3g} % of its thickness: leave tools more room "
            f"(less stroke), {other}, or refine the mesh"
        ]
