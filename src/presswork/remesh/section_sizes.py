# SPDX-License-Identifier: Apache-2.0
"""The size of cells that tools, thickness and cracks ask for in a section, within the budget of cells."""

from __future__ import annotations

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import Remeshing
from presswork.remesh.landing import find_landings
from presswork.remesh.narrow_gaps import find_corners_ahead
from presswork.remesh.old_section import OldSection
from presswork.remesh.size_field import (
    GradedSize,
    SizeSources,
    along_tool,
    error_sources,
    gap_sources,
    join_sources,
    metal_thickness,
    tool_curvature,
)

LEAST_ACROSS = 1.5
"""Cells across the metal below which a budget is too small."""


def measure_sizes(old: OldSection, settings: Remeshing, *, part: float = 1.0) -> GradedSize:
    """Return the size of cells that tools and thickness ask for now, a part of it, within the budget."""
    size = ask_for_sizes(old, settings)
    keep_budget(settings, size, part, expect_cells(old, size))
    return size


def ask_for_sizes(old: OldSection, settings: Remeshing) -> GradedSize:
    """Return the size of cells that tools and thickness ask for now, whatever the budget."""
    sides = old.sides
    sources = [gap_sources(sides, old.held_sides)]
    sources += [tool_curvature(sides, p, settings.size, settings.smallest_size) for p in old.profiles]
    sources += [
        along_tool(sides, profile, settings.size, own)
        for profile, own in zip(old.profiles, settings.tool_sizes, strict=False)
        if own < settings.size
    ]
    if settings.error and old.power is not None:
        sources.append(error_sources(old.position[old.corners()], old.corners(), old.power, settings.error))
    sources += [
        find_corners_ahead(*before, smallest=settings.smallest_size, largest=settings.size)
        for before in old.before_others
    ]
    sources += [old.cracks] if old.cracks is not None else []
    landings, others = _find_landings(old, settings), join_sources(*sources)
    least = min(settings.smallest_size, float(landings.size.min(initial=np.inf)))
    joined = join_sources(landings, SizeSources(others.place, np.maximum(others.size, settings.smallest_size)))
    size = GradedSize(sides[:, 0], joined, settings.size, least)
    for window in settings.windows:
        size.limit(window.box, window.size)
    return size


def _find_landings(old: OldSection, settings: Remeshing) -> SizeSources:
    """Return the sizes wanted where the free surface comes to lie on tools and on other bodies."""
    sizes = {"smallest": settings.smallest_size, "largest": settings.size}
    closing = () if old.closing is None else old.closing
    share = np.zeros(len(old.position)) if old.share is None else old.share
    held = [*old.on_tool[: len(old.profiles)], *(old.on_tool[-1] for _ in old.others)]
    return join_sources(
        SizeSources(np.zeros((0, 2)), np.zeros(0)),
        *(
            find_landings(
                old.position[chain], on_tool[chain], (old.loose & nearer)[chain], profile, share[chain], **sizes
            )
            for chain in old.chains
            for profile, on_tool, nearer in zip([*old.profiles, *old.others], held, closing, strict=False)
        ),
    )


def expect_cells(old: OldSection, size: GradedSize) -> float:
    """Return how many cells of a size there will be."""
    x, y = np.moveaxis(old.position[old.corners()], -1, 0)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    return float((area / size(np.column_stack([x.mean(axis=1), y.mean(axis=1)])) ** 2).sum())


def keep_budget(settings: Remeshing, size: GradedSize, part: float, expected: float) -> None:
    """Make cells smaller by a factor, but no smaller than the budget allows, in place; expected: cells before that."""
    size.scale(max(part, float(np.sqrt(expected / settings.max_cells))))


def check_budget(old: OldSection, settings: Remeshing) -> None:
    """Raise MeshError where the budget leaves less than LEAST_ACROSS cells across the metal, and a larger one not."""
    size = ask_for_sizes(old, settings)
    refuse_small_budget(old, settings, size, expect_cells(old, size))


def refuse_small_budget(old: OldSection, settings: Remeshing, size: GradedSize, expected: float) -> None:
    """Raise MeshError where the budget does not suffice for a size with which so many cells are expected."""
    lack = float(np.sqrt(expected / settings.max_cells))
    if lack <= 1.0:
        return
    thickness, middle = metal_thickness(old.sides, old.held_sides), old.sides.mean(axis=1)
    wanted = thickness / size(middle)
    across = wanted / lack
    worst = int(np.argmin(across))
    if across[worst] < min(LEAST_ACROSS, 0.99 * wanted[worst]):
        x, y = middle[worst]
        needed = int(np.ceil(settings.max_cells * (min(wanted[worst], 3.0) / across[worst]) ** 2))
        raise MeshError(
            f"max_cells = {settings.max_cells:,} leaves {across[worst]:.2g} cells across {thickness[worst]:.3g} mm of "
            f"metal near ({x:.4g}, {y:.4g})",
            f"max_cells = {needed:,} for three",
        )
