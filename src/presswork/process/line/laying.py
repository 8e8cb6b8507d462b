# SPDX-License-Identifier: Apache-2.0
"""A part is laid into its next operation: it is turned over, turned and moved, and the tools are brought to it.

A tool that the case gives no height moves along its direction until it touches the part. A part that tips (tipping.py)
rests on its dies by its weight; another one only along the press.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswork.geometry.pose import turn_about
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.space.sheet_contact import share_surface
from presswork.mesh.faces import nodal_normals
from presswork.mesh.tool_clearance import find_closing, find_touch, sample_tool
from presswork.mesh.topology import list_cell_edges
from presswork.model import FloatArray, IntArray, Operation, PartPlace, Stage, Tool, ToolMotion
from presswork.process.line.tipping import TippingError, tip_part
from presswork.process.mesh_change.refinement import sag_of_sides
from presswork.process.mesh_change.transfer import SheetState

ON_EDGES = (0.25, 0.5, 0.75)
"""Parts of an edge of the mesh at which the part is held against tools, beside its nodes."""
FACETS = 0.02
"""Part of the gap that facets of drawn tools may be off them where tools close."""
STEP = 0.5
"""Part of the thickness by which closing tools advance."""
DEEPEST_START = 0.05
"""Part of the thickness by which a node may stick in a tool at the start, as explicit contact allows it."""


class LayingError(ValueError):
    """A part that does not lie on the tools of its operation."""


def find_turn(place: PartPlace) -> FloatArray:
    """Return the rotation of a part that is laid so (3, 3)."""
    over = np.eye(3)
    if place.over is not None:
        over = -over
        axis = "xy".index(place.over)
        over[axis, axis] = 1.0
    return np.asarray(turn_about(np.array([0.0, 0.0, place.turn])) @ over)


def find_plans(operations: Sequence[Operation]) -> FloatArray:
    """Return how x and y of the first blank lie in each operation: turn (2, 2) and shift [mm] (1 + n, 2, 3).

    operations: those after the first. What a part sinks and tips by is left out.
    """
    plans = [np.eye(2, 3)]
    for operation in operations:
        turn = find_turn(operation.place)[:2, :2]
        plan = turn @ plans[-1]
        plan[:, 2] += operation.place.move[:2]
        plans.append(plan)
    return np.array(plans)


def lay_part(state: SheetState, place: PartPlace) -> SheetState:
    """Return the state of a part that is turned over, turned and moved; stresses turn with it."""
    if place == PartPlace():
        return state
    turn = find_turn(place)
    blocks = tuple(replace(block, axis=block.axis @ turn.T) for block in state.blocks)
    return replace(state, position=state.position @ turn.T + np.asarray(place.move), blocks=blocks)


def find_half_thickness(state: SheetState) -> FloatArray:
    """Return half the mean thickness of the cells round each node (n_points,) [mm]."""
    total, count = np.zeros((2, len(state.position)))
    for block in state.blocks:
        np.add.at(total, block.connectivity, block.thickness.mean(axis=1)[:, None])
        np.add.at(count, block.connectivity, 1.0)
    return np.asarray(0.5 * total / np.maximum(count, 1.0))


def find_sag(state: SheetState) -> tuple[IntArray, FloatArray]:
    """Return the edges of a part (n, 2), and how far the middles of their arcs lie off their chords (n, 3) [mm]."""
    edges = np.unique(np.sort(np.concatenate([list_cell_edges(b.connectivity) for b in state.blocks]), axis=1), axis=0)
    normals = sum((nodal_normals(state.position, b.connectivity) for b in state.blocks), np.zeros_like(state.position))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return edges, sag_of_sides(state.position, normals, *edges.T)


def sample_part(state: SheetState) -> tuple[FloatArray, FloatArray]:
    """Return the nodes of a part and points between them (n, 3), and half the thickness there (n,) [mm].

    Tools of small radii touch there before they touch nodes. The points lie on the arcs that the normals at the ends
    of an edge give it: its chord lies off a part that is bent with few elements, on the inside of the bend.
    """
    half = find_half_thickness(state)
    edges, sag = find_sag(state)
    first, last = edges.T
    points, halves = [state.position], [half]
    for part in ON_EDGES:
        on_chord = (1.0 - part) * state.position[first] + part * state.position[last]
        points.append(on_chord + 4.0 * part * (1.0 - part) * sag)
        halves.append((1.0 - part) * half[first] + part * half[last])
    return np.concatenate(points), np.concatenate(halves)


def tip_onto(
    operation: Operation, state: SheetState, symmetry: tuple[bool, bool], *, with_edges: bool
) -> tuple[SheetState, FloatArray]:
    """Return a part that has sunk and tipped onto the dies of its operation, and its rotation (3, 3).

    symmetry: whether planes normal to x and y hold it. Raises LayingError where it finds no rest.
    """
    points, half = sample_part(state) if with_edges else (state.position, find_half_thickness(state))
    mass = np.zeros(len(points))
    for block in state.blocks:
        mass[: len(state.position)] += share_surface(state.position, block.connectivity)
    mass[: len(state.position)] *= half[: len(state.position)]
    dies = [tool for tool in operation.tools if tool.kind == "die"]
    dies = [touch_part(operation, die, points, half) if die.name in operation.laid else die for die in dies]
    try:
        rotation, shift = tip_part(points, half, mass, dies, (not symmetry[1], not symmetry[0]))
    except TippingError as error:
        raise LayingError(f"operations.{operation.name}.place.tip: {error}") from error
    blocks = tuple(replace(block, axis=block.axis @ rotation.T) for block in state.blocks)
    return replace(state, position=state.position @ rotation.T + shift, blocks=blocks), rotation


def close_tools(operation: Operation, tools: Sequence[Tool], thickness: float) -> tuple[Stage, ...]:
    """Return the operation's stages, in which tools that close on dies go as far as these placed tools let them.

    thickness: of the sheet [mm]. Raises LayingError where a tool does not come near a die.
    """
    placed, stages = {tool.name: tool for tool in tools}, list(operation.stages)
    for closing in operation.closings:
        tool, direction = placed[closing.tool], np.asarray(placed[closing.tool].working_direction)
        begin = np.asarray(tool.position) + gone_before(stages, closing.tool, closing.stage)
        travels = [
            find_closing(tool.surface, placed[die].surface, begin - np.asarray(placed[die].position), direction,
                         FACETS * closing.gap, closing.gap, STEP * thickness)
            for die in closing.dies
        ]  # fmt: skip
        travel = min((found.travel for found in travels if found is not None), default=0.0)
        key = f"operations.{operation.name}.stages.{closing.stage}.tools.{closing.tool}.close"
        if travel <= 0.0:
            raise LayingError(
                f"{key} = {closing.gap:g}: the {tool.kind} does not come so near to its die, or is nearer from the "
                "start: check the tools and where they stand"
            )
        stage = stages[closing.stage]
        motions = {**stage.tool_motion, closing.tool: ToolMotion(tuple(float(travel * each) for each in direction))}
        slower = 1.0
        if not closing.is_timed:
            slower = _farthest(motions) / _farthest(stage.tool_motion)
        stages[closing.stage] = replace(
            stage, tool_motion=motions, duration=stage.duration * slower, ramp=stage.ramp * slower
        )
    return tuple(stages)


def gone_before(stages: Sequence[Stage], tool: str, number: int) -> FloatArray:
    """Return how far a tool's strokes have taken it when a stage begins (3,) [mm]."""
    before = np.zeros(3)
    for stage in stages[:number]:
        if tool in stage.tool_motion:
            before += stage.tool_motion[tool].move
    return before


def _farthest(motions: Mapping[str, ToolMotion]) -> float:
    return max(max(abs(part) for part in motion.move) for motion in motions.values())


def lay_tools(operation: Operation, state: SheetState, *, with_edges: bool) -> tuple[Tool, ...]:
    """Return the operation's tools where they start on a part. Raises LayingError, naming the key of the case.

    with_edges: whether contact looks at edges of the mesh, too, where a tool is sharp, as in explicit dynamics.
    """
    samples = state.position, find_half_thickness(state)
    with_those_between = sample_part(state) if with_edges else samples
    edge, placed = _mean_edge(state), dict[str, Tool]()
    for tool in operation.tools:
        points, half = with_those_between if make_surface(tool.surface).is_sharp(edge) else samples
        placed[tool.name] = touch_part(operation, tool, points, half) if tool.name in operation.laid else tool
    for name, (other, above) in operation.spaced.items():
        x, y, _ = placed[name].position
        placed[name] = replace(placed[name], position=(x, y, placed[other].position[2] + above))
    for tool in placed.values():
        _check_clear(operation, tool, *samples)
    return tuple(placed.values())


def _mean_edge(state: SheetState) -> float:
    """Return the mean length of the edges round the cells of a part [mm], as explicit contact takes it."""
    edges = [state.position[b.connectivity] - state.position[np.roll(b.connectivity, -1, axis=1)] for b in state.blocks]
    return float(np.concatenate([np.linalg.norm(edge, axis=2).ravel() for edge in edges]).mean())


def touch_part(operation: Operation, tool: Tool, points: FloatArray, half: FloatArray) -> Tool:
    """Return a tool moved along its direction, from beyond the part, until it touches it."""
    direction = np.asarray(tool.working_direction)
    ahead, own = points @ direction - half, sample_tool(tool.surface, 2.0 * float(half.max())) @ direction
    begin = np.asarray(tool.position) * (direction == 0.0) + float(ahead.min() - own.max() - half.max()) * direction
    travel = find_touch(make_surface(tool.surface), points - begin, half, direction, float(np.ptp(ahead) + np.ptp(own)))
    if travel is None:
        raise LayingError(
            f"{key_of(operation, tool.name)}: the {tool.kind} passes the part without touching it, so its height is "
            "not known: give it a position = [x, y, z], or move the part (place.move)"
        )
    x, y, z = (float(each) for each in begin + travel * direction)
    return replace(tool, position=(x, y, z))


def _check_clear(operation: Operation, tool: Tool, points: FloatArray, half: FloatArray) -> None:
    """Raise LayingError where a tool starts in the part."""
    gap = make_surface(tool.surface).nearest(points - np.asarray(tool.position))[0] - half
    worst = int(np.argmin(gap))
    if gap[worst] >= -2.0 * DEEPEST_START * half[worst]:
        return
    place, key = write_place(points[worst]), f"{key_of(operation, tool.name)}.position"
    raise LayingError(
        f"{key} = {write_place(tool.position)}: the part does not fit the {tool.kind}: it lies in it by up to "
        f"{-gap[worst]:.4g} mm, half the thickness counted, at {place}; move the tool off or make it fit, or place the "
        "part otherwise (place)"
    )


def key_of(operation: Operation, tool: str) -> str:
    """Return the key by which the case has a tool of an operation."""
    return f"operations.{operation.name}.tools.{tool.removeprefix(f'{operation.name}_')}"


def write_place(place: Sequence[float] | FloatArray) -> str:
    """Return a place as a case has it."""
    return f"[{', '.join(f'{each:.4g}' for each in place)}]"
