# SPDX-License-Identifier: Apache-2.0
"""The sheet of a run as one description that writers of other programs' files read: a FormedSheet and notes on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, cast, get_args

import numpy as np

from presswork.fields.field import PLACES
from presswork.mesh import MeshError
from presswork.mesh.files.dynain import CENTRE, first_sides, read_dynain
from presswork.mesh.topology import with_four_nodes
from presswork.model import FloatArray, FormedSheet, FormedSolid, IntArray
from presswork.results import Result, ResultError

Frame = Literal["axisymmetric", "plane_strain", "solid"]
_SOUND = 0.3
"""Poisson's ratio where a run does not store its own."""
_STEEL = 206e3
"""Young's modulus [MPa] where a run does not store its own."""
_SAME = 1e-6
"""How far nodes of a part's dynain may lie off those of the results, over the part's size."""


@dataclass(frozen=True)
class FormedPart:
    """A formed sheet as a run has left it."""

    sheet: FormedSheet
    title: str
    young: float
    """[MPa]"""
    poisson: float
    notes: tuple[str, ...]
    """What the files lack, or state differently."""


def read_formed_part(
    result: Result, step: int = -1, whole: Callable[[], FormedSheet | None] = lambda: None
) -> FormedPart:
    """Return the sheet of a run at a saved step. Raises ResultError for what is no sheet.

    At the end of an operation that wrote its dynain all layers are known; else those of the results: bottom, middle and
    top. whole: returns the sheet at the end of the run, if the caller knows it otherwise.
    """
    if not result.is_shell:
        raise ResultError(f"{result.folder} is no sheet: it has no thickness")
    info = result.info
    notes: list[str] = []
    sheet = _read_own_dynain(result, step)
    if sheet is None and step % len(result.times) == len(result.times) - 1:
        sheet = whole()
        sheet = sheet if sheet is not None and _is_at(sheet, result.points(step)) else None
    if sheet is None:
        sheet, notes = _read_fields(result, step)
    young, poisson = float(info.get("young", _STEEL)), float(info.get("poisson", _SOUND))
    if "young" not in info:
        notes.append(f"elastic energy is that of steel, {_STEEL:g} MPa and {_SOUND}: the run does not store its own")
    if info.get("symmetry"):
        planes = " and ".join(f"{axis} = 0" for axis in str(info["symmetry"]))
        notes.append(f"the part is cut by its symmetry planes {planes}: mirror it where it is used")
    return FormedPart(sheet, str(info.get("title", "")).strip(), young, poisson, tuple(notes))


def _read_own_dynain(result: Result, step: int) -> FormedSheet | None:
    """Return what the run wrote at the end of an operation, if the step is that end."""
    points = result.points(step)
    last = step % len(result.times) == len(result.times) - 1
    names = [f"{result.operation_at(step)}.dynain"] if result.is_line else ["part.dynain"] if last else []
    for path in (result.folder / name for name in names):
        if path.is_file():
            try:
                found = read_dynain(path)
            except MeshError as error:
                raise ResultError(f"{path}: {error}") from error
            if _is_at(found, points):
                return found
    return None


def _is_at(sheet: FormedSheet, points: FloatArray) -> bool:
    """Return whether nodes of a sheet lie at points (n_points, 3)."""
    size = float(np.ptp(points, axis=0).max())
    return sheet.points.shape == points.shape and bool(np.abs(sheet.points - points).max() < _SAME * size)


def _read_fields(result: Result, step: int) -> tuple[FormedSheet, list[str]]:
    """Return the sheet by the fields of a step, and notes."""
    mesh, points = result.mesh_at(step), result.points(step)
    cells = np.concatenate([with_four_nodes(b.connectivity.astype(np.int32)) for b in mesh.blocks]).astype(np.int32)
    layers = np.asarray(result.info.get("layers", (-1.0, 0.0, 1.0)), dtype=float)
    notes = [f"stresses in three of {len(layers)} layers: the case beside them is not there, or not as it was"]
    if len(layers) == 3:
        notes = []
    if "layers" not in result.info:
        notes = ["the run does not store where its layers lie: the outer ones are taken to lie on the faces"]
    heights = np.array([layers[0], 0.0, layers[-1]])
    if "stress_top" in result.field_names:
        stress = np.stack([result.field(f"stress_{place}", step) for place in PLACES], axis=1)
    else:
        stress = np.zeros((len(cells), 3, 6))
        notes = ["the run has no stresses: they are zero"]
    plastic = np.stack([result.field(f"equivalent_plastic_strain_{place}", step) for place in PLACES], axis=1)
    rolling = np.asarray(result.info.get("rolling", (1.0, 0.0, 0.0)), dtype=float)
    axis = carry_direction(mesh.points, points, cells, rolling)
    strain = result.field("strain_middle", step).copy() if "strain_middle" in result.field_names else None
    if strain is not None:
        _, normal = first_sides(points, cells)
        across = result.field("thickness_strain", step)
        pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
        strain += np.stack([across * normal[:, i] * normal[:, j] for i, j in pairs], axis=1)
    sheet = FormedSheet(points, cells, result.field("thickness", step), axis, heights, stress, plastic, strain)
    return sheet, notes


def carry_direction(start: FloatArray, now: FloatArray, cells: IntArray, direction: FloatArray) -> FloatArray:
    """Return unit vectors (n, 3): a direction of the undeformed sheet, turned with each shell.

    start, now: positions (n_points, 3) [mm]. It turns by the rotation of the polar decomposition in the sheet.
    """
    gradients, frames = [], []
    for points in (start, now):
        side, normal = first_sides(points, cells)
        frame = np.stack([side, np.cross(normal, side)], axis=1)
        frames.append(frame)
        gradients.append(np.einsum("cki,ja,cai->ckj", frame, CENTRE, points[cells]))
    f = gradients[1] @ np.linalg.inv(gradients[0])
    angle = np.arctan2(f[:, 1, 0] - f[:, 0, 1], f[:, 0, 0] + f[:, 1, 1])
    along = np.einsum("cki,i->ck", frames[0], direction)
    cos, sin = np.cos(angle), np.sin(angle)
    turned = np.stack([cos * along[:, 0] - sin * along[:, 1], sin * along[:, 0] + cos * along[:, 1]], axis=1)
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)
    return np.asarray(np.einsum("ck,cki->ci", turned, frames[1]))


def read_formed_solid(result: Result, step: int = -1) -> FormedSolid:
    """Return the body of a run at a saved step. Raises ResultError for what is no solid with stresses."""
    frame = str(result.info.get("analysis"))
    if frame not in get_args(Frame) or "stress" not in result.field_names:
        raise ResultError(f"{result.folder} has no formed solid: {frame}")
    blocks = tuple(block.connectivity.astype(np.int32) for block in result.mesh_at(step).blocks)
    stress, plastic = (result.field(name, step) for name in ("stress", "equivalent_plastic_strain"))
    return FormedSolid(result.points(step), blocks, cast(Frame, frame), stress, plastic)
