# SPDX-License-Identifier: Apache-2.0
"""Parts of a run's header, plain values and numbers: what a page that holds a run and one that is served have alike."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np

from presswork.fields.table import describe_field
from presswork.formability import ZONES, explain_zones
from presswork.model import FloatArray
from presswork.post import judge_result, measure_draw_in_around, trace_interface
from presswork.post.formability import list_other_limits
from presswork.report.case_data import list_defaults, read_text
from presswork.report.choose import Shown
from presswork.report.surface import Surface
from presswork.results import Result
from presswork.results.folder import CASE, LOG
from presswork.view.limit_colours import find_fixed_stops
from presswork.view.plots.flow_lines_plot import space_lines
from presswork.view.plots.outline_plot import find_beads
from presswork.view.plots.section_plot import is_drawn_in, name_directions, trace_draw_in
from presswork.view.plots.shell_plot import DIVERGING, ZONE_FIELD
from presswork.view.style import ZONE_COLOURS, describe_step

LINES_OF_LOG = 40
"""Lines of the log that a page shows of a run that did not complete."""
_UNITS = {"1": "–", "degrees C": "°C"}


def describe_run(result: Result) -> dict[str, Any]:
    """Return the header of a run as a whole."""
    name = result.folder.resolve().name
    return {
        "name": name,
        "title": str(result.info.get("title", "")).strip() or name,
        "analysis": _name_analysis(result),
        "axisymmetric": result.info.get("analysis") == "axisymmetric",
        "sheet": result.is_shell,
        "dimension": result.mesh.points.shape[1],
        "flow": _space_flow_lines(result),
        "symmetry": str(result.info.get("symmetry", "")),
        "formability": _pack_formability(result),
        "summary": result.summary,
        "verdict": judge_result(result).to_data(),
        "log": _read_end_of_log(result),
        "case": read_text(result.folder / CASE),
        "defaults": list_defaults(result.folder / CASE),
    }


def _read_end_of_log(result: Result) -> str:
    """Return the last lines of the log of a run that did not complete; empty of others."""
    path = result.folder / LOG
    if result.summary.get("status", "completed") == "completed" or not path.is_file():
        return ""
    return "\n".join(read_text(path).splitlines()[-LINES_OF_LOG:])


def describe_saved_step(result: Result, step: int) -> dict[str, Any]:
    """Return the header of a saved step beside its numbers: time, words, where the tools are."""
    return {
        "saved": step,
        "time": float(result.times[step]),
        "label": describe_step(result, step),
        "tools": _place_tools(result, step),
    }


def _space_flow_lines(result: Result) -> dict[str, list[float]]:
    """Return where the lines of each initial coordinate begin, half a distance before the first, and how far apart.

    A coordinate that a sheet does not vary in, and one that there is not, has no line.
    """
    points = result.mesh.points
    low, apart = np.zeros(3), np.full(3, 1e9)
    for axis, places in enumerate(space_lines(points)):
        low[axis] = points[:, axis].min()
        apart[axis] = max(2.0 * (places[0] - low[axis]), 1e-9)
    if result.is_shell:
        apart[2] = 1e9
    return {"low": low.tolist(), "apart": apart.tolist()}


def _name_analysis(result: Result) -> str:
    """Return the kind of analysis, which of heat alone is no strain: "heat, plane"."""
    analysis = str(result.info.get("analysis", ""))
    return f"heat, {analysis.split('_')[0]}" if result.info.get("physics") == "heat" else analysis


def describe_shown(result: Result, shown: Shown, bounds: tuple[float, float]) -> dict[str, Any]:
    """Return the page's data of a field; bounds: its smallest and largest value in the steps shown."""
    unit = result.unit(shown.stored)
    data: dict[str, Any] = {
        "name": shown.name,
        "label": describe_field(shown.name),
        "unit": _UNITS.get(unit, unit),
        "kind": shown.kind,
        "range": bounds,
        "signed": shown.name in DIVERGING,
    }
    if stops := find_fixed_stops(result, shown.name):
        data["stops"] = stops
    if shown.name == ZONE_FIELD:
        meanings = explain_zones(result.formability.safety_margin)
        named = zip(ZONES, ZONE_COLOURS, meanings, strict=True)
        data["zones"] = [{"name": name, "colour": colour, "meaning": meaning} for name, colour, meaning in named]
    return data


def _place_tools(result: Result, step: int) -> list[list[float | None]]:
    """Return each tool's displacement since the start [mm], and behind it what it has turned [rad].

    That is an angle in the plane, in space a vector along the axis with the angle as its length.
    """
    poses = (result.tool_pose(name, step) for name in result.tools)
    placed = [[*round_values(pose.displacement), float(pose.angle)] for pose in poses]
    motions = (result.surface_motion(name, step) for name in result.surfaces)
    return placed + [[*round_values(moved), *map(float, turned)] for moved, turned in motions]


def pack_interfaces(result: Result, surface: Surface, step: int) -> dict[str, Any]:
    """Return the contact stress along each tool's contact surface; none where it was not saved."""
    if not {"contact_pressure", "contact_shear"} <= set(result.field_names):
        return {}
    found = {}
    for tool in result.tools:
        trace = trace_interface(result, tool, step)
        if len(trace.nodes):
            found[tool] = {
                "way": round_values(trace.arc_length),
                "patch": trace.patch.tolist(),
                "pressure": round_values(trace.contact_pressure),
                "shear": round_values(trace.contact_shear),
                "limit": round_values(trace.friction_limit),
                "node": np.searchsorted(surface.nodes, trace.nodes).tolist(),
            }
    return found


def _pack_formability(result: Result) -> dict[str, Any]:
    """Return the forming limit of the sheet; empty without one."""
    judged = result.formability
    if judged.curve is None:
        return {}
    return {
        "minor": round_values(judged.curve.minor),
        "major": round_values(judged.curve.major),
        "method": judged.curve.method,
        "margin": judged.safety_margin,
        "r": judged.r,
        "others": [
            {"name": name, "minor": round_values(curve.minor), "major": round_values(curve.major)}
            for name, curve in list_other_limits(result)
        ],
    }


def pack_draw_in(result: Result, steps: Sequence[int]) -> dict[str, Any]:
    """Return how far a stamped blank's edge has come in, all round, by the last step before it was trimmed.

    With it come the draw-in over the stroke along x, y and the diagonal, and lines of drawbeads in the plan.
    """
    if not result.is_stamping:
        return {}
    last = max(step for step in steps if result.mesh_at(step) is result.mesh)
    angles, distances = measure_draw_in_around(result, last).T
    return {
        "step": describe_step(result, last),
        "angle": round_values(angles),
        "way": round_values(distances),
        "course": _pack_course(result),
        "beads": [[round_values(axis) for axis in line.T] for line in find_beads(result, last)],
    }


def _pack_course(result: Result) -> dict[str, Any]:
    """Return the draw-in over the stroke; empty where no tool moves, or the edge does not come in."""
    if not (result.surfaces and len(result.times) > 1 and is_drawn_in(result)):
        return {}
    course = trace_draw_in(result)
    return {
        "tool": course.tool,
        "stroke": round_values(course.stroke),
        "curves": [
            {"label": name_directions(angles), "way": round_values(come_in)} for angles, come_in in course.curves
        ],
    }


def round_values(values: FloatArray) -> list[float | None]:
    """Return numbers of seven digits, more than a page shows; None for what is not finite."""
    return [float(f"{value:.7g}") if isfinite(value) else None for value in np.asarray(values, dtype=np.float64)]
