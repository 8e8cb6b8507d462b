# SPDX-License-Identifier: Apache-2.0
"""Bodies that conduct and store heat: one temperature a node, lumped capacity (docs/theory/heat.md)."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.model import CELLS, ELEMENTS, FloatArray, IntArray, Model, Thermal


def sum_at_nodes(nodes: IntArray, values: FloatArray, n_points: int) -> FloatArray:
    """Return the sums of values at their nodes (n_points,)."""
    return np.bincount(nodes.ravel(), values.ravel(), minlength=n_points).astype(np.float64, copy=False)


def measure_ranges(model: Model, temperature: FloatArray) -> FloatArray:
    """Return the lowest and highest temperature of each material's nodes (n_materials, 2) [degrees C].

    temperature: of the nodes, those of the model first.
    """
    least, most = temperature.max(), temperature.min()
    found = np.tile([least, most], (len(model.materials), 1))
    for block in model.mesh.blocks:
        own = temperature[block.connectivity]
        found[block.material] = widen(found[block.material], np.array([own.min(), own.max()]))
    return found


def widen(ranges: FloatArray, others: FloatArray) -> FloatArray:
    """Return the ranges (..., 2) that hold both."""
    return np.stack([np.minimum(ranges[..., 0], others[..., 0]), np.maximum(ranges[..., 1], others[..., 1])], axis=-1)


class Enthalpy:
    """Heat content of a unit of mass by temperature: the integral of the specific heat, and latent heat."""

    def __init__(self, thermal: Thermal) -> None:
        rows, values = thermal.specific_heat.T
        widths = np.diff(rows)
        content = np.concatenate([[0.0], np.cumsum(0.5 * widths * (values[1:] + values[:-1]))])
        slope = np.concatenate([[0.0], np.diff(values) / widths, [0.0]])
        self.pieces: FloatArray = np.column_stack(
            [*(np.insert(v, 0, v[0]) for v in (rows, values)), slope, np.insert(content, 0, 0)]
        )
        """Temperature, specific heat, its slope and heat content (n, 4), as cpp/element/heat_storage.hpp has them."""
        self.latent: tuple[float, float, float] = (thermal.latent_heat, *thermal.transformation)
        """Latent heat [mm2/s2], and from where to where it is taken up [degrees C]."""

    def find(self, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heat content [mm2/s2], zero at the first row of the table, and its derivative [mm2/(s2 K)]."""
        content, specific = _core.find_heat_content(self.pieces, *self.latent, temperature)
        return np.asarray(content), np.asarray(specific)


class PointShapes:
    """Carries quantities between nodes and the integration points of solids by the cells' shape functions.

    A cell with one point distributes its value to the nodes by their shares of its volume: in axisymmetry more to the
    outer ones.
    """

    def __init__(self, model: Model) -> None:
        mesh = model.mesh
        self._n_points = len(mesh.points)
        self._connectivity = [np.ascontiguousarray(block.connectivity, dtype=np.int32) for block in mesh.blocks]
        rows = [ELEMENTS[block.element] for block in mesh.blocks]
        self._shapes = [CELLS[row.cell].rules[row.points].shapes for row in rows]
        self._parts = []
        self.volumes: list[FloatArray] = []
        """Volumes of each block's cells at the start (n_cells,) [mm3]."""
        for row, connectivity in zip(rows, self._connectivity, strict=True):
            axisymmetric = model.analysis == "axisymmetric"
            volume = _core.lump_volumes(
                row.cell, connectivity, mesh.points, axisymmetric=axisymmetric, depth=model.depth
            )
            self.volumes.append(np.sum(volume, axis=1))
            self._parts.append(np.asarray(volume) / self.volumes[-1][:, None])

    def to_points(self, block: int, nodal: FloatArray) -> FloatArray:
        """Return the values of a nodal quantity at a block's points (n_cells, q)."""
        return np.asarray(nodal[self._connectivity[block]] @ self._shapes[block].T)

    def to_nodes(self, block: int, amounts: FloatArray) -> FloatArray:
        """Return what the points of a block (n_cells, q) give to the nodes (n_points,): the sum stays."""
        given = amounts * self._parts[block] if amounts.shape[1] == 1 else amounts @ self._shapes[block]
        return sum_at_nodes(self._connectivity[block], given, self._n_points)


class Conduction:
    """Conducts heat in all cells of a model and stores it at the nodes.

    Raises ValueError for cells that are turned inside out, and for materials without thermal properties.
    """

    def __init__(self, model: Model, couplings: IntArray) -> None:
        mesh = model.mesh
        self.n_points = len(mesh.points)
        self._axisymmetric, self._depth = model.analysis == "axisymmetric", model.depth
        self._cells = [ELEMENTS[b.element].cell for b in mesh.blocks]
        self._connectivity = [np.ascontiguousarray(b.connectivity, dtype=np.int32) for b in mesh.blocks]
        self._thermal: list[Thermal] = []
        for block in mesh.blocks:
            thermal = model.materials[block.material].thermal
            if thermal is None:
                raise ValueError(f"the material {model.materials[block.material].name} has no thermal properties")
            self._thermal.append(thermal)
        self._enthalpy = [Enthalpy(thermal) for thermal in self._thermal]
        self.symmetric = all(len(thermal.conductivity) == 1 for thermal in self._thermal)
        """Whether the derivative of the heat flow is symmetric: conductivities are constant."""
        self.couple(couplings)
        self.mass = self._lump(mesh.points)
        """Mass of each block at the nodes, (n_points,) each [t]."""
        tables = zip(self._cells, self._connectivity, self._thermal, self._enthalpy, self.mass, strict=True)
        bodies = [
            _core.HeatBody(cell, nodes, np.ascontiguousarray(thermal.conductivity), heat.pieces, heat.latent, mass)
            for cell, nodes, thermal, heat, mass in tables
        ]
        self.equation = _core.HeatEquation(bodies, axisymmetric=self._axisymmetric, depth=self._depth)
        """The compiled equation."""

    def couple(self, couplings: IntArray) -> None:
        """Let the matrix hold these pairs of nodes (n, 2) beside those of the cells."""
        self.assembler = _core.ScalarAssembler(self.n_points, self._connectivity, self.symmetric, couplings)

    def _lump(self, points: FloatArray) -> list[FloatArray]:
        masses = []
        for cell, connectivity, thermal in zip(self._cells, self._connectivity, self._thermal, strict=True):
            volume = _core.lump_volumes(cell, connectivity, points, axisymmetric=self._axisymmetric, depth=self._depth)
            masses.append(thermal.density * sum_at_nodes(connectivity, np.asarray(volume), self.n_points))
        return masses

    def content(self, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heat stored at the nodes (n_points,) [N mm] and its derivative [N mm/K]; its zero is arbitrary."""
        content, slope = self.equation.find_content(temperature)
        return np.asarray(content), np.asarray(slope)

    def mean(self, temperature: FloatArray, nodes: slice = slice(None)) -> float:
        """Return the mean temperature of nodes, weighted by mass; temperature: of all or of the first so many nodes."""
        mass = np.sum(self.mass, axis=0)[: len(temperature)][nodes]
        return float(mass @ temperature[nodes] / mass.sum())
