# SPDX-License-Identifier: Apache-2.0
"""Turns the beads of a stamping's case into those of its Model: cut into points, and located on the blank."""

from __future__ import annotations

import itertools
import logging

import numpy as np
import scipy

from presswork import _core
from presswork.case.errors import Problem, suggest
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage import StampingBead, StampingStage
from presswork.model import BoolArray, Drawbead, FloatArray, Mesh, Tool

logger = logging.getLogger(__name__)

PER_ELEMENT = 4
"""Points of a line in an element of the blank, about."""
PARTS = 64
"""Parts of a piece of a line that passes over the edge of the blank."""


def check_bead_stages(case: StampingCase) -> list[Problem]:
    """Return the problems of beads that show without geometry."""
    problems = []
    names = [stage.name for stage in case.stages]
    pushed = {
        name
        for stage in case.stages
        for name, action in stage.tools.items()
        if action.force is not None and name in case.tools and case.tools[name].kind == "holder"
    }
    for index, bead in enumerate(case.beads):
        key = f"beads.{index}"
        if (name := f"bead_{index + 1}") in case.tools:
            problems.append(Problem(f"tools.{name}", "beads have this name in the history", "give it another"))
        problems += [
            Problem(f"{key}.stages", "no such stage", suggest(name, names, "stages"), name)
            for name in bead.stages or ()
            if name not in names
        ]
        if bead.closing_force > 0 and not pushed:
            fault = "no holder is pushed by a force that could close the bead"
            remedy = "leave it out, or give a holder a force (stages.N.tools.NAME.force)"
            problems.append(Problem(f"{key}.closing_force", fault, remedy, bead.closing_force))
    return problems


def closed_stages(bead: StampingBead, case: StampingCase) -> tuple[str, ...]:
    """Return the names of the stages in which a bead holds."""
    if bead.stages is not None:
        return bead.stages
    return tuple(stage.name for stage in case.stages if not _opens_or_closes(stage, case))


def _opens_or_closes(stage: StampingStage, case: StampingCase) -> bool:
    """Return whether strokes move a holder to or from a die."""
    stroke = {
        kind: [
            action.travel if (action := stage.tools.get(name)) else 0.0
            for name, tool in case.tools.items()
            if tool.kind == kind
        ]
        for kind in ("holder", "die")
    }
    return any(h + d != 0.0 for h, d in itertools.product(stroke["holder"], stroke["die"]))


def build_beads(case: StampingCase, mesh: Mesh, tools: tuple[Tool, ...]) -> tuple[tuple[Drawbead, ...], list[Problem]]:
    """Cut the beads into points, as much of them as lies over the blank that is modelled."""
    corners = mesh.points[mesh.blocks[0].connectivity]
    spacing = float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2))) / PER_ELEMENT
    die = next((tool.name for tool in tools if tool.kind == "die"), None)
    beads, problems = [], []
    for index, bead in enumerate(case.beads):
        line = bead.polyline()
        modelled = cut_line(line, spacing, ["x" in case.blank.symmetry, "y" in case.blank.symmetry])
        places, across, lengths = _keep_over_mesh(mesh, *modelled)
        over = lengths > 0.0
        if not over.any():
            low, high = line.min(axis=0), line.max(axis=0)
            text = (
                f"no part of the line lies over the blank{_planes(case)}: it spans x {low[0]:g} to {high[0]:g} mm, "
                f"y {low[1]:g} to {high[1]:g} mm"
            )
            problems.append(Problem(f"beads.{index}.points", text, "move it onto the flange"))
            continue
        place, across, length = places[over], across[over], lengths[over]
        beside = float(modelled[2].sum() - length.sum())
        if beside > 0.0:
            logger.warning("beads.%d.points: %.4g mm of the line lie beside the blank and do nothing", index, beside)
        beads.append(
            Drawbead(
                f"bead_{index + 1}", place, across, length, bead.force, die, closing_force=bead.closing_force,
                is_sought=bead.geometry is not None,
            )
        )  # fmt: skip
    return tuple(beads), problems


def _planes(case: StampingCase) -> str:
    planes = " and ".join(f"{axis} >= 0" for axis in "xy" if axis in case.blank.symmetry)
    return f" at {planes}" if planes else ""


def cut_line(line: FloatArray, spacing: float, symmetry: list[bool]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cut a polyline (n, 2) into pieces of at most `spacing`, without those beyond symmetry planes x = 0 and y = 0.

    No piece crosses an axis, so that a whole line has the pieces of its parts. Returns the pieces' middles (m, 2), unit
    normals (m, 2) and lengths (m,).
    """
    places, normals, lengths = [np.zeros((0, 2))], [np.zeros((0, 2))], [np.zeros(0)]
    for a, b in itertools.pairwise(line):
        along = b - a
        crossings = [a[axis] / (a[axis] - b[axis]) for axis in (0, 1) if a[axis] * b[axis] < 0.0]
        for begin, end in itertools.pairwise(sorted({0.0, 1.0, *crossings})):
            middle = a + 0.5 * (begin + end) * along
            if any(is_cut and middle[axis] < 0.0 for axis, is_cut in enumerate(symmetry)):
                continue
            length = float(np.linalg.norm(along)) * (end - begin)
            n = max(1, int(np.ceil(length / spacing * (1 - 1e-9))))
            fractions = begin + (np.arange(n) + 0.5) / n * (end - begin)
            places.append(a + fractions[:, None] * along)
            unit = along / np.linalg.norm(along)
            normals.append(np.tile([-unit[1], unit[0]], (n, 1)))
            lengths.append(np.full(n, length / n))
    return np.concatenate(places), np.concatenate(normals), np.concatenate(lengths)


def _keep_over_mesh(
    mesh: Mesh, places: FloatArray, normals: FloatArray, lengths: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return pieces of a line with what of each lies over a mesh: middles (m, 2), normals (m, 2), lengths (m,)."""
    along = np.column_stack([normals[:, 1], -normals[:, 0]]) * lengths[:, None]
    ends = (along[:, None] * np.array([-0.5, 0.0, 0.5])[:, None] * (1.0 - 1e-9) + places[:, None]).reshape(-1, 2)
    over = find_over_mesh(mesh, ends).reshape(-1, 3)
    places, lengths = places.copy(), np.where(over.all(axis=1), lengths, 0.0)
    for piece in np.flatnonzero(over.any(axis=1) & ~over.all(axis=1)):
        fractions = (np.arange(PARTS) + 0.5) / PARTS - 0.5
        covered = fractions[find_over_mesh(mesh, places[piece] + fractions[:, None] * along[piece])]
        if len(covered):
            lengths[piece] = np.linalg.norm(along[piece]) * len(covered) / PARTS
            places[piece] = places[piece] + covered.mean() * along[piece]
    return places, normals, lengths


def find_over_mesh(mesh: Mesh, places: FloatArray) -> BoolArray:
    """Return which places (n, 2) lie over a mesh of shells, seen from above (n,)."""
    cells = [np.ascontiguousarray(block.connectivity, dtype=np.int32) for block in mesh.blocks]
    sheet = _core.SheetUnder(cells)
    middles = np.concatenate([mesh.points[each].mean(axis=1)[:, :2] for each in cells])
    nearest = scipy.spatial.cKDTree(middles).query(places)[1]
    return np.asarray(sheet.find(places, mesh.points, nearest.astype(np.int32))[1], dtype=bool)


def check_closing(case: StampingCase, beads: tuple[Drawbead, ...], whole: int) -> list[Problem]:
    """Return a problem where a holder's force does not close the beads."""
    problems = []
    for index, stage in enumerate(case.stages):
        closed = (
            b for b, bead_case in zip(beads, case.beads, strict=True) if stage.name in closed_stages(bead_case, case)
        )
        needed = whole * sum(b.closing_force * float(b.length.sum()) for b in closed)
        for name, action in stage.tools.items():
            if action.force is None or case.tools[name].kind != "holder":
                continue
            rows = action.force if isinstance(action.force, tuple) else ((0.0, action.force),)
            least = min(force for _, force in rows)
            if needed > 0 and least <= needed:
                fault = f"a force of {least:g} N does not close the beads, which take {needed:.4g} N"
                remedy = "push harder, or lower beads.N.closing_force (make a bead of a geometry shallower)"
                problems.append(Problem(f"stages.{index}.tools.{name}.force", fault, remedy, least))
    return problems
