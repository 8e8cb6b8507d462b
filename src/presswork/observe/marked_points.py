# SPDX-License-Identifier: Apache-2.0
"""Marked points: where material points of a run have gone, and what they have seen, in the history.

A point is held by a simplex of the mesh's nodes (a triangle; in a hexahedron a tetrahedron) and its shares in them, and
moves with it. On a new mesh of a deformed body it is looked for where it is then, so that its path does not depend on
what is carried. Values of cells are those of a linear fit over the cells of its material that touch its simplex, at the
point, and stay within the range of these cells. A temperature at nodes is interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.evolution.of_material import QUANTITIES
from presswork.fields.instant import Instant
from presswork.fields.table import compute_field
from presswork.mesh.simplices import find_simplices
from presswork.model import FloatArray, IndexArray, Mesh, Model
from presswork.observe.contract import Observed, Observer, Row
from presswork.remesh.carrier import Part

FOLLOWED = (
    "effective_stress",
    "hydrostatic_stress",
    "equivalent_plastic_strain",
    "thickness",
    "temperature",
    *(quantity.name for quantity in QUANTITIES if quantity.shown),
)
"""Fields of cells that the history has of each point, as far as the procedure has them."""


class MarkedPoints(Observer):
    """The marked points of one model on its present mesh."""

    def __init__(self, model: Model) -> None:
        self._points = model.points
        self.nodes: IndexArray = np.zeros((0, 1), dtype=np.intp)
        self.share: FloatArray = np.zeros((0, 1))
        places = np.array([point.place for point in model.points]).reshape(-1, model.mesh.points.shape[1])
        self.find(model.mesh, model.mesh.points, places)

    def find(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> None:
        """Find the points in places (n, d) [mm] on a mesh whose nodes are in positions (n_points, d) [mm]."""
        if self._points:
            self.nodes, self.share, _ = find_simplices(mesh, position, places)

    def go_on(self, mesh: Mesh, parts: Sequence[Part], places: FloatArray) -> None:
        """Find the points in places (n, d) [mm] on another mesh, whose nodes lie where they are now, each in its body.

        parts: what became of each body. In one that keeps its mesh they keep nodes and shares.
        """
        before = self.nodes.copy()
        for number, part in enumerate(parts):
            own = np.isin(before[:, 0], part.old_points)
            if part.surface is None:
                self.nodes[own] = before[own] + (part.new_points.start - part.old_points.start)
            elif own.any():
                body = replace(mesh, blocks=mesh.blocks[number : number + 1])
                self.nodes[own], self.share[own], _ = find_simplices(body, mesh.points, places[own])

    def take_mesh(self, before: FloatArray, mesh: Mesh, position: FloatArray) -> None:
        """Find the points on another mesh of the same material."""
        self.find(mesh, position, self.places(before))

    def places(self, position: FloatArray) -> FloatArray:
        """Return where the points are (n, d) [mm], by the positions of the nodes (n_points, d) [mm]."""
        return np.asarray(np.einsum("pk,pkd->pd", self.share, position[self.nodes]))

    def columns(self, run: Observed) -> list[str]:
        """Return the place of each point and the fields that it has seen."""
        if not self._points:
            return []
        now = run.show()
        axes = "xyz"[: now.model.mesh.points.shape[1]]
        followed = [name for name in FOLLOWED if compute_field(name, now) is not None]
        return [f"{point.name}.{quantity}" for point in self._points for quantity in (*axes, *followed)]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return where the points are, and what they see."""
        return self.measure(run.show()) if self._points else {}

    def measure(self, now: Instant) -> Row:
        """Return the columns at an instant."""
        if not self._points:
            return {}
        mesh: Mesh = now.model.mesh
        dimension = mesh.points.shape[1]
        position = mesh.points + now.displacement[:, :dimension]
        places = self.places(position)
        found = {name: field for name in FOLLOWED if (field := compute_field(name, now)) is not None}
        row: Row = {}
        for point, place, nodes, share in zip(self._points, places, self.nodes, self.share, strict=True):
            row |= {f"{point.name}.{axis}": float(x) for axis, x in zip("xyz", place, strict=False)}
            cells, weight = weigh_cells(mesh, position, nodes, place)
            row |= {f"{point.name}.{name}": take_within(field[cells], weight) for name, field in found.items()}
            if now.temperature is not None:
                row[f"{point.name}.temperature"] = take_within(now.temperature[nodes], share)
        return row

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what holds the points; nothing where there is none."""
        return {"points.nodes": self.nodes, "points.share": self.share} if self._points else {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        if self._points and "points.nodes" not in arrays:
            raise ValueError("the checkpoint holds no marked points: an older program wrote it; start with --overwrite")
        if self._points:
            self.nodes, self.share = arrays["points.nodes"].copy(), arrays["points.share"].copy()


def weigh_cells(
    mesh: Mesh, position: FloatArray, nodes: IndexArray, place: FloatArray
) -> tuple[IndexArray, FloatArray]:
    """Return the cells round a simplex of nodes (k,), and their weights in a linear fit's value at a place (d,).

    They touch the simplex, and have the material of the cell that it belongs to.
    """
    cells, middles, materials, home, first = [], [], [], -1, 0
    for block in mesh.blocks:
        held = np.isin(block.connectivity, nodes)
        own = np.flatnonzero(held.any(axis=1))
        if (held.sum(axis=1) == len(nodes)).any():
            home = block.material
        cells.append(first + own)
        middles.append(position[block.connectivity[own]].mean(axis=1))
        materials.append(np.full(len(own), block.material))
        first += len(block.connectivity)
    alike = np.concatenate(materials) == home
    away = np.concatenate(middles)[alike] - place
    basis = np.column_stack([np.ones(len(away)), away / max(float(np.abs(away).max()), 1e-300)])
    return np.concatenate(cells)[alike], np.asarray(np.linalg.pinv(basis, rcond=1e-6)[0])


def take_within(values: FloatArray, weight: FloatArray) -> float:
    """Return the weighted sum of values (n,), brought into their range: a linear fit overshoots beside a steep change.

    >>> take_within(np.array([80.0, 60.0]), np.array([1.5, -0.5]))
    80.0
    """
    return float(np.clip(weight @ values, values.min(), values.max()))


def find_marked(run: Observed) -> MarkedPoints:
    """Return the marked points of a run."""
    return run.observers.find(MarkedPoints)
