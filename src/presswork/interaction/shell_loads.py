# SPDX-License-Identifier: Apache-2.0
"""Loads on shells: forces and moments at nodes and edges, body forces, follower pressures with their stiffness."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from presswork import _core
from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import measure_shells
from presswork.interaction.cell_pressure import make_skew, press_cells
from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.loads import LoadArrays, end_stage
from presswork.interaction.supports import Supports
from presswork.mesh.directors import Directors
from presswork.mesh.edges import GAUSS_3, edge_shape_functions
from presswork.model import FloatArray, IndexArray, Model, ShellPressure
from presswork.outcome import Step
from presswork.state import Arrays, State


class ShellLoads(Interaction):
    """The loads of one model of shells; what does not change with the deformation is kept."""

    is_driving = True

    def __init__(self, model: Model, directors: Directors, supports: Supports) -> None:
        self._model = model
        self._directors = directors
        self._supports = supports
        self._shapes = [_core.shell_shape(b.element) for b in model.mesh.blocks]
        self.nodal_volume = np.zeros(len(model.mesh.points))
        for block in model.mesh.blocks:
            N, area = measure_shells(model.mesh.points, block)
            np.add.at(self.nodal_volume, block.connectivity, block.thickness[:, None] * area @ N)
        self._dead = [self._dead_loads(s) for s in range(len(model.stages))]

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return no loads."""
        return (LoadArrays.at_rest(self._model),)

    def _dead_loads(self, stage: int) -> FloatArray:
        """Return the forces and moments of a whole stage that keep their direction (n_points, 6)."""
        mesh = self._model.mesh
        force = np.zeros((len(mesh.points), 6))
        for load in self._model.stages[stage].forces:
            nodes = mesh.node_sets[load.node_set]
            force[nodes, : len(load.force)] += np.asarray(load.force) / len(nodes)
        for edge_load in self._model.stages[stage].edge_forces:
            edges = mesh.edge_sets[edge_load.edge_set]
            x, n = mesh.points[edges], edges.shape[1]
            for s, weight in GAUSS_3:
                N, dN = edge_shape_functions(n, s)
                length = np.linalg.norm(np.einsum("a,eai->ei", dN, x), axis=1) * weight
                share = np.einsum("e,a,i->eai", length, N, np.asarray(edge_load.force))
                np.add.at(force[:, : len(edge_load.force)], edges, share)
        for body in self._model.stages[stage].body_forces:
            force[:, :3] += self.nodal_volume[:, None] * np.asarray(body.force)
        return force

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        """Return the loads at a guess."""
        return self.at(state_n, guess.increment, guess.step.stage, guess.step.fraction)

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Keep how far the stage has gone."""
        trial[LoadArrays].fraction = step.fraction

    def end_stage(self, state: State, next_stage: int) -> None:
        """Keep from where the loads of the next stage go on."""
        end_stage(self._model, self._supports, state, next_stage)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep the loads of a converged state."""
        trial.nodes.external_force = own.force

    def at(self, state_n: State, increment: FloatArray, stage: int, fraction: float) -> Forces:
        """Return the loads at a fraction of a stage, `increment` (n_points, 6) after state_n.

        A moment does work on the spin of its node: on the rotation vector of the increment it acts through the
        rotation's tangent. What of it lies along the director of a smooth node does nothing.
        """
        loads = state_n[LoadArrays]
        shares = loads.shares_at(stage, fraction)
        force = loads.released_at(fraction)
        for share, dead in zip(shares, self._dead, strict=True):
            force += share * dead
        is_small = self._model.solver.is_small
        if is_small:
            increment = np.zeros_like(increment)
        moment = force[:, 3:]
        loaded = np.flatnonzero(moment.any(axis=1))
        if len(loaded):
            force[loaded, 3:] = self._on_rotation_vector(loaded, moment[loaded], state_n, increment[loaded, 3:])
        pairs, blocks = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, 6, 6))]
        points = self._model.mesh.points
        if not is_small:
            points = points + state_n.nodes.displacement[:, :3] + increment[:, :3]
        for share, pressure in self._pressures(shares):
            inside = np.zeros(len(points), dtype=bool)
            inside[self._model.mesh.node_sets[pressure.node_set]] = True
            for block, shape in zip(self._model.mesh.blocks, self._shapes, strict=True):
                cells = block.connectivity[inside[block.connectivity].all(axis=1)]
                more, stiffness = press_cells(points, cells, shape, share * pressure.value, force)
                if not is_small and self._model.solver.pressure_stiffness:
                    pairs.append(more)
                    blocks.append(stiffness)
        return Forces(force, np.concatenate(pairs), np.concatenate(blocks))

    def _pressures(self, shares: FloatArray) -> Iterator[tuple[float, ShellPressure]]:
        """Yield the pressures of all stages that act, and how much of each (n_stages,)."""
        for share, stage in zip(shares, self._model.stages, strict=True):
            if share != 0.0:
                yield from ((float(share), pressure) for pressure in stage.shell_pressures)

    def _on_rotation_vector(
        self, nodes: IndexArray, moment: FloatArray, state_n: State, theta: FloatArray
    ) -> FloatArray:
        """Return the part of moments that works on the increment's rotation vectors (n, 3)."""
        square = (theta**2).sum(axis=1)[:, None, None]
        angle = np.sqrt(square)
        small = square < 1e-8
        safe = np.where(small, 1.0, square)
        b = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
        c = np.where(small, 1 / 6 - square / 120, (1.0 - np.sinc(angle / np.pi)) / safe)
        skew = make_skew(theta)
        tangent = np.eye(3) + b * skew + c * skew @ skew
        rotation = np.eye(3) + np.sinc(angle / np.pi) * skew + b * skew @ skew
        which = np.full(len(self._directors.smooth), -1)
        which[self._directors.node] = np.arange(len(self._directors.node))
        director = np.einsum("nij,nj->ni", rotation, state_n[ShellArrays].director[which[nodes]])
        along = (director * moment).sum(axis=1, keepdims=True) * self._directors.smooth[nodes, None]
        result: FloatArray = np.einsum("nji,nj->ni", tangent, moment - along * director)
        return result
