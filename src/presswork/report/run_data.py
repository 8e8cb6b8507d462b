# SPDX-License-Identifier: Apache-2.0
"""A run as the page takes it: a header of plain values, and blocks of numbers."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from presswork.fields.table import describe_field
from presswork.formability import ZONES
from presswork.model import FloatArray
from presswork.post import measure_draw_in_around, trace_interface, trace_profile
from presswork.report.case_data import list_defaults, read_text
from presswork.report.choose import Choice, Shown, choose
from presswork.report.history import pack_history
from presswork.report.pack import Blocks, Packed
from presswork.report.surface import Surface, find_surface
from presswork.results import Result, ResultMesh
from presswork.results.folder import CASE
from presswork.view.shell_plot import DIVERGING, ZONE_FIELD
from presswork.view.style import ZONE_COLOURS, describe_step

_UNITS = {"1": "–", "degrees C": "°C"}


def pack_run(result: Result, blocks: Blocks, budget: int) -> dict[str, Any]:
    """Return a run's header; its numbers are added to the blocks. budget: bytes of text that steps may take."""
    with result.kept_open():
        choice = choose(result, budget)
        tools = _pack_tools(result, blocks)
        meshes, steps, ranges = _pack_steps(result, choice, blocks)
        return {
            "name": result.folder.resolve().name,
            "title": str(result.info.get("title", "")).strip() or result.folder.resolve().name,
            "analysis": _name_analysis(result),
            "axisymmetric": result.info.get("analysis") == "axisymmetric",
            "sheet": result.is_shell,
            "dimension": result.mesh.points.shape[1],
            "symmetry": str(result.info.get("symmetry", "")),
            "fields": [_describe(result, shown, bounds) for shown, bounds in zip(choice.fields, ranges, strict=True)],
            "meshes": meshes,
            "steps": steps,
            "tools": tools,
            "history": pack_history(result, blocks),
            "formability": _pack_formability(result),
            "summary": result.summary,
            "case": read_text(result.folder / CASE),
            "defaults": list_defaults(result.folder / CASE),
            "draw_in": _pack_draw_in(result, choice),
            "notes": list(choice.notes),
        }


def _name_analysis(result: Result) -> str:
    """Return the kind of analysis, which of heat alone is no strain: "heat, plane"."""
    analysis = str(result.info.get("analysis", ""))
    return f"heat, {analysis.split('_')[0]}" if result.info.get("physics") == "heat" else analysis


def _describe(result: Result, shown: Shown, bounds: tuple[float, float]) -> dict[str, Any]:
    """Return what the page says of a field; bounds: its smallest and largest value in the steps shown."""
    unit = result.unit(shown.stored)
    told: dict[str, Any] = {
        "name": shown.name,
        "label": describe_field(shown.name),
        "unit": _UNITS.get(unit, unit),
        "kind": shown.kind,
        "range": bounds,
        "signed": shown.name in DIVERGING,
    }
    if shown.name == ZONE_FIELD:
        told["zones"] = [{"name": name, "colour": colour} for name, colour in zip(ZONES, ZONE_COLOURS, strict=True)]
    return told


def _pack_steps(
    result: Result, choice: Choice, blocks: Blocks
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[tuple[float, float]]]:
    """Return the meshes and the steps for the page, and the range of every field over the steps."""
    surfaces: list[tuple[ResultMesh, Surface]] = []
    meshes, steps = [], []
    lows, highs = (np.full(len(choice.fields), limit) for limit in (np.inf, -np.inf))
    for step in choice.steps:
        mesh = result.mesh_at(step)
        number = next((i for i, (known, _) in enumerate(surfaces) if known is mesh), len(surfaces))
        if number == len(surfaces):
            surfaces.append((mesh, find_surface(mesh)))
            meshes.append(_pack_mesh(mesh, surfaces[number][1], blocks))
        surface = surfaces[number][1]
        stored: dict[str, FloatArray] = {}
        packed: list[Packed] = []
        for i, shown in enumerate(choice.fields):
            if shown.stored not in stored:
                stored[shown.stored] = result.field(shown.stored, step)
            values = shown.pick(stored[shown.stored])
            values = surface.take_points(values) if shown.kind == "point" else surface.take_cells(values)
            packed.append(blocks.add_values(values))
            lows[i], highs[i] = min(lows[i], packed[-1]["lo"][0]), max(highs[i], packed[-1]["hi"][0])
        steps.append(
            {
                "saved": step,
                "time": float(result.times[step]),
                "label": describe_step(result, step),
                "mesh": number,
                "points": blocks.add_values(surface.take_points(result.points(step))),
                "fields": packed,
                "tools": _place_tools(result, step),
                "interface": _pack_interfaces(result, mesh, surface, step),
            }
        )
    return meshes, steps, list(zip(lows.tolist(), highs.tolist(), strict=True))


def _pack_mesh(mesh: ResultMesh, surface: Surface, blocks: Blocks) -> dict[str, Any]:
    return {
        "nodes": len(surface.nodes),
        "faces": len(surface.cells),
        "triangles": blocks.add_indices(surface.triangles),
        "face": blocks.add_indices(surface.faces),
        "lines": blocks.add_indices(surface.lines),
        "boundary": blocks.add_indices(surface.boundary),
        "reference": blocks.add_values(surface.take_points(mesh.points)),
    }


def _pack_tools(result: Result, blocks: Blocks) -> list[dict[str, Any]]:
    """Return the tools where they start: profiles as polylines, tools in space as triangles."""
    tools: list[dict[str, Any]] = []
    for name, segments in result.tools.items():
        lines = [[_round(point) for point in line] for line in trace_profile(segments)]
        tools.append({"name": name, "lines": lines, "centre": _round(result.tool_pose(name, 0).centre)})
    for name, (points, triangles) in result.surfaces.items():
        tools.append({"name": name, "points": blocks.add_values(points), "triangles": blocks.add_indices(triangles)})
    return tools


def _place_tools(result: Result, step: int) -> list[list[float | None]]:
    """Return each tool's displacement since the start [mm], in the plane with its angle [rad] behind."""
    poses = (result.tool_pose(name, step) for name in result.tools)
    placed = [[*_round(pose.displacement), float(pose.angle)] for pose in poses]
    return placed + [_round(result.surface_displacement(name, step)) for name in result.surfaces]


def _pack_interfaces(result: Result, mesh: ResultMesh, surface: Surface, step: int) -> dict[str, Any]:
    """Return the contact stress along each tool's contact surface; none where it was not saved."""
    if not {"contact_pressure", "contact_shear"} <= set(result.field_names) or mesh is not result.mesh:
        return {}
    found = {}
    for tool in result.tools:
        trace = trace_interface(result, tool, step)
        if len(trace.nodes):
            found[tool] = {
                "way": _round(trace.arc_length),
                "patch": trace.patch.tolist(),
                "pressure": _round(trace.contact_pressure),
                "shear": _round(trace.contact_shear),
                "limit": _round(trace.friction_limit),
                "node": np.searchsorted(surface.nodes, trace.nodes).tolist(),
            }
    return found


def _pack_formability(result: Result) -> dict[str, Any]:
    """Return the forming limit of the sheet; empty without one."""
    judged = result.formability
    if judged.curve is None:
        return {}
    return {
        "minor": _round(judged.curve.minor),
        "major": _round(judged.curve.major),
        "method": judged.curve.method,
        "margin": judged.safety_margin,
        "r": judged.r,
    }


def _pack_draw_in(result: Result, choice: Choice) -> dict[str, Any]:
    """Return how far a stamped blank's edge has come in, all round, by the last step before it was trimmed."""
    if not result.is_stamping:
        return {}
    last = max(step for step in choice.steps if result.mesh_at(step) is result.mesh)
    angles, ways = measure_draw_in_around(result, last).T
    return {"step": describe_step(result, last), "angle": _round(angles), "way": _round(ways)}


def _round(values: FloatArray) -> list[float | None]:
    """Return numbers of seven digits, more than a page shows; None for what is not finite."""
    return [float(f"{value:.7g}") if isfinite(value) else None for value in np.asarray(values, dtype=np.float64)]
