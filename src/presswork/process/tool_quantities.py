# SPDX-License-Identifier: Apache-2.0
"""What a forming engineer reads off a press: stroke, load and torque of every tool, at a converged state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.formability import Info
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.interaction.tool_course import find_turning
from presswork.model import FloatArray, Model, Tool, ToolMotion
from presswork.observe.working_direction import find_working_direction

OF_A_TOOL, OF_TURNING = ("stroke", "force", "force_x", "force_y", "force_z"), ("angle", "torque")


@dataclass(frozen=True)
class ToolQuantities:
    """Quantities of one whole tool: with its mirror image in plane strain, the whole ring in axisymmetry."""

    stroke: float
    """Displacement along its first motion since it was last placed; for a tool on a spring its deflection [mm]."""
    force: float
    """Against its first motion [N]: positive when the workpiece resists; on a spring, what presses the spring; of a
    tool that does neither, the vector's length, in axisymmetry its axial part: the radial one loads no press."""
    vector: FloatArray
    """Force of the workpiece on the tool (3,) [N]."""
    angle: float
    """Turned since the start [rad]."""
    torque: float
    """Torque of the workpiece on the whole tool about its centre, in space about its axis, against its turning in this
    stage, so positive when it must be driven; clockwise where it does not turn [N mm]."""


def measure_tools(procedure: ImplicitProcedure, stage: int) -> dict[str, ToolQuantities]:
    """Return the quantities of every tool at the converged state, which belongs to a stage."""
    state, contact = procedure.state, procedure.interactions.tools.contact
    contact.search(state, state.nodes.displacement)
    vectors, torques = contact.tool_forces(state, procedure.interactions.supports.fixed(stage))
    quantities = {}
    for t, tool in enumerate(procedure.model.plane_tools):
        vector = force_on_whole(tool, vectors[t])
        if tool.spring is not None:
            direction = np.asarray(tool.spring.direction)
            stroke, force = float(state[ToolArrays].travel[t] @ direction), float(vector @ direction)
        elif (unit := find_working_direction(procedure.model, tool)) is not None:
            moved = state[ToolArrays].displacement[t] - state[ToolArrays].placed[t]
            stroke, force = float(moved @ unit), -float(vector @ unit)
        else:
            stroke, force = 0.0, size_of_force(procedure.model, vector)
        motion = procedure.model.stages[stage].tool_motion.get(tool.name, ToolMotion())
        torque = -float(torques[t]) * (-1.0 if motion.turn < 0 else 1.0)
        in_space = np.append(vector, 0.0)
        quantities[tool.name] = ToolQuantities(stroke, force, in_space, float(state[ToolArrays].angle[t]), torque)
    return quantities | _measure_space_tools(procedure, stage)


def _measure_space_tools(procedure: ImplicitProcedure, stage: int) -> dict[str, ToolQuantities]:
    """Return the quantities of the tools in space; those of a shell as modelled."""
    tools, state = procedure.interactions.space_tools, procedure.state
    if tools is None:
        return {}
    quantities = {}
    forces = tools.contact.tool_forces(state)
    torques = tools.contact.torques(state)
    placed = state[SpaceToolArrays]
    for t, tool in enumerate(procedure.model.space_tools):
        force = force_on_whole(tool, forces[t])
        unit = find_working_direction(procedure.model, tool)
        if tool.spring is not None:
            direction = np.asarray(tool.spring.direction)
            stroke, along = float(placed.travel[t] @ direction), float(force @ direction)
        elif unit is not None:
            stroke, along = float((placed.displacement[t] - placed.placed[t]) @ unit), -float(force @ unit)
        else:
            stroke, along = 0.0, float(np.linalg.norm(force))
        motion = procedure.model.stages[stage].tool_motion.get(tool.name, ToolMotion())
        whole = tool.sectors * 2.0 ** sum(tool.mirrored_across)
        torque = -float(torques[t]) * whole * (-1.0 if motion.turn < 0 else 1.0)
        quantities[tool.name] = ToolQuantities(stroke, along, force, float(placed.angle[t]), torque)
    return quantities


def tool_columns(model: Model) -> list[str]:
    """Return the columns of the history that explicit solids have of their tools."""
    turning = find_turning(model.tools, model.stages)
    return [
        f"{tool.name}.{quantity}"
        for tool in model.tools
        for quantity in (*OF_A_TOOL, *(OF_TURNING if tool.name in turning else ()))
    ]


def force_on_whole(tool: Tool, force: FloatArray) -> FloatArray:
    """Return the force on the whole tool of that on what is modelled of it (2,) or (3,) [N]."""
    whole = force.copy()
    for normal, is_cut in enumerate(tool.mirrored_across):
        if is_cut:
            whole *= 2.0
            whole[normal] = 0.0
    if tool.sectors > 1.0:
        whole *= tool.sectors
        whole[:2] = 0.0
    return whole


def size_of_force(model: Model, force: FloatArray) -> float:
    """Return the force on the whole of a tool that has no direction of its own [N]: of a ring the axial part."""
    return float(abs(force[1]) if model.analysis == "axisymmetric" else np.linalg.norm(force))


def describe_plane(model: Model) -> Info:
    """Return what results store about a case in the plane."""
    starts = [(stage.name, motion.start) for stage in model.stages for motion in stage.tool_motion.values()]
    placing = dict.fromkeys(name for name, start in starts if start not in (None, "touch_again"))
    return {
        "title": model.title,
        "analysis": model.analysis,
        "depth": model.depth,
        "whole": max((tool.sectors * 2.0 ** sum(tool.mirrored_across) for tool in model.tools), default=1.0),
        "mirrored_x": "\n".join(t.name for t in model.plane_tools if t.mirrored_across[0]),
        "mirrored_y": "\n".join(t.name for t in model.plane_tools if t.mirrored_across[1]),
        **({"placing": "\n".join(placing)} if placing else {}),
    }
