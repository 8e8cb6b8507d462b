# SPDX-License-Identifier: Apache-2.0
"""Draw-in of the edge of a drawn sheet in every direction."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.model import FloatArray
from presswork.post.section import cut_sheet, find_sheets
from presswork.results import Result
from presswork.results.whole_file import write_whole

EVERY = 3.0
"""Degrees between two directions."""


def measure_draw_in_around(result: Result, step: int = -1) -> FloatArray:
    """Return rows of angle from x [degree] and draw-in [mm] (n, 2), all round or as far as the part is computed.

    Directions in which no sheet lies are left out.
    """
    symmetry = str(result.info.get("symmetry", ""))
    low, high = {"": (0.0, 360.0), "x": (-90.0, 90.0), "y": (0.0, 180.0)}.get(symmetry, (0.0, 90.0))
    rows, sheets = [], [find_sheets(result.mesh_at(s)) for s in (0, step)]
    for angle in np.linspace(low, high, round((high - low) / EVERY) + 1):
        turned = float(np.radians(angle))
        before, now = (cut_sheet(result, turned, s, sheets=own).line for s, own in zip((0, step), sheets, strict=True))
        if len(before):
            rows.append((angle, before[-1, 1, 0] - now[-1, 1, 0]))
    return np.array(rows).reshape(-1, 2)


def write_draw_in(result: Result, path: Path | str, step: int = -1) -> None:
    """Write the draw-in in every direction as CSV. Raises OutputError."""
    lines = ["angle_degree,draw_in_mm", *(f"{a:.7g},{d:.7g}" for a, d in measure_draw_in_around(result, step))]
    content = ("\n".join(lines) + "\n").encode()
    write_whole(Path(path), content)
