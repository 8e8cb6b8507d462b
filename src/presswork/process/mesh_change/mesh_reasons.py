# SPDX-License-Identifier: Apache-2.0
"""Why a body should not go on with its mesh, in words for run.log and as a number for the history."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.geometry.pose import shift_segments
from presswork.implicit.progress import Progress
from presswork.interaction.tool_arrays import ToolArrays
from presswork.model import BoolArray, FloatArray, Model, Remeshing, ToolMotion, find_cell
from presswork.remesh.fill import SizeField
from presswork.remesh.narrow_gaps import find_narrow_gap
from presswork.remesh.old_section import OldSection
from presswork.remesh.section_sizes import measure_sizes
from presswork.remesh.size_field import metal_thickness
from presswork.remesh.triggers import (
    TOO_DEEP,
    TOO_LONG,
    count_across,
    find_cut_edge,
    find_few_across,
    find_flat_cell,
    find_long_edge,
)
from presswork.state import State

LAST_CUT = 0.25
"""Depth of a tool in an edge, over its length, that ends a first mesh that is to stay."""
EARLY = 1.15
"""Factor by which edges are too long earlier just before a tool lands: a new mesh changes no force then."""
DUE, FAILS, STEP = "due", "the next increment fails", "the stable step is below"
"""Reasons that procedures know."""
CAUSES = {
    DUE: 1, FAILS: 2, "of quality": 3, "deep in": 4, "too long": 5, "cells across": 6, STEP: 7, "narrow for": 8,
    "a notch of": 10, "": 9,
}  # fmt: skip
"""Words of reasons, with the number that `remesh_cause` has in the history; the last: others."""


def find_cause(reason: str) -> int:
    """Return the number by which the history names the reason of a new mesh."""
    return next(number for words, number in CAUSES.items() if words in reason)


def find_reason(
    old: OldSection, increment: FloatArray, settings: Remeshing, wait: float, *, early: float = 1.0
) -> str | None:
    """Return why a body's mesh should not go on; wait: factor on the triggers; early: divides that of long edges."""
    flat = find_flat_cell(old.position, increment, old.corners(), settings.quality / wait)
    if flat is not None:
        return flat
    lines = [old.position[chain] for chain in old.chains]
    for line in lines:
        cut = find_cut_edge(line, old.profiles, deepest=wait * TOO_DEEP)
        if cut is not None:
            return cut
    size = measure_sizes(old, settings)
    gaps = (find_narrow_gap(*before, size, wait=wait) for before in old.before_others)
    narrow = next((gap for gap in gaps if gap is not None), None)
    if narrow is not None:
        return narrow
    longest = wait * TOO_LONG / early
    long = next((found for line in lines if (found := find_long_edge(line, size, longest=longest)) is not None), None)
    return long or _find_few_across(old, size, wait)


def find_reason_to_leave_first(old: OldSection) -> str | None:
    """Return why the first mesh of a body that is to stay should not go on."""
    cuts = (find_cut_edge(old.position[c], old.profiles, deepest=LAST_CUT, corners_count=True) for c in old.chains)
    return next((cut for cut in cuts if cut is not None), None)


def will_land(old: OldSection, state: State, model: Model) -> bool:
    """Return whether no tool bears a force yet, and one comes to a body with another increment like the last."""
    progress = state[Progress]
    if ToolArrays not in state or state[ToolArrays].force.any() or progress.last_size == 0.0:
        return False
    moves = find_tool_moves(state, model)
    nodes = np.ascontiguousarray(old.position[np.concatenate(old.chains)])
    return any(
        float(_core.touch_profile(shift_segments(profile, move), nodes)[0].min()) <= 0.0
        for profile, move in zip(old.profiles, moves, strict=True)
        if move.any()
    )


def find_tool_moves(state: State, model: Model) -> FloatArray:
    """Return the displacement of each tool in the plane in an increment like the last (n_tools, 2) [mm]."""
    if ToolArrays not in state:
        return np.zeros((0, 2))
    progress = state[Progress]
    motions = model.stages[progress.stage].tool_motion if progress.stage < len(model.stages) else {}
    strokes = np.array([motions.get(tool.name, ToolMotion()).move[:2] for tool in model.plane_tools])
    return progress.last_size * strokes + state[ToolArrays].travel_increment


def find_shares(state: State, fixed: BoolArray) -> FloatArray:
    """Return what each node bears, over the largest force of a tool (n_points,); nothing where no tool bears any.

    fixed: components that supports hold (n_points, 2): those are theirs.
    """
    largest = (
        float(np.linalg.norm(state[ToolArrays].force[:, :2], axis=1).max(initial=0.0)) if ToolArrays in state else 0.0
    )
    own = np.linalg.norm(state.nodes.reaction[:, :2] * ~fixed[:, :2], axis=1)
    return np.asarray(own / largest if largest > 0.0 else np.zeros(len(own)))


def _find_few_across(old: OldSection, size: SizeField, wait: float) -> str | None:
    """Describe where the metal has become too thin for its linear cells."""
    if find_cell(1, old.mesh.boundary_edges).is_quadratic:
        return None
    edges = np.concatenate([np.column_stack([chain, np.roll(chain, -1)]) for chain in old.chains])
    thickness = metal_thickness(old.sides, old.held_sides)
    across = count_across(old.sides, old.corners(), edges, old.position, thickness)
    return find_few_across(old.sides, across, thickness / size(old.sides.mean(axis=1)), wait=wait)
