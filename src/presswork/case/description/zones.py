# SPDX-License-Identifier: Apache-2.0
"""Zones of a welded blank, and the thickness of a rolled one, as `check` describes them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.model import FloatArray, Model


def describe_zones(problem: Model) -> Iterator[str]:
    """Describe the zones of a welded blank, and the thickness of a rolled one."""
    mesh, whole = problem.mesh, problem.whole
    if mesh.blocks[0].own_thickness is not None and not problem.zones:
        thickness = np.concatenate([block.thickness for block in mesh.blocks])
        yield f"rolled blank: {thickness.min():.4g} to {thickness.max():.4g} mm thick"
    for number, blocks in ((own[0].zone, own) for own in problem.blocks_of_zones):
        if not problem.zones:
            return
        area = sum(float(_measure_area(mesh.points[block.connectivity]).sum()) for block in blocks)
        thickness = np.concatenate([block.thickness for block in blocks])
        t = f"{thickness.min():.4g}" if np.ptp(thickness) < 1e-9 else f"{thickness.min():.4g} to {thickness.max():.4g}"
        name = f"zone {problem.zones[number]}" if number else "blank beside its zones"
        angle = "" if blocks[0].rolling is None else f", rolling direction {_find_degrees(blocks[0].rolling):g} degrees"
        of = problem.materials[blocks[0].material].name.partition(" (")[0]
        yield f"{name}: {t} mm of {of}{angle}, {len(thickness)} elements, {whole * area:.4g} mm2"
    if problem.zones or mesh.blocks[0].own_thickness is not None:
        yield f"tools: {'stepped where the blank is thinner' if problem.is_relieved else 'as drawn'} (blank.relief)"


def _measure_area(corners: FloatArray) -> FloatArray:
    """Return the areas of flat cells by their corners (n, 3 | 4, 3) (n,) [mm2]."""
    x, y = corners[..., 0], corners[..., 1]
    return np.asarray(0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))


def _find_degrees(direction: tuple[float, float, float]) -> float:
    return float(np.degrees(np.arctan2(direction[1], direction[0])))
