# SPDX-License-Identifier: Apache-2.0
"""A run as the page takes it: a header of plain values, and blocks of numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.model import FloatArray
from presswork.post import trace_profile
from presswork.post.weld_lines import find_welds
from presswork.report.choose import Choice, choose
from presswork.report.history import pack_history
from presswork.report.pack import Blocks, Packed
from presswork.report.parts import (
    describe_run,
    describe_saved_step,
    describe_shown,
    pack_draw_in,
    pack_interfaces,
    round_values,
)
from presswork.report.surface import Surface, find_surface
from presswork.results import Result, ResultMesh


def pack_run(result: Result, blocks: Blocks, budget: int) -> dict[str, Any]:
    """Return a run's header; its numbers are added to the blocks. budget: bytes of text that steps may take."""
    with result.kept_open():
        choice = choose(result, budget)
        tools = pack_tools(result, blocks)
        meshes, steps, ranges = _pack_steps(result, choice, blocks)
        return {
            **describe_run(result),
            "fields": [
                describe_shown(result, shown, bounds) for shown, bounds in zip(choice.fields, ranges, strict=True)
            ],
            "meshes": meshes,
            "steps": steps,
            "tools": tools,
            "history": pack_history(result, blocks),
            "draw_in": pack_draw_in(result, choice.steps),
            "notes": list(choice.notes),
        }


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
            surfaces.append((mesh, find_surface(mesh, has_inside=choice.has_inside, welds=find_welds(result, step))))
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
                **describe_saved_step(result, step),
                "mesh": number,
                "points": blocks.add_values(surface.take_points(result.points(step))),
                "fields": packed,
                "interface": pack_interfaces(result, surface, step),
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
        "welds": blocks.add_indices(surface.welds),
        "hexahedra": blocks.add_indices(surface.hexahedra),
        "owners": blocks.add_indices(surface.owners),
        "reference": blocks.add_values(surface.take_points(mesh.points)),
    }


def pack_tools(result: Result, blocks: Blocks) -> list[dict[str, Any]]:
    """Return the tools where they start: profiles as polylines, tools in space as triangles."""
    tools: list[dict[str, Any]] = []
    for name, segments in result.tools.items():
        lines = [[round_values(point) for point in line] for line in trace_profile(segments)]
        tools.append({"name": name, "lines": lines, "centre": round_values(result.tool_pose(name, 0).centre)})
    for name, (points, triangles) in result.surfaces.items():
        shape = {"points": blocks.add_values(points), "triangles": blocks.add_indices(triangles)}
        tools.append({"name": name, **shape, "centre": round_values(result.surface_centre(name))})
    return tools
