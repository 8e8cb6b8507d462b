# SPDX-License-Identifier: Apache-2.0
"""Tools that conduct heat on meshes of their own: their nodes follow those of the bodies, and move with the tools."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from presswork.body.heat import sum_at_nodes
from presswork.geometry.pose import place_points
from presswork.interaction.heat.forming_instant import Poses
from presswork.model import CellBlock, DieMesh, FloatArray, Heat, IntArray, Material, Mesh, Model


@dataclass(frozen=True)
class Die:
    """One tool with a mesh."""

    name: str
    tool: int
    """Index into Model.plane_tools."""
    mesh: DieMesh
    start: float
    """Temperature at the start [degrees C]."""
    nodes: slice
    """Its nodes among all nodes that conduct heat."""
    profile: IntArray
    """Edges on the profile (n, 2), by the numbers of all nodes."""


class MeshedDies:
    """All tools with a mesh."""

    def __init__(self, model: Model, heat: Heat) -> None:
        self._model = model
        self.dies: list[Die] = []
        first = len(model.mesh.points)
        for t, tool in enumerate(model.tools):
            own = heat.tools.get(tool.name)
            if own is None or own.die is None:
                continue
            nodes = slice(first, first + len(own.die.mesh.points))
            profile = (own.die.profile + first).astype(np.int32)
            self.dies.append(Die(tool.name, t, own.die, own.temperature, nodes, profile))
            first = nodes.stop
        self.n_points = first
        """Nodes of bodies and dies."""
        mask, held = np.zeros(first, dtype=np.uint8), np.zeros(first)
        for die in self.dies:
            mask[die.nodes.start + die.mesh.back] = 1
            held[die.nodes.start + die.mesh.back] = die.mesh.back_temperature
        self.mask, self.held = mask, held
        """Nodes of backs that are held, and their temperatures (n_points,)."""

    def join(self) -> Model:
        """Return the model with the meshes and steels of the dies, in which heat is conducted."""
        model = self._model
        if not self.dies:
            return model
        materials, blocks = list(model.materials), list(model.mesh.blocks)
        for die in self.dies:
            for block in die.mesh.mesh.blocks:
                connectivity = (block.connectivity + die.nodes.start).astype(np.int32)
                blocks.append(CellBlock(block.element, connectivity, len(materials)))
            materials.append(Material(die.name, 0.0, 0.0, None, thermal=die.mesh.thermal))
        points = np.concatenate([model.mesh.points, *(die.mesh.mesh.points for die in self.dies)])
        mesh = Mesh(points, tuple(blocks), {}, {}, model.mesh.boundary_edges)
        return replace(model, mesh=mesh, materials=tuple(materials))

    def place(self, points: FloatArray, poses: Poses) -> FloatArray:
        """Return where the nodes of bodies and dies are (n_points, 2) [mm]; poses: of all tools of the plane."""
        if not self.dies:
            return points
        return np.concatenate([points, *(place_points(die.mesh.mesh.points, poses[die.tool]) for die in self.dies)])

    def at_rest(self) -> FloatArray:
        """Return the temperatures of the dies' nodes at the start, die after die (n,) [degrees C]."""
        parts = [np.full(len(die.mesh.mesh.points), die.start) for die in self.dies]
        return np.concatenate([np.zeros(0), *parts])


def pass_on(pairs: IntArray, area: FloatArray, amount: FloatArray) -> FloatArray:
    """Return what the second nodes of pairs (n, 2) get of amounts at the first (n_points,), by the shared area (n,)."""
    n = len(amount)
    whole = sum_at_nodes(pairs[:, 0], area, n)
    share = amount[pairs[:, 0]] * area / np.maximum(whole[pairs[:, 0]], 1e-300)
    return sum_at_nodes(pairs[:, 1], share, n)
