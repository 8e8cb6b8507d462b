# SPDX-License-Identifier: Apache-2.0
"""New skins of bodies that touch, fitted to each other.

Skins of flat faces cut each other between their nodes where a joint is curved, by a hundredth of an edge. Contact
answers that with pressures of thousands of MPa. So before the bodies take over their state, nodes of new skins move by
the least sum of squares that closes the mean gap of each slot: of those on nodes that touched, and of those whose faces
have come into the other body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from presswork.interaction.bodies.space_interface import SpaceInterface
from presswork.model import BoolArray, FloatArray, IndexArray, Model

CLOSED = 1e-6
"""Gap that counts as closed, over the mean edge."""
_ROUNDS = 6
_RIDGE = 1e-9


def fit_joints(
    model: Model, touches: BoolArray, is_free: BoolArray, depths: Sequence[FloatArray] | None = None
) -> FloatArray:
    """Return the points of a model's mesh (n_points, 3) [mm], moved so that bodies lie on each other where they touch.

    touches: nodes that lie on another body (n_points,); is_free: coordinates that may change (n_points, 3); depths: of
    each contact, how deep the nodes of its slave are to lie in the other body (n_points,) [mm], NaN of those that may
    lie as they do; None: all on its surface.
    """
    depths = [np.zeros(len(touches))] * len(model.contacts) if depths is None else depths
    both = [(c, depth) for c, depth in zip(model.contacts, depths, strict=True) if c.slave != c.master]
    interfaces = [SpaceInterface(model, c, 0) for c, _ in both]
    wanted = [depth[i.nodes] for i, (_, depth) in zip(interfaces, both, strict=True)]
    points = model.mesh.points.copy()
    columns = np.flatnonzero(is_free)
    place = np.full(is_free.size, -1)
    place[columns] = np.arange(len(columns))
    for _ in range(_ROUNDS):
        parts = [_find_gaps(i, points, touches, place, depth) for i, depth in zip(interfaces, wanted, strict=True)]
        gap = np.concatenate([own for own, _ in parts])
        if all(
            np.abs(own).max(initial=0.0) < CLOSED * i.mean_edge for (own, _), i in zip(parts, interfaces, strict=True)
        ):
            break
        slopes = scipy.sparse.vstack([own for _, own in parts], format="csr")
        normal = slopes @ slopes.T
        normal += _RIDGE * normal.diagonal().max() * scipy.sparse.eye_array(len(gap))
        points.reshape(-1)[columns] += slopes.T @ scipy.sparse.linalg.spsolve(normal.tocsc(), gap)
    return points


def _find_gaps(
    interface: SpaceInterface, points: FloatArray, touches: BoolArray, place: IndexArray, depth: FloatArray
) -> tuple[FloatArray, scipy.sparse.csr_array]:
    """Return the gaps to be closed (m,) [mm] and the slopes of -gap to the free coordinates (m, n_free).

    place: of each coordinate of the nodes among the free ones, -1 if it is not (3 n_points,); depth: that counts as no
    gap, of each slot [mm].
    """
    interface.search(points)
    found = interface.measure_gaps(points)
    gap = np.asarray(found.gap) + depth
    wanted = np.isfinite(gap) & (touches[interface.nodes] | (gap < 0.0))
    number = np.full(len(gap), -1)
    number[wanted] = np.arange(np.count_nonzero(wanted))
    slot, node = np.asarray(found.slope_places).T
    column = place[3 * node[:, None] + np.arange(3)]
    row = np.broadcast_to(number[slot][:, None], column.shape)
    own = (row >= 0) & (column >= 0)
    entries = np.asarray(found.pressure_slopes)[own], (row[own], column[own])
    shape = np.count_nonzero(wanted), int(place.max()) + 1
    return gap[wanted], scipy.sparse.csr_array(entries, shape=shape)
