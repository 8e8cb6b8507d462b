# SPDX-License-Identifier: Apache-2.0
"""Applied loads: forces at nodes and on edges, follower pressures and their stiffness (K_t of the thesis)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.supports import Supports
from presswork.mesh.edges import GAUSS_3, edge_areas, edge_shape_functions
from presswork.mesh.faces import face_areas, press_faces
from presswork.model import FloatArray, IntArray, Model, Stage
from presswork.outcome import Step
from presswork.state import RUN, SURFACE_FORCE, Arrays, OnNewMesh, State


@dataclass
class LoadArrays(Arrays):
    """Values from which the loads of a stage go on."""

    owner = "loads"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"released": SURFACE_FORCE, "shares": RUN, "fraction": RUN}
    released: FloatArray
    """What supports and prescribed displacements held that the stage leaves free (n_points, 2 | 3 | 6) [N, N mm]; it
    goes to zero over the stage."""
    shares: FloatArray
    """What acts of the loads of each stage when the stage begins (n_stages,)."""
    fraction: float = 0.0
    """Part of the stage that is done."""

    @classmethod
    def at_rest(cls, model: Model) -> LoadArrays:
        """Return the arrays of a workpiece on which nothing acts."""
        freedoms = 6 if model.analysis == "shell" else model.dimension
        return cls(np.zeros((len(model.mesh.points), freedoms)), np.zeros(len(model.stages)))

    def shares_at(self, stage: int, fraction: float) -> FloatArray:
        """Return what acts of the loads of each stage at a fraction of this one (n_stages,).

        Its own loads come linearly, those of the stages before go linearly. So a load goes linearly from its value at
        the beginning of the stage to that given.
        """
        shares = (1.0 - fraction) * self.shares
        shares[stage] += fraction
        return shares

    def released_at(self, fraction: float) -> FloatArray:
        """Return what is left at a fraction of the stage of what it has released (n_points, 2 | 3 | 6) [N, N mm]."""
        return (1.0 - fraction) * self.released


def end_stage(model: Model, supports: Supports, state: State, next_stage: int) -> None:
    """Keep what acts on a converged state, and what holds it where the next stage holds nothing.

    What tools, beads and other bodies bear they go on bearing.
    """
    loads = state[LoadArrays]
    held = state.nodes.reaction[:, : loads.released.shape[1]]
    held = held - supports.free_part(next_stage - 1, held)  # tools hold others, and a little is out of balance
    left = held + loads.released_at(loads.fraction)
    loads.released = supports.free_part(next_stage, left)
    loads.shares = loads.shares_at(next_stage - 1, loads.fraction)
    loads.fraction = 0.0


class Loads(Interaction):
    """The loads of a model of solids: forces, edge forces, pressures that follow the surface."""

    is_driving = True

    def __init__(self, model: Model, supports: Supports) -> None:
        self._model = model
        self._supports = supports

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return no loads."""
        return (LoadArrays.at_rest(self._model),)

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Keep how far the stage has gone."""
        trial[LoadArrays].fraction = step.fraction

    def end_stage(self, state: State, next_stage: int) -> None:
        """Keep from where the loads of the next stage go on."""
        end_stage(self._model, self._supports, state, next_stage)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        """Return the loads at a guess."""
        return self.at(state_n, guess.increment, guess.step.stage, guess.step.fraction)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep the loads of a converged state."""
        trial.nodes.external_force = np.zeros_like(trial.nodes.displacement)
        trial.nodes.external_force[:, : own.force.shape[1]] = own.force

    def at(self, state_n: State, increment: FloatArray, stage: int, fraction: float) -> Forces:
        """Return the loads at a fraction of a stage, `increment` (n_points, 2) after state_n."""
        points, settings = self._model.mesh.points, self._model.solver
        if not settings.is_small:
            points = points + (state_n.nodes.moved + increment[:, :3])
        loads = state_n[LoadArrays]
        found = evaluate_loads(self._model, points, loads.shares_at(stage, fraction))
        force = found.force + loads.released_at(fraction)
        if settings.is_small or not settings.pressure_stiffness:
            return Forces(force, found.pairs[:0], found.blocks[:0])
        return Forces(force, found.pairs, found.blocks)


def evaluate_loads(model: Model, points: FloatArray, shares: Sequence[float] | FloatArray) -> Forces:
    """Return the loads where so much of those of each stage acts (n_stages,).

    points: on which pressures act (n_points, d): the deformed ones, with small displacements the undeformed ones.
    """
    d = points.shape[1]
    force = np.zeros_like(points)
    pairs, blocks = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, d, d))]
    for stage, share in zip(model.stages, shares, strict=True):
        if share == 0.0:
            continue
        _add_dead_loads(model, stage, share, force)
        for pressure in stage.pressures:
            edges = model.mesh.edge_sets[pressure.edge_set]
            edge_pairs, edge_blocks = _add_pressure(model, points, edges, share * pressure.value, force)
            pairs.append(edge_pairs)
            blocks.append(edge_blocks)
        for face_pressure in stage.face_pressures:
            faces = model.mesh.face_sets[face_pressure.face_set]
            face_force, face_blocks = press_faces(points, faces, share * face_pressure.value)
            np.add.at(force, faces, face_force)
            pairs.append(pair_nodes(faces))
            blocks.append(face_blocks.reshape(-1, d, d))
    return Forces(force, np.concatenate(pairs), np.concatenate(blocks))


def _add_dead_loads(model: Model, stage: Stage, share: float, force: FloatArray) -> None:
    """Add a share of the loads of a stage that keep their direction."""
    for load in stage.forces:
        nodes = model.mesh.node_sets[load.node_set]
        force[nodes] += share * np.asarray(load.force) / len(nodes)
    thickness = None if model.analysis == "axisymmetric" else model.depth
    for edge_load in stage.edge_forces:
        edges = model.mesh.edge_sets[edge_load.edge_set]
        areas = edge_areas(model.mesh.points, edges, thickness)
        if edge_load.area is not None:
            areas = areas * (edge_load.area / float(areas.sum()))
        np.add.at(force, edges, share * (areas[..., None] * np.asarray(edge_load.force)))
    for face_load in stage.face_forces:
        faces = model.mesh.face_sets[face_load.face_set]
        areas = face_areas(model.mesh.points, faces)[..., None] * np.asarray(face_load.force)
        np.add.at(force, faces, share * areas)


def _add_pressure(
    model: Model, points: FloatArray, edges: IntArray, pressure: float, force: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Add -p n over the edges to force; return d(-force)/d(position) as node pairs and blocks."""
    axisymmetric = model.analysis == "axisymmetric"
    n = edges.shape[1]
    x = points[edges]
    edge_force = np.zeros(x.shape)
    stiffness = np.zeros((len(edges), n, n, 2, 2))
    for s, weight in GAUSS_3:
        N, dN = edge_shape_functions(n, s)
        tangent = np.einsum("a,eai->ei", dN, x)
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)  # outwards: the body is on the left
        thickness = 2 * np.pi * (x[:, :, 0] @ N) if axisymmetric else np.full(len(edges), model.depth)
        edge_force -= pressure * weight * np.einsum("a,e,ei->eai", N, thickness, normal)
        quarter = np.array([[0.0, 1.0], [-1.0, 0.0]])
        stiffness += pressure * weight * np.einsum("a,b,e,ij->eabij", N, dN, thickness, quarter)
        if axisymmetric:
            stiffness[..., 0] += pressure * weight * 2 * np.pi * np.einsum("a,b,ei->eabi", N, N, normal)
    np.add.at(force, edges, edge_force)
    return pair_nodes(edges), stiffness.reshape(-1, 2, 2)


def pair_nodes(sides: IntArray) -> IntArray:
    """Return the node pairs (n k^2, 2) of edges or faces (n, k), the second node fastest."""
    k = sides.shape[1]
    rows, columns = np.repeat(sides, k, axis=1), np.tile(sides, (1, k))
    return np.ascontiguousarray(np.stack([rows, columns], axis=-1).reshape(-1, 2).astype(np.int32))
