# SPDX-License-Identifier: Apache-2.0
"""Quadrilaterals in a sector of a disc or of a ring, without cells that come to a point at the middle.

A sector of at most 90 degrees is a kite at the middle and cells between it and the circle. The kite's three other
corners have the same angle, so that a thin sector has no flat corner; its outer sides bulge (a squircle where the
sector is a quarter). Larger sectors are rows of equal ones.
"""

from __future__ import annotations

import math

import numpy as np

from presswork.model import FloatArray, IntArray

BULGE = 0.5
"""How far the kite's outer sides bulge, as a share of the distance to a circle."""
_CORE = 0.9
"""Radius of the kite's corners over that of as many equal cells along the radius."""
_WIDEST = 0.75
"""The farthest that the kite's outer corner lies, over the disc's radius."""


def count_kites(angle: float) -> int:
    """Return the number of kites in a sector of a disc (angle in degrees): one in each 90 degrees."""
    return math.ceil(angle / 90.0 - 1e-9)


def mesh_disc(angle: float, n_radial: int, n_around: int) -> tuple[FloatArray, IntArray]:
    """Return points (n, 2) and quadrilaterals (m, 4) of a sector of the unit disc that begins at the x axis.

    angle: degrees, at most 360. n_around: cells on the circle, 2 k for each kite of k x k cells, k < n_radial.
    Raises ValueError for counts that do not fit.
    """
    n_kites = count_kites(angle)
    k, rest = divmod(n_around, 2 * n_kites)
    if rest or not 1 <= k < n_radial:
        raise ValueError(
            f"cells around must be a multiple of {2 * n_kites}, and at most {2 * n_kites * (n_radial - 1)} with "
            f"{n_radial} along the radius"
        )
    part = angle / n_kites
    points, cells = _mesh_sector(math.radians(part), n_radial, k)
    whole, all_cells = [], []
    for kite in range(n_kites):
        whole.append(points @ _turn(kite * part).T)
        all_cells.append(cells + kite * len(points))
    return _merge(np.concatenate(whole), np.concatenate(all_cells))


def mesh_annulus(angle: float, n_radial: int, n_around: int) -> tuple[FloatArray, IntArray]:
    """Return the parameters (n, 2) of points of a sector of a ring, and quadrilaterals (m, 4).

    The parameters are the share of the distance from the inner to the outer circle, and the angle [degrees], which
    begins with 0. A ring of 360 degrees is closed.
    """
    closed = angle > 360.0 * (1 - 1e-12)
    n_columns = n_around if closed else n_around + 1
    rows, columns = np.meshgrid(np.arange(n_radial + 1), np.arange(n_columns), indexing="ij")
    parameters = np.column_stack([rows.ravel() / n_radial, angle * columns.ravel() / n_around])
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(n_radial), np.arange(n_around), indexing="ij"))
    after = (j + 1) % n_columns
    first, beyond = i * n_columns, (i + 1) * n_columns
    return parameters, np.column_stack([first + j, beyond + j, beyond + after, first + after]).astype(np.int32)


def point_at(radius: FloatArray, degrees: FloatArray) -> FloatArray:
    """Return the points (n, 2) at radii and angles; multiples of 90 degrees lie exactly on the axes."""
    turned = np.radians(degrees)
    cosine, sine = np.cos(turned), np.sin(turned)
    cosine[np.mod(degrees, 180.0) == 90.0] = 0.0
    sine[np.mod(degrees, 180.0) == 0.0] = 0.0
    return np.column_stack([radius * cosine, radius * sine])


def _mesh_sector(angle: float, n_radial: int, k: int) -> tuple[FloatArray, IntArray]:
    """Mesh one sector (angle [rad], at most a quarter): a kite of k x k cells and n_radial - k rows round it."""
    side, across = _kite_corners(angle, n_radial, k)
    s, t = (grid.ravel() for grid in np.meshgrid(np.arange(k + 1) / k, np.arange(k + 1) / k, indexing="ij"))
    far = point_at(np.ones(1), np.degrees([angle]))[0]
    kite = np.outer(s * (1 - t), [side, 0.0]) + np.outer((1 - s) * t, side * far) + np.outer(s * t, across)
    reach, level = np.linalg.norm(kite, axis=1), np.maximum(s, t)
    round_part = np.divide(side * level, reach, out=np.ones_like(reach), where=reach > 0)
    kite *= (1 - BULGE * level * (1 - round_part))[:, None]
    numbers = np.arange((k + 1) ** 2, dtype=np.int32).reshape(k + 1, k + 1)
    cells = [_grid_cells(numbers)]
    rim = np.concatenate([numbers[k, : k + 1], numbers[:k, k][::-1]])
    circle = point_at(np.ones(2 * k + 1), np.degrees(angle) * np.arange(2 * k + 1) / (2 * k))
    part = (np.arange(1, n_radial - k + 1) / (n_radial - k))[:, None, None]
    rows = (1 - part) * kite[rim] + part * circle
    own = len(kite) + np.arange(rows[..., 0].size, dtype=np.int32).reshape(rows.shape[:2])
    cells.append(_grid_cells(np.concatenate([rim[None], own])))
    return np.concatenate([kite, rows.reshape(-1, 2)]), np.concatenate(cells)


def _kite_corners(angle: float, n_radial: int, k: int) -> tuple[float, FloatArray]:
    """Return the radius of the kite's corners on the sides of the sector, and its outer corner (2,)."""
    corner = _outer_corner(angle)
    side = min(_CORE * k / n_radial, _WIDEST / reach_of_kite(angle))
    return side, side * corner


def reach_of_kite(angle: float) -> float:
    """Return the distance of a kite's outer corner from the middle, over that of its corners on the sides."""
    return (1 - BULGE) * float(np.linalg.norm(_outer_corner(angle))) + BULGE


def _outer_corner(angle: float) -> FloatArray:
    """Return the outer corner (2,) of a kite whose corners on the sides of the sector lie at 1, before it bulges."""
    inner = (2 * math.pi - angle) / 3  # the angle of the three corners
    up = math.pi - inner  # direction from the corner on the x axis to the outer one
    half = math.tan(angle / 2)
    distance = half / (math.sin(up) - half * math.cos(up))
    return np.array([1 + distance * math.cos(up), distance * math.sin(up)])


def _grid_cells(numbers: IntArray) -> IntArray:
    """Return the quadrilaterals between the rows and columns of a grid of node numbers, counter-clockwise."""
    return np.stack([numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]], axis=-1).reshape(-1, 4)


def _turn(degrees: float) -> FloatArray:
    """Return the matrix that turns by an angle; multiples of 90 degrees are exact."""
    (cosine, sine), _ = point_at(np.ones(2), np.array([degrees, 0.0]))
    return np.array([[cosine, -sine], [sine, cosine]])


def _merge(points: FloatArray, cells: IntArray) -> tuple[FloatArray, IntArray]:
    """Merge points that coincide to 1e-9; the first of them stays, and the numbers keep their order."""
    _, first, number = np.unique(np.round(points / 1e-9) + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.sort(first)
    rank = np.empty(len(order), dtype=np.int32)
    rank[np.argsort(first, kind="stable")] = np.arange(len(order), dtype=np.int32)
    return points[order], rank[number.reshape(-1)][cells].astype(np.int32)
