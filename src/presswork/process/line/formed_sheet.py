# SPDX-License-Identifier: Apache-2.0
"""Turns the state of a sheet into a FormedSheet, which files hold, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.law.at_rest import fill_history
from presswork.law.history import EQPS
from presswork.law.umat import list_sheet_history, open_sheet_law
from presswork.mesh.files.dynain import CENTRE, first_sides
from presswork.mesh.thickness_rule import thickness_rule
from presswork.mesh.topology import with_four_nodes
from presswork.model import FloatArray, FormedSheet, IntArray, Mesh, Model
from presswork.process.mesh_change.transfer import SheetBlock, SheetState, TransferError

FROM = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Where a tensor has xx, yy, zz, xy, yz, zx."""
TO = (np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0]))


def make_formed(state: SheetState, mesh: Mesh, before: FormedSheet | None) -> FormedSheet:
    """Return a sheet's state in space.

    mesh: undeformed; before: the formed sheet that it is, with whose strain that of the sheet goes on; None: flat.
    """
    section = mesh.blocks[0].section
    assert section is not None
    parts: list[list[NDArray[Any]]] = []
    n_cells = sum(len(block.connectivity) for block in state.blocks)
    first = np.zeros((n_cells, 6)) if before is None else before.strain
    knows_strain = first is not None and len(first) == n_cells
    for block, undeformed in zip(state.blocks, mesh.blocks, strict=True):
        cells = with_four_nodes(block.connectivity)
        axis, across = _frames(state.position, cells, block.axis.mean(axis=1))
        s = block.stress.mean(axis=1)
        tensor = sum(
            s[..., i, None, None] * (a[:, None, :, None] * b[:, None, None, :])
            for i, a, b in ((0, axis, axis), (1, across, across), (2, axis, across), (2, across, axis))
        )
        thickness = block.thickness.mean(axis=1)
        done = sum(len(part[0]) for part in parts)
        start = first[done : done + len(cells)] if first is not None and knows_strain else np.zeros((len(cells), 6))
        strain = _strain(mesh.points, state.position, cells, start, np.log(thickness / undeformed.thickness))
        plastic = block.history[..., 0].mean(axis=1)
        parts.append([cells, thickness, axis, np.asarray(tensor)[:, :, TO[0], TO[1]], plastic, strain])
    cells, thickness, axis, stress, plastic, strain = (np.concatenate(each) for each in zip(*parts, strict=True))
    return FormedSheet(
        state.position,
        cells.astype(np.int32),
        thickness,
        axis,
        thickness_rule(section)[0],
        stress,
        plastic,
        strain if knows_strain else None,
    )


def begin_formed(model: Model) -> SheetState | None:
    """Return the state that a model's formed sheet begins with; None of a blank. Raises TransferError."""
    sheet = model.formed
    if sheet is None:
        return None
    section, material = model.sheet
    heights = thickness_rule(section)[0]
    if len(heights) != len(sheet.heights) or np.abs(heights - sheet.heights).max() > 1e-3:
        given = ", ".join(f"{each:.4g}" for each in sheet.heights)
        raise TransferError(
            f"the formed sheet has layers at {given} of half its thickness, blank.points and blank.rule ask for others"
        )
    law = open_sheet_law(material)
    blocks, first = [], 0
    for block in model.mesh.blocks:
        own = slice(first, first + len(block.connectivity))
        first = own.stop
        axis, across = _frames(sheet.points, with_four_nodes(block.connectivity), sheet.axis[own])
        tensor = sheet.stress[own][..., FROM]
        pairs = ((axis, axis), (across, across), (axis, across))
        stress = np.stack([np.einsum("ci,ckij,cj->ck", a, tensor, b) for a, b in pairs], axis=-1)
        shape = (len(axis), 1, len(heights))
        kept = list_sheet_history(law)
        history = fill_history(kept, shape)
        history[..., kept[EQPS]] = sheet.plastic_strain[own][:, None, :, None]
        thickness = sheet.thickness[own][:, None]
        blocks.append(SheetBlock(block.connectivity, axis[:, None], thickness, stress[:, None], history))
    return SheetState(sheet.points, tuple(blocks))


def _frames(points: FloatArray, cells: IntArray, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return x and y of the law in the plane of each cell (n, 3); axis: x, about."""
    _, normal = first_sides(points, cells)
    x = axis - (axis * normal).sum(axis=1, keepdims=True) * normal
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return x, np.cross(normal, x)


def _strain(start: FloatArray, now: FloatArray, cells: IntArray, before: FloatArray, across: FloatArray) -> FloatArray:
    """Return the logarithmic strain of the middle surface in space (n, 6).

    start, now: positions (n_points, 3) [mm]; before: strain at the start (n, 6); across: that of the thickness (n,).
    With the stretch V before, F V R is the whole deformation gradient, and F V V F^T the square of the stretch.
    """
    flat: list[FloatArray] = []
    log_before = np.empty(0)
    for points in (start, now):
        side, normal = first_sides(points, cells)
        frame = np.stack([side, np.cross(normal, side)], axis=1)
        if not flat:
            log_before = np.einsum("cik,ckl,cjl->cij", frame, before[:, FROM], frame)
        flat.append(np.einsum("cki,ja,cai->ckj", frame, CENTRE, points[cells]))
    gradient = flat[1] @ np.linalg.inv(flat[0])
    values, vectors = np.linalg.eigh(log_before)
    squared = np.einsum("cik,ck,cjk->cij", vectors, np.exp(2.0 * values), vectors)
    values, vectors = np.linalg.eigh(gradient @ squared @ gradient.transpose(0, 2, 1))
    log = np.einsum("cik,ck,cjk->cij", vectors, 0.5 * np.log(values), vectors)
    tensor = np.einsum("cki,ckl,clj->cij", frame, log, frame)
    tensor += across[:, None, None] * normal[:, :, None] * normal[:, None, :]
    return np.asarray(tensor[:, TO[0], TO[1]])
