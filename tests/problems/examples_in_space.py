# SPDX-License-Identifier: Apache-2.0
"""The packaged examples of the plane and of axisymmetry as slices and sectors in space: force and profile of both.

The case file of an example is turned into one in space. Its section of quadrilaterals is turned about the axis by
6 degrees, or drawn out by 0.5 mm; its tools become round or straight; two planes hold the sector. Both are computed on
one mesh, as far as it goes. The run in space takes the increments of the plane (a cut-back apart), so that nodes land
in the same increments, and both are compared after every one.
"""

from __future__ import annotations

import copy
import tempfile
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from presswork import build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.implicit.progress import Progress
from presswork.model import BoolArray, FloatArray, IndexArray, Mesh, Model, Profile
from presswork.outcome import GaveUpError
from presswork.process.begin import begin as begin_run
from presswork.state import State

Data = dict[str, Any]

ANGLE, AROUND = 6.0, 2
"""Of sectors [degrees], and their cells: chords of 3 degrees lose 0.05 % of the area of the circle."""
THICK = 0.5
"""Of a slice [mm]."""
PARTS = 20
ENDS = 1e-3
"""Of the way of a blow: ends by their energy closer than that are taken as one."""
REST = 1e-3
"""Of the way of a blow: there the speed, and with it the force of metal that depends on the rate, falls to nothing; the
force after an increment follows from its mean speed, and so from how each run cuts its last increments."""
SAME = 1e-9
"""Of a stage: ends of increments closer than that are one."""
BEYOND = 5.0
"""How far the two parts of a profile that is cut at an inner corner go on [mm]."""


@dataclass(frozen=True)
class Trial:
    """How an example is compared."""

    column: str
    """Of history.csv, without the axis."""
    part: float = 1.0
    """Of the last stage that is computed: as far as the first mesh goes in both."""
    stages: int = 9
    """How many of the stages."""
    cut: tuple[str, int] | None = None
    """A tool, and the point of its profile where it is cut in two: a sharp inner corner."""


TRIALS = {
    "upsetting_4cst": Trial("punch.force"),
    "upsetting_q4": Trial("punch.force"),
    "upsetting_90": Trial("platen.force", 0.55),
    "curved_die": Trial("punch.force"),
    "ring_compression": Trial("punch.force"),
    "heading": Trial("punch.force"),
    "heading_friction": Trial("punch.force"),
    "forging_flash": Trial("die.force"),
    "forging_hub": Trial("die.force", 0.75),
    "gear_blank": Trial("blocker.force", 0.5, 2),
    "can_extrusion": Trial("punch.force", 0.09),
    "combined_extrusion": Trial("punch.force", 0.1, cut=("die", 2)),
    "piercing": Trial("punch.force", 0.2),
    "extrusion_cone": Trial("ram.force"),
    "extrusion_curved": Trial("ram.force"),
    "warm_extrusion": Trial("ram.force"),
    "hot_upsetting": Trial("die.force"),
    "hot_disc": Trial("finisher.force", 0.85),
    "hammer_forging": Trial("die.force"),
    "tension": Trial("middle.force"),
    "forging_h_section": Trial("die.force", 0.5),
    "strip_rolling": Trial("roll.force"),
}


@dataclass(frozen=True)
class Course:
    """One run."""

    model: Model
    stage: IndexArray
    """Number of the stage (n_rows,)."""
    fraction: FloatArray
    """Of the stage (n_rows,)."""
    force: FloatArray
    """Along the axis, of the plane upwards, of the whole (n_rows,) [N]."""
    end: FloatArray
    """Places of nodes at the end (n_points, 2 | 3) [mm]."""
    heat: FloatArray
    """Stored in the workpiece since the start, of the whole (n_rows,) [N mm]; without rows where there is no heat."""
    turnover: float
    """The largest of the heats of plastic work, of friction, to tools and to surroundings [N mm]."""
    seconds: float
    """Of processor time."""
    reason: str
    """Why it stopped early; empty: it did not."""


@dataclass(frozen=True)
class Comparison:
    """An example in the plane or in axisymmetry (first) and in space (second)."""

    courses: tuple[Course, Course]
    reached: float
    """Part of the increments of the plane that the other went, too."""
    force: FloatArray
    """Difference after each increment over the largest force (n_increments,), but for the REST of blows."""
    part: FloatArray
    """Difference of the mean over each of PARTS of the way, over the largest force (PARTS,)."""
    work: float
    """Relative difference of the force's integral over the way."""
    profile: float
    """Largest distance between the sections' outlines, over the larger extent of the section."""
    cooling: float
    """Largest difference of the heat stored, over the largest of the heats that came and went; 0 without heat."""


def compare(name: str) -> Comparison:
    """Compute an example both ways."""
    trial = TRIALS[name]
    flat = read_example(name)
    with tempfile.TemporaryDirectory() as folder:
        space = in_space(flat, Path(folder) / "section.inp", trial.cut)
        one = compute(Case(**flat), f"{trial.column}_y", 1.0)
        plane_strain, support = flat["analysis"] == "plane_strain", trial.column.partition(".")[0] in flat["boundary"]
        part = THICK if plane_strain else ANGLE / 360.0
        # forces on tools of a sector are those of the whole; reactions of supports are those of what is modelled
        two = compute(SpaceCase(**space), f"{trial.column}_z", part if plane_strain or support else 1.0, part, one)
    at, both = match(one, two)
    force, other = one.force[at], both(two.force)
    place = (one.stage + one.fraction)[at]
    way = np.diff(place, prepend=0.0)
    edges = np.linspace(0.0, place[-1], PARTS + 1)
    lead, behind = (np.diff(np.interp(edges, place, np.cumsum(way * f))) / edges[1] for f in (force, other))
    cooling = 0.0
    if one.model.heat is not None:
        cooling = float(np.abs(both(two.heat) - one.heat[at]).max() / one.turnover)
    return Comparison(
        (one, two),
        len(at) / len(one.force),
        ((other - force) / np.abs(one.force).max())[find_moving(one)[at]],
        (behind - lead) / np.abs(one.force).max(),
        float(way @ other / (way @ force) - 1.0),
        measure_profiles(one, two),
        cooling,
    )


def read_example(name: str) -> Data:
    """Return an example as data: of quadrilaterals, one mesh for the whole run, shortened as its trial says."""
    trial, folder = TRIALS[name], files("presswork.examples")
    with (folder / f"{name}.toml").open("rb") as file:
        flat = tomllib.load(file)
    mesh = flat["workpiece"]["mesh"]
    if "path" in mesh:
        mesh["path"] = str(folder / mesh["path"])
    mesh.pop("pattern", None)
    flat["workpiece"]["element"] = "quad4_fbar"
    flat["remesh"], flat["output"] = {"enabled": False}, {"steps": 1}
    for key, tool in flat.get("tools", {}).items():
        if "profile_file" in tool:
            tool["profile_file"] = str(folder / tool["profile_file"])
            tool["profile"] = draw(build_model(Case(**flat)), key)
            tool.pop("profile_file")
    flat["stages"] = flat["stages"][: trial.stages]
    last = flat["stages"][-1]
    for motion in last.get("tools", {}).values():
        if "stroke" in motion:
            motion["stroke"] *= trial.part
    if "duration" in last:
        last["duration"] *= trial.part
    return flat


def draw(model: Model, name: str) -> list[Any]:
    """Return the profile of a tool as lines and arcs from the axis on, as a case gives them."""
    (tool,) = (tool for tool in model.tools if tool.name == name)
    assert isinstance(tool.shape, Profile)
    points: list[Any] = []
    for segment in tool.shape.segments[np.argsort(tool.shape.segments[:, 0])]:
        x0, y0, x1, y1, *centre, turn = segment.tolist()
        if x1 < x0:
            x0, y0, x1, y1, turn = x1, y1, x0, y0, -turn
        if x1 < 1e-9:
            continue
        points = points or [[max(x0, 0.0), y0]]
        arc = {"centre": centre, "turn": "left" if turn > 0.0 else "right"} if turn else {}
        points.append({"to": [x1, y1], **arc})
    return points


def in_space(flat: Data, section: Path, cut: tuple[str, int] | None = None) -> Data:
    """Return the case as a sector or a slice; section: where the mesh of its half section is written."""
    case = copy.deepcopy(flat)
    is_round = case["analysis"] == "axisymmetric"
    case["analysis"] = "solid"
    del case["remesh"]
    plane = build_model(Case(**flat)).mesh
    mesh, case["workpiece"]["element"] = case["workpiece"]["mesh"], "hex8_fbar"
    if is_round:
        write_section(section, plane)
        case["workpiece"]["mesh"] = {"kind": "revolved", "path": str(section), "angle": ANGLE, "around": AROUND}
    else:
        (x, y), (w, h), (m, n) = mesh.get("origin", (0, 0)), mesh["size"], mesh["cells"]
        case["workpiece"]["mesh"] = {"origin": [x, 0, y], "size": [w, THICK, h], "cells": [m, 1, n]}
    case["boundary"] = _hold(flat, plane, is_round=is_round)
    tools = case.get("tools", {})
    if cut is not None:
        _cut_profile(tools, *cut)
    for tool in tools.values():
        _place_in_space(tool, is_round=is_round)
    for stage in case["stages"]:
        for motion in stage.get("tools", {}).values():
            for key in ("direction", "position", "move"):
                if isinstance(motion.get(key), list):
                    motion[key] = [motion[key][0], 0, motion[key][1]]
            if "turn" in motion:
                motion["turn"] *= -1  # about y, from z to x
        for entry in stage.get("displacement", ()):
            entry["set"] = {"top": "front"}[entry["set"]]
            entry["component"] = {"x": "x", "y": "z"}[entry["component"]]
    return case


def write_section(path: Path, mesh: Mesh) -> None:
    """Write a plane mesh of quadrilaterals as Abaqus .inp."""
    cells = np.concatenate([block.connectivity for block in mesh.blocks])
    lines = ["*NODE", *(f"{i + 1}, {x!r}, {y!r}, 0" for i, (x, y) in enumerate(mesh.points.tolist()))]
    lines += ["*ELEMENT, TYPE=CAX4"]
    lines += [", ".join(str(i) for i in (n + 1, *(cell + 1))) for n, cell in enumerate(cells)]
    path.write_text("\n".join(lines) + "\n")


def _hold(flat: Data, plane: Mesh, *, is_round: bool) -> Data:
    """Return the supports in space."""
    sides = {"left": "left", "right": "right", "bottom": "back", "top": "front"}
    if is_round:
        found: Data = {f"{side}_side": {"set": f"{side}_plane", "fix": ["normal"]} for side in ("first", "last")}
    else:
        found = {f"{side}_side": {"set": side, "fix": ["y"]} for side in ("bottom", "top")}
    for name, entry in flat["boundary"].items():
        if is_round and entry["set"] == "left" and plane.points[:, 0].min() < 1e-9:
            continue  # the axis
        fix = [{"x": "x", "y": "z"}[axis] for axis in entry["fix"]]
        found[name] = {"set": sides[entry["set"]], "fix": ["y", *fix] if is_round and "x" in fix else fix}
    return found


def _cut_profile(tools: Data, name: str, at: int) -> None:
    """Cut a profile at an inner corner between a level and an upright line, in place: a node may lie on both parts."""
    floor, wall = tools[name]["profile"][: at + 1], tools[name]["profile"][at:]
    x, y = floor[-1]
    tools[name]["profile"] = [*floor[:-1], [x + BEYOND, y]]
    tools[f"{name}_wall"] = {**tools[name], "profile": [[x, y - BEYOND], *wall[1:]]}


def _place_in_space(tool: Data, *, is_round: bool) -> None:
    """Turn a tool's profile about the axis, or let it go straight on, in place."""
    tool["shape"] = "round" if is_round else "straight"
    tool.pop("mirrored", None)
    if isinstance(tool.get("position"), list):
        tool["position"] = [tool["position"][0], 0, tool["position"][1]]
    first = tool["profile"][0]
    if is_round and isinstance(first, list) and first[0] < 0:
        tool["profile"][0] = [0, first[1]]


def compute(
    case: Case | SpaceCase, column: str, part: float, part_of_heat: float = 1.0, lead: Course | None = None
) -> Course:
    """Run a case to its end, or as far as it goes.

    part, part_of_heat: what column and heat are of, over the whole. lead: the course whose increments are taken.
    """
    run = begin_run(build_model(case), threads=1)
    procedure, names = run.procedure, [stage.name for stage in run.model.stages]  # type: ignore[attr-defined]
    rows, ends, reason, began = [], [], "", time.process_time()
    try:
        _aim(procedure.state, lead)
        for report in run.advance():
            rows.append(run.row(report))  # what there is before it fails
            ends.append((names.index(report.stage), report.fraction))
            _aim(procedure.state, lead)
    except GaveUpError as error:
        reason = str(error)
    state, mesh = procedure.state, run.model.mesh
    heats = [key for key in rows[-1] if key.startswith("heat_")]
    return Course(
        run.model,
        *np.array(ends).T,
        np.array([float(row[column]) for row in rows]) / part,
        mesh.points + state.nodes.displacement[:, : mesh.points.shape[1]],
        np.array([float(row["heat_stored"]) for row in rows if heats]) / part_of_heat,
        max((abs(float(rows[-1][key])) for key in heats), default=0.0) / part_of_heat,
        time.process_time() - began,
        reason,
    )


def _aim(state: State, lead: Course | None) -> None:
    """Ask for the increment that ends where the next one of another course does."""
    if lead is None:
        return
    now = state[Progress]
    ahead = lead.fraction[(lead.stage == now.stage) & (lead.fraction > now.fraction + SAME)]
    if len(ahead):
        now.next_size = float(ahead[0]) - now.fraction


def find_moving(course: Course) -> BoolArray:
    """Mark the rows of a course that are not in the last REST of a stage that its energy has ended (n_rows,)."""
    ends = np.array([course.fraction[course.stage == stage].max() for stage in course.stage])
    return np.asarray((ends == 1.0) | (course.fraction < (1.0 - REST) * ends))


def match(one: Course, two: Course) -> tuple[IndexArray, Callable[[FloatArray], FloatArray]]:
    """Return the increments of the first course that the second went, too, and what finds values of the second there.

    Where blows end by their energy the ends differ by a little: values are those at the same part of the blow.
    """
    stages = np.unique(two.stage)
    ends = [(one.fraction[one.stage == stage].max(), two.fraction[two.stage == stage].max()) for stage in stages]
    scales = [last / end if abs(end / last - 1.0) < ENDS else 1.0 for last, end in ends]
    at = [
        np.flatnonzero((one.stage == stage) & (one.fraction <= end * scale + SAME))
        for stage, scale, (_, end) in zip(stages, scales, ends, strict=True)
    ]

    def values(of_second: FloatArray) -> FloatArray:
        return np.concatenate([
            np.interp(one.fraction[own], scale * two.fraction[two.stage == stage], of_second[two.stage == stage])
            for own, stage, scale in zip(at, stages, scales, strict=True)
        ])  # fmt: skip

    return np.concatenate(at), values


def outline(course: Course) -> tuple[FloatArray, FloatArray]:
    """Return the first and last points (n, 2) [mm] of the edges round the section at the end."""
    mesh = course.model.mesh
    if mesh.points.shape[1] == 2:
        ends = mesh.boundary_edges[:, :2]
        return course.end[ends[:, 0]], course.end[ends[:, 1]]
    faces = mesh.face_sets["first_plane" if "first_plane" in mesh.node_sets else "bottom"]
    edges = np.concatenate([faces[:, [i, (i + 1) % 4]] for i in range(4)])
    _, index, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    ends = edges[index[count == 1]]
    return course.end[ends[:, 0]][:, [0, 2]], course.end[ends[:, 1]][:, [0, 2]]


def measure_profiles(one: Course, two: Course) -> float:
    """Return the largest distance between two outlines, over the larger extent of the section."""
    first, second = outline(one), outline(two)
    extent = float(np.ptp(first[0], axis=0).max())
    return max(_distance(first[0], second), _distance(second[0], first)) / extent


def _distance(points: FloatArray, edges: tuple[FloatArray, FloatArray]) -> float:
    """Return the largest distance of points (n, 2) from edges [mm]."""
    first, way = edges[0], edges[1] - edges[0]
    away = points[:, None] - first
    part = np.clip((away * way).sum(axis=2) / np.maximum((way**2).sum(axis=1), 1e-30), 0.0, 1.0)
    return float(np.linalg.norm(away - part[..., None] * way, axis=2).min(axis=1).max())
