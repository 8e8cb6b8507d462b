# SPDX-License-Identifier: Apache-2.0
"""Applied loads: forces at nodes and on edges, follower pressures and their stiffness (K_t of the thesis)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.supports import Supports
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.edges import GAUSS_3, edge_areas, edge_shape_functions
from presswork.mesh.faces import face_areas, press_faces
from presswork.model import FloatArray, IntArray, Model
from presswork.state import SURFACE_FORCE, Arrays, OnNewMesh, State


@dataclass
class FadingLoads(Arrays):
    """What is left of the stage before, of a model in space."""

    owner = "fading_loads"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"force": SURFACE_FORCE}
    force: FloatArray
    """Forces left from the previous stage; they fade to zero over this stage (n_points, 3) [N]."""


class Loads(Interaction):
    """The loads of a model of solids: forces, edge forces, pressures that follow the surface.

    In space what a stage has held and the next one does not fades over that one.
    """

    is_driving = True

    def __init__(self, model: Model, supports: Supports) -> None:
        self._model = model
        self._supports = supports
        self._fades = model.dimension == 3

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return no forces left."""
        return (FadingLoads(np.zeros(self._model.mesh.points.shape)),) if self._fades else ()

    def end_stage(self, state: State, next_stage: int, internal: Callable[[], FloatArray]) -> None:
        """Keep what holds a converged state in balance where the next stage holds nothing."""
        if not self._fades:
            return
        force = internal()[:, :3]
        if SpaceToolArrays in state:  # tools stay where they are
            force = force - state[SpaceToolArrays].force.sum(axis=0)
        state[FadingLoads].force = self._supports.free_part(next_stage, force)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        """Return the loads at a guess."""
        return self.at(state_n, guess.increment, guess.step.stage, guess.step.fraction)

    def settle(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep the loads of a converged state."""
        trial.nodes.external_force = np.zeros_like(trial.nodes.displacement)
        trial.nodes.external_force[:, : own.force.shape[1]] = own.force

    def at(self, state_n: State, increment: FloatArray, stage: int, fraction: float) -> Forces:
        """Return the loads at a fraction of a stage, `increment` (n_points, 2) after state_n."""
        points, settings = self._model.mesh.points, self._model.solver
        if not settings.is_small:
            points = points + (state_n.nodes.moved + increment[:, :3])
        found = evaluate_loads(self._model, points, stage, fraction)
        force = found.force
        if self._fades:
            force = force + (1.0 - fraction) * state_n[FadingLoads].force
        if settings.is_small or not settings.pressure_stiffness:
            return Forces(force, found.pairs[:0], found.blocks[:0])
        return Forces(force, found.pairs, found.blocks)


def evaluate_loads(model: Model, points: FloatArray, stage: int, fraction: float) -> Forces:
    """Return the loads at a fraction of a stage; loads grow linearly and end with their stage.

    points: on which pressures act (n_points, d): the deformed ones, with small displacements the undeformed ones.
    """
    d = points.shape[1]
    force = np.zeros_like(points)
    pairs, blocks = [np.zeros((0, 2), dtype=np.int32)], [np.zeros((0, d, d))]
    for load in model.stages[stage].forces:
        nodes = model.mesh.node_sets[load.node_set]
        force[nodes] += fraction * np.asarray(load.force) / len(nodes)
    thickness = None if model.analysis == "axisymmetric" else model.depth
    for edge_load in model.stages[stage].edge_forces:
        edges = model.mesh.edge_sets[edge_load.edge_set]
        areas = edge_areas(model.mesh.points, edges, thickness)
        if edge_load.area is not None:
            areas = areas * (edge_load.area / float(areas.sum()))
        share = areas[..., None] * np.asarray(edge_load.force)
        np.add.at(force, edges, fraction * share)
    for pressure in model.stages[stage].pressures:
        edges = model.mesh.edge_sets[pressure.edge_set]
        edge_pairs, edge_blocks = _add_pressure(model, points, edges, fraction * pressure.value, force)
        pairs.append(edge_pairs)
        blocks.append(edge_blocks)
    for face_load in model.stages[stage].face_forces:
        faces = model.mesh.face_sets[face_load.face_set]
        areas = face_areas(model.mesh.points, faces)[..., None] * np.asarray(face_load.force)
        np.add.at(force, faces, fraction * areas)
    for face_pressure in model.stages[stage].face_pressures:
        faces = model.mesh.face_sets[face_pressure.face_set]
        face_force, face_blocks = press_faces(points, faces, fraction * face_pressure.value)
        np.add.at(force, faces, face_force)
        pairs.append(pair_nodes(faces))
        blocks.append(face_blocks.reshape(-1, d, d))
    return Forces(force, np.concatenate(pairs), np.concatenate(blocks))


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
