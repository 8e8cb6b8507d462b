# SPDX-License-Identifier: Apache-2.0
"""A formed sheet mapped to the shells of another mesh: thickness, stress and plastic strain.

Each shell takes the mean over a grid of its own places. A place takes what the nearest shell of the part has at its
foot: the value of that shell and its slope, by least squares over the shells that share a node with it. That is exact
for what varies linearly. Stresses go by the axes of the material, which are laid into the new shell, so they turn with
the sheet; where a normal of the new mesh points to the opposite side, the layers are counted from the other face.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from presswork.geometry.foot_on_triangles import find_feet
from presswork.mesh.files.dynain import first_sides
from presswork.mesh.files.formed.layers import lamina_frames, lamina_stress, shell_areas
from presswork.mesh.files.shell_mesh import ShellMesh
from presswork.model import BoolArray, FloatArray, FormedSheet, IntArray

_MOST = 6
"""Places along a side of a new shell at most."""
_BEYOND = 0.5
"""How far a place may lie beyond the range of the neighbours' values, over that range."""
_FROM = (np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0]))


@dataclass(frozen=True)
class MappedSheet:
    """A formed sheet on another mesh."""

    sheet: FormedSheet
    is_covered: BoolArray
    """Whether the part lies at a shell (n,)."""
    distance: FloatArray
    """Mean distance of a shell from the part [mm] (n,)."""


def map_sheet(part: FormedSheet, mesh: ShellMesh, within: float | None = None) -> MappedSheet:
    """Map a part to the shells of a mesh that lies where the part does.

    within: distance from the part up to which a shell is covered [mm]; None: half a shell of the part. Shells that are
    not covered get the part's mean thickness and neither stress nor plastic strain.
    """
    k = len(part.heights)
    size = float(np.sqrt(np.median(shell_areas(part.points, part.cells))))
    values = np.column_stack([
        part.thickness, part.axis, part.plastic_strain, lamina_stress(part, lamina_frames(part)).reshape(-1, 3 * k)
    ])  # fmt: skip
    places, owner, share = _sample(mesh, size)
    triangles, parent = _triangulate(part.cells)
    feet = find_feet(places, part.points, triangles)
    at = feet.interpolate(part.points, triangles)
    found = _Slopes(part, values).take(parent[feet.triangle], at)
    far = np.linalg.norm(places - at, axis=1)
    whole = np.bincount(owner, share, len(mesh.cells))

    def mean(samples: FloatArray) -> FloatArray:
        columns = samples.reshape(len(samples), -1).T
        return np.stack([np.bincount(owner, share * column, len(whole)) / whole for column in columns], axis=1)

    _, source_normal = first_sides(part.points, part.cells)
    side, normal = first_sides(mesh.points, mesh.cells)
    is_turned = mean((source_normal[parent[feet.triangle]] * normal[owner]).sum(axis=1))[:, 0] < 0.0
    average, distance = mean(found), mean(far)[:, 0]
    is_covered = distance <= (0.5 * size if within is None else within)
    thickness = np.where(is_covered, average[:, 0], part.thickness.mean())
    axis = average[:, 1:4] - (average[:, 1:4] * normal).sum(axis=1, keepdims=True) * normal
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    axis = np.where(length > 1e-6, axis / np.maximum(length, 1e-300), side)
    plastic = np.where(is_covered[:, None], np.maximum(average[:, 4 : 4 + k], 0.0), 0.0)
    stress = np.where(is_covered[:, None, None], average[:, 4 + k :].reshape(-1, k, 3), 0.0)
    plastic = np.where(is_turned[:, None], plastic[:, ::-1], plastic)
    stress = np.where(is_turned[:, None, None], stress[:, ::-1] * [1.0, 1.0, -1.0], stress)
    sheet = FormedSheet(
        mesh.points, mesh.cells, thickness, axis, part.heights, _in_space(stress, axis, normal), plastic,
        node_labels=mesh.node_labels, cell_labels=mesh.cell_labels,
    )  # fmt: skip
    return MappedSheet(sheet, is_covered, distance)


def covered_part(mapped: MappedSheet) -> FormedSheet:
    """Return the shells of a mapped sheet at which the part lies."""
    own, s = mapped.is_covered, mapped.sheet
    return replace(
        s, cells=s.cells[own], thickness=s.thickness[own], axis=s.axis[own], stress=s.stress[own],
        plastic_strain=s.plastic_strain[own], cell_labels=s.shells_in_files[own],
    )  # fmt: skip


class _Slopes:
    """Values of shells (n, m) with their slopes along the sheet."""

    def __init__(self, part: FormedSheet, values: FloatArray) -> None:
        cells = part.cells
        self._values = values
        self._middle = np.where(
            (cells[:, 2] == cells[:, 3])[:, None],
            part.points[cells[:, :3]].mean(axis=1),
            part.points[cells].mean(axis=1),
        )
        side, normal = first_sides(part.points, cells)
        self._frame = np.stack([side, np.cross(normal, side)], axis=1)
        rows = np.repeat(np.arange(len(cells)), 4)
        touch = csr_array((np.ones(cells.size), (rows, cells.ravel())), shape=(len(cells), len(part.points)))
        pairs = (touch @ touch.T).tocoo()
        own, other = pairs.row[pairs.row != pairs.col], pairs.col[pairs.row != pairs.col]
        apart = self._middle[other] - self._middle[own]
        flat = np.einsum("pki,pi->pk", self._frame[own], apart)
        flat *= (np.linalg.norm(apart, axis=1) / np.maximum(np.linalg.norm(flat, axis=1), 1e-300))[:, None]
        n = len(cells)
        normal_matrix, right = np.zeros((n, 2, 2)), np.zeros((n, 2, values.shape[1]))
        np.add.at(normal_matrix, own, flat[:, :, None] * flat[:, None, :])
        np.add.at(right, own, flat[:, :, None] * (values[other] - values[own])[:, None, :])
        self._slope = np.linalg.pinv(normal_matrix, rcond=1e-6, hermitian=True) @ right
        self._low, self._high = values.copy(), values.copy()
        np.minimum.at(self._low, own, values[other])
        np.maximum.at(self._high, own, values[other])

    def take(self, cell: IntArray, at: FloatArray) -> FloatArray:
        """Return the values of shells (n,) at places in them (n, 3)."""
        flat = np.einsum("nki,ni->nk", self._frame[cell], at - self._middle[cell])
        found = self._values[cell] + np.einsum("nk,nkm->nm", flat, self._slope[cell])
        room = _BEYOND * (self._high - self._low)[cell]
        return np.asarray(np.clip(found, self._low[cell] - room, self._high[cell] + room))


def _sample(mesh: ShellMesh, size: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return places of every shell, which shell each belongs to, and its area; size: of a shell of the part [mm]."""
    own_size = np.sqrt(shell_areas(mesh.points, mesh.cells))
    along = np.clip(np.ceil(own_size / size).astype(int) + 1, 2, _MOST)
    places, owner, share = [], [], []
    for n in np.unique(along):
        own = np.flatnonzero(along == n)
        t, w = np.polynomial.legendre.leggauss(n)  # exact for what is linear in any quadrilateral, a triangle too
        r, s = (v.ravel() for v in np.meshgrid(0.5 * (1.0 + t), 0.5 * (1.0 + t)))
        weight = np.stack([(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s])
        slopes = np.stack([np.stack([s - 1, 1 - s, s, -s]), np.stack([r - 1, -r, r, 1 - r])])
        base = np.einsum("dkp,cki->dcpi", slopes, mesh.points[mesh.cells[own]])
        share.append(np.linalg.norm(np.cross(base[0], base[1]), axis=2) * np.outer(w, w).ravel())
        places.append(np.einsum("kp,cki->cpi", weight, mesh.points[mesh.cells[own]]).reshape(-1, 3))
        owner.append(np.repeat(own, n * n))
    return np.concatenate(places), np.concatenate(owner), np.concatenate([each.ravel() for each in share])


def _triangulate(cells: IntArray) -> tuple[IntArray, IntArray]:
    """Return triangles of shells (n, 4), and the shell of each."""
    is_quad = np.flatnonzero(cells[:, 2] != cells[:, 3])
    triangles = np.concatenate([cells[:, :3], cells[is_quad][:, [0, 2, 3]]])
    return triangles.astype(np.int32), np.concatenate([np.arange(len(cells)), is_quad])


def _in_space(stress: FloatArray, axis: FloatArray, normal: FloatArray) -> FloatArray:
    """Return stresses xx, yy, xy (n, k, 3) in the axes of shells as xx, yy, zz, xy, yz, zx in space (n, k, 6)."""
    frame = np.stack([axis, np.cross(normal, axis)], axis=1)
    local = stress[..., [[0, 2], [2, 1]]]
    tensor = np.einsum("cip,ckij,cjq->ckpq", frame, local, frame)
    return np.asarray(tensor[:, :, _FROM[0], _FROM[1]])
