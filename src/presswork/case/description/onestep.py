# SPDX-License-Identifier: Apache-2.0
"""A one-step model in words."""

from __future__ import annotations

import numpy as np

from presswork.case.description.material import describe_material
from presswork.model import OneStepModel


def describe_onestep(problem: OneStepModel) -> list[str]:
    """Return a line per fact."""
    low, high = problem.points.min(axis=0), problem.points.max(axis=0)
    size = " x ".join(f"{length:.4g}" for length in high - low)
    counts = [(len(problem.triangles), "triangles"), (len(problem.quadrilaterals), "quadrilaterals")]
    cells = " and ".join(f"{count} {name}" for count, name in counts if count)
    holes = len(problem.rims) - 1
    lines = [f"part {size} mm, {cells}" + (f", {holes} holes" if holes else "")]
    planes = [f"{axis} = 0" for axis, wanted in zip("xy", problem.symmetry, strict=True) if wanted]
    if planes:
        lines.append(f"mirrored by {' and '.join(planes)}")
    angle = np.degrees(problem.rolling_direction)
    lines.append(
        f"blank {problem.thickness:g} mm thick, {problem.layers} points, rolling direction at {angle:g} degrees"
    )
    lines.append(f"material {problem.material.name}: {describe_material(problem.material)}")
    if problem.holder_force:
        lines.append(f"holder {problem.holder_force / 1e3:g} kN")
    lines.append(f"friction mu = {problem.mu:g}")
    if problem.stages > 1:
        lines.append(f"by way of {problem.stages} shapes, the part among them")
    lines += [f"bead of {len(b.points)} points, {b.force:g} N/mm" for b in problem.beads]
    lines += [f"note: {note}" for note in problem.notes]
    return lines
