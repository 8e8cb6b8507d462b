# SPDX-License-Identifier: Apache-2.0
"""Whether a part fits the tools of its next operation, before that is computed.

Certain faults are errors: no tool that moves meets the part, or a tool that is pushed starts away from it. Tools that
close are held against the part as its last tools had formed it: springback moves a wall by centimetres where it does
fit. Where that shape lies off the closed tools the part is formed anew; whether it was to be is not known: a warning.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.space.sheet_contact import share_surface
from presswork.mesh.tool_clearance import find_touch
from presswork.model import FloatArray, Operation, Stage, Tool, ToolMotion
from presswork.process.line.laying import (
    LayingError,
    find_half_thickness,
    gone_before,
    key_of,
    sample_part,
    write_place,
)
from presswork.process.line.tipping import Placed
from presswork.process.mesh_change.transfer import SheetState

OFF = 2.0
"""Thicknesses by which a part that fits may lie off closed tools: radii are struck smaller."""
SHARE = 0.15
"""Share of the part between closed tools that lies farther off, above which it does not fit."""
NO_FIT = 0.3, 5.0
"""Limits from which on a part does not fit: that share, and its mean distance over the thickness."""
FLAT = 3.0
"""Thicknesses: a part that is no higher has no shape that could fit."""
STEP = 0.5
"""Part of the thickness by which heights are tried."""
MOST_HEIGHTS = 200
MOST_POINTS = 5000
"""So many heights, at so many nodes, find the one where the part fits best."""
FAR = 10.0
"""Sizes of the part from which it comes down on the dies."""
UP = np.array([0.0, 0.0, 1.0])
UPRIGHT = 0.5
"""Vertical part of the normals below which a die is steep."""


def check_reach(operation: Operation, tools: Sequence[Tool], stages: Sequence[Stage], state: SheetState) -> None:
    """Raise LayingError where no tool that moves meets the part in its place, or one is pushed from afar.

    What boundaries or loads move is not checked, nor a tool that closes on a die, which determines how far it goes.
    """
    loads = (stage.prescribed or stage.shell_pressures or stage.forces or stage.edge_forces for stage in stages)
    if operation.closings or any(loads):
        return
    points, half = sample_part(state)
    far = 2.0 * float(np.ptp(points, axis=0).sum() + half.max())
    missed: list[tuple[float, Tool]] = []
    moves = False
    for tool in tools:
        motions = [
            (i, stage.tool_motion[tool.name]) for i, stage in enumerate(stages) if tool.name in stage.tool_motion
        ]
        if not motions:
            continue
        begin = points - np.asarray(tool.position)
        surface = make_surface(tool.surface)
        gap = float((surface.nearest(begin)[0] - half).min())
        number, first = motions[0]
        if first.push is not None and gap > 2.0 * float(half.mean()) and not _moves_before(stages, number):
            key = f"{key_of(operation, tool.name)}.position"
            raise LayingError(
                f"{key}: the {tool.kind} is pushed by a force, but starts {gap:.4g} mm off the part, which it would "
                "hit: leave position out, then it just touches the part, or lay the part on it (place)"
            )
        moves = True
        if _meets(surface, begin, half, [motion for _, motion in motions], far):
            return
        missed.append((gap, tool))
    if not moves:
        return
    gap, tool = min(missed, key=lambda pair: pair[0])
    raise LayingError(
        f"{key_of(operation, tool.name)}: the {tool.kind} passes the part, as every tool that moves does; it starts "
        f"{gap:.4g} mm off: check its position, size and stroke, and how the part is laid in (place)"
    )


def _moves_before(stages: Sequence[Stage], number: int) -> bool:
    return any(stage.tool_motion for stage in stages[:number])


def _meets(
    surface: _core.ToolSurface, begin: FloatArray, half: FloatArray, motions: Sequence[ToolMotion], far: float
) -> bool:
    """Return whether a tool meets a part at rest on its path, stage after stage."""
    at = np.zeros(3)
    for motion in motions:
        step = np.asarray(motion.push.direction) * far if motion.push is not None else np.asarray(motion.move)
        length = float(np.linalg.norm(step))
        if length > 0.0 and find_touch(surface, begin - at, half, step / length, length) is not None:
            return True
        at = at + step
    return False


def explain_misfit(
    operation: Operation,
    tools: Sequence[Tool],
    stages: Sequence[Stage],
    state: SheetState,
    formed: FloatArray,
    *,
    stops: bool,
) -> list[str]:
    """Return a warning where the part lies off the tools that close on it first; nothing where it fits.

    Raises LayingError where it does not fit at all, unless a run goes on beyond its limits.
    tools, stages: as laid, with the strokes of closing tools. formed: the part as the tools before had formed it, laid
    into the operation (n_points, 3) [mm].
    """
    first = next((i for i, stage in enumerate(stages) if stage.tool_motion), None)
    closings = [closing for closing in operation.closings if closing.stage == first]
    half, placed = find_half_thickness(state), {tool.name: tool for tool in tools}
    if not closings or np.ptp(formed[:, 2]) < FLAT * 2.0 * half.mean():
        return []
    closed = {
        each.tool: placed[each.tool].position + gone_before(stages, each.tool, each.stage + 1) for each in closings
    }
    dies = {name: np.asarray(placed[name].position) for name in closings[0].dies}
    on_closed, on_dies = (
        [(make_surface(placed[name].surface), at) for name, at in each.items()] for each in (closed, dies)
    )
    area = sum((share_surface(formed, block.connectivity) for block in state.blocks), np.zeros(len(formed)))
    found = _find_misfit(formed, half, area, on_closed, on_dies)
    if found is None or found.share < SHARE:
        return []
    own = f"{operation.name}_"
    key = f"operations.{operation.name}.stages.{first}.tools.{closings[0].tool.removeprefix(own)}.close"
    what, look = ("sideways", "widths and radii") if found.is_sideways else ("in height", "depth, strokes and radii")
    names = ", ".join(name.removeprefix(own) for name in (*dies, *closed))
    text = (
        f"{key}: the part does not fit the closed tools: as it was formed, {found.share:.0%} of what lies between "
        f"them is off them, mostly {what}, by {found.off:.3g} mm in the mean, most at {write_place(found.place)}; they "
        f"would form it anew, and may tear it: check {look} of {names} against the tools before, and how it is "
        "turned and moved (place)"
    )
    if stops and found.share > NO_FIT[0] and found.off > NO_FIT[1] * 2.0 * half.mean():
        raise LayingError(f"{text}; limits.stop = false runs it anyway")
    return [text]


@dataclass(frozen=True)
class _Misfit:
    """A shape that lies off closed tools."""

    share: float
    """Share of the area between the tools."""
    off: float
    """Mean distance of that share from the tools [mm]."""
    is_sideways: bool
    """Whether it is off mostly where the die is steep."""
    place: FloatArray
    """Where it is farthest off (3,) [mm]."""


def _find_misfit(
    formed: FloatArray, half: FloatArray, area: FloatArray, closed: Sequence[Placed], dies: Sequence[Placed]
) -> _Misfit | None:
    """Return how far a shape lies off closed tools at the height where it fits them best; None: it fits all over."""
    thickness, high = 2.0 * float(half.mean()), float(np.ptp(formed[:, 2]))
    within = OFF * thickness

    def find_off(height: float, chosen: slice) -> tuple[FloatArray, FloatArray]:
        """Return distances from dies, or depths in closed tools, and the gap to the nearer of these (n,) [mm]."""
        points = np.ascontiguousarray(formed[chosen] + height * UP)
        to_closed, to_die = (_find_gap(points, each)[0] - half[chosen] for each in (closed, dies))
        return np.maximum(-to_closed, np.abs(to_die)), np.minimum(to_closed, np.where(to_die < 0.0, to_die, np.inf))

    lift = FAR * float(np.ptp(formed, axis=0).sum())
    raised = np.ascontiguousarray(formed + lift * UP)
    falls = [find_touch(surface, raised - at, half, UP, 2.0 * lift) for surface, at in dies]
    rest = lift - min((fall for fall in falls if fall is not None), default=lift)
    step, some = max(STEP * thickness, high / MOST_HEIGHTS), slice(None, None, 1 + len(formed) // MOST_POINTS)
    heights = rest + np.arange(-high, high + step, step)
    costs = [area[some] @ np.minimum(find_off(float(height), some)[0], 2.0 * within) for height in heights]
    height = float(heights[int(np.argmin(costs))])
    off, gap = find_off(height, slice(None))
    between = gap < within
    wrong = between & (off > within)
    if not area[wrong].any():
        return None
    weight = area[wrong] / area[wrong].sum()
    upright = np.abs(_find_gap(formed[wrong] + height * UP, dies)[1][:, 2]) < UPRIGHT
    farthest = formed[np.flatnonzero(wrong)[int(np.argmax(off[wrong]))]]
    share = float(area[wrong].sum() / area[between].sum())
    return _Misfit(share, float(weight @ off[wrong]), bool(weight @ upright > 0.5), farthest)


def _find_gap(points: FloatArray, surfaces: Sequence[Placed]) -> tuple[FloatArray, FloatArray]:
    """Return gaps to the nearest of some surfaces (n,) [mm], and its normals there (n, 3)."""
    found = [surface.nearest(np.ascontiguousarray(points - at))[:2] for surface, at in surfaces]
    gaps = np.array([gap for gap, _ in found])
    nearest = gaps.argmin(axis=0)
    return gaps.min(axis=0), np.array([normal for _, normal in found])[nearest, np.arange(len(points))]
