# SPDX-License-Identifier: Apache-2.0
"""The State on a new mesh, of implicit and of explicit runs: every array as its owner declares it (state.OnNewMesh)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import cast

import numpy as np
import scipy

from presswork.body.solids import Mechanics
from presswork.evolution.of_material import BY_NAME
from presswork.evolution.points import EvolvedArrays
from presswork.explicit.arrays import SolidArrays
from presswork.implicit.epochs import Epoch, new_epoch
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.led import Led
from presswork.interaction.tool_arrays import ContactArrays
from presswork.law.history import EQPS, History
from presswork.mesh.edges import edge_areas
from presswork.mesh.faces import face_areas
from presswork.model import FloatArray, IndexArray, IntArray, Mesh, Model
from presswork.process.mesh_change.carrying_in_space import carry_pressures, hold_on_tools
from presswork.remesh.axes import straighten_axes
from presswork.remesh.carrier import Carrier
from presswork.state import Arrays, CellArrays, OnNewMesh, State

_SURFACE = ("surface", "surface_force")
FindRows = Callable[[Arrays, str], Sequence[IntArray | IndexArray] | None]
"""Finds the nodes that the rows of a surface array stand for, group after group; None: those of the mesh, all."""


@dataclass(frozen=True)
class OnMesh:
    """A State on its mesh."""

    model: Model
    state: State
    position: FloatArray
    """Where the nodes are (n_points, d) [mm]."""
    volumes: Sequence[FloatArray]
    """Volumes of the points of each block (n_cells, p) [mm3]."""
    find_rows: FindRows = lambda _arrays, _name: None

    @classmethod
    def of(cls, run: ImplicitProcedure, state: State | None = None) -> OnMesh:
        """Return the State of an implicit procedure, or one of its mesh, where it is now."""
        now, mesh = state or run.state, run.model.mesh
        position = mesh.points + now.nodes.displacement[:, : mesh.points.shape[1]]
        return cls(run.model, now, position, now.cells.volume, partial(_find_rows, run))

    @cached_property
    def sides(self) -> IntArray:
        """Edges in the plane, faces in space (n, k)."""
        mesh = self.model.mesh
        return mesh.boundary_faces if len(mesh.boundary_faces) else mesh.boundary_edges

    @cached_property
    def areas(self) -> FloatArray:
        """Area of the boundary round each node (n_points,) [mm2]."""
        thickness = None if self.model.analysis == "axisymmetric" else self.model.depth
        sides, is_space = self.sides, len(self.model.mesh.boundary_faces) > 0
        areas = face_areas(self.position, sides) if is_space else edge_areas(self.position, sides, thickness)
        return np.asarray(np.bincount(sides.ravel(), areas.ravel(), minlength=len(self.position)), dtype=float)


def find_undeclared(state: State) -> list[str]:
    """Return the arrays, as owner.name, for which no owner has declared what becomes of them on a new mesh."""
    return [
        name
        for arrays in state
        for name in arrays.to_arrays()
        if name.removeprefix(f"{arrays.owner}.").split(".")[0] not in arrays.on_new_mesh
    ]


def carry_to_mesh(
    before: ImplicitProcedure, mesh: Mesh, carrier: Carrier, *, like: State | None = None
) -> ImplicitProcedure:
    """Return the procedure on a new mesh with the state carried to it, but for peaks. Raises GaveUpError.

    like: of a neighbour of a run: that of the run on the mesh beside, whose nodes on tools count.
    """

    def fill(epoch: Epoch, next_epoch: Epoch) -> None:
        carry_state(OnMesh.of(epoch.run, epoch.state), OnMesh.of(next_epoch.run, next_epoch.state), carrier)
        _complete(epoch, next_epoch, carrier)
        if mesh.points.shape[1] == 3:
            carry_pressures(epoch, next_epoch, carrier)

    after = new_epoch(before, mesh, fill)
    if like is not None:
        for interaction in after.interactions.all:
            if isinstance(interaction, Led):
                interaction.hold_anew(after.state, like)
    carry_surface(OnMesh.of(before), OnMesh.of(after), carrier)
    hold_on_tools(after, carrier)
    return after


def carry_state(before: OnMesh, after: OnMesh, carrier: Carrier) -> None:
    """Fill the State on a new mesh, but for what belongs to its surface, and for peaks."""
    for arrays_n, arrays in _pair(before.state, after.state):
        for name, becomes in arrays.on_new_mesh.items():
            given, rest = getattr(arrays_n, name), getattr(arrays, name)
            if becomes.kind == "motion":
                setattr(arrays, name, carrier.motion(given))
            elif becomes.kind == "node":
                setattr(arrays, name, carrier.nodes(given))
            elif becomes.kind == "place":
                setattr(arrays, name, np.where(carrier.is_new()[:, None], rest, carrier.motion(given)))
            elif becomes.kind == "point":
                found = (
                    {key: carrier.points(given[key], rest[key]) for key in rest}
                    if isinstance(rest, dict)
                    else carrier.points(given, rest)
                )
                setattr(arrays, name, found)
            elif becomes.kind == "cell":
                setattr(arrays, name, carrier.cells(given, rest))
            elif becomes.kind == "share":
                setattr(arrays, name, _carry_shares(given, rest, before.volumes, after.volumes, carrier))
        if isinstance(arrays, CellArrays):
            _straighten(arrays.kept, arrays.history, carrier)
        elif isinstance(arrays, SolidArrays):
            _straighten(arrays.kept, arrays.points, carrier)


def _carry_shares(
    given: Sequence[FloatArray],
    rest: Sequence[FloatArray],
    volumes_n: Sequence[FloatArray],
    volumes: Sequence[FloatArray],
    carrier: Carrier,
) -> list[FloatArray]:
    """Return what cells have a share of (n_cells, m), in proportion to their volumes, with the sum of each block."""
    per_volume = [(of / volume.sum(axis=1)[:, None])[:, None] for of, volume in zip(given, volumes_n, strict=True)]
    carried = carrier.points(per_volume, [of[:, None] for of in rest])
    found = [of.copy() for of in given]
    for part in carrier.parts:
        if part.surface is not None:
            shares = carried[part.block][:, 0] * volumes[part.block].sum(axis=1)[:, None]
            total, sums = given[part.block].sum(axis=0), shares.sum(axis=0)
            found[part.block] = shares * total / np.where(sums == 0.0, 1.0, sums)
    return found


def _straighten(kept: Sequence[History], values: Sequence[FloatArray], carrier: Carrier) -> None:
    """Let the axes of laws that were fitted one value at a time be axes again, in place."""
    for part in carrier.parts:
        for axes in kept[part.block].axes if part.surface is not None else ():
            own = values[part.block]
            own[..., axes] = straighten_axes(own[..., axes])


def _complete(before: Epoch, after: Epoch, carrier: Carrier) -> None:
    """Bring what was fitted back to what laws can have, and keep the heat that is stored."""
    after.run.evolution.clip(after.state)
    _return_to_yield(after, {part.block for part in carrier.parts if part.surface is not None})
    if after.run.heat is not None and before.run.heat is not None:
        stored = before.run.heat.forming.stored_in_bodies(before.state[HeatArrays])
        after.run.heat.forming.keep_stored(after.state[HeatArrays], stored, carrier.is_new())
        after.run.heat.spread(after.state)


def carry_surface(before: OnMesh, after: OnMesh, carrier: Carrier) -> None:
    """Carry along the boundary what belongs to it; forces go per area, and only to nodes that tools hold."""
    for arrays_n, arrays in _pair(before.state, after.state):
        for name, becomes in arrays.on_new_mesh.items():
            if becomes.kind not in _SURFACE:
                continue
            values_n, values = getattr(arrays_n, name), getattr(arrays, name)
            rows_n, rows = (each.find_rows(own, name) for each, own in ((before, arrays_n), (after, arrays)))
            given, rest = (_split_groups(of, becomes, r) for of, r in ((values_n, rows_n), (values, rows)))
            found = []
            for group, (own, at_rest) in enumerate(zip(given, rest, strict=True)):
                nodes_n, nodes = (None if r is None else r[group] for r in (rows_n, rows))
                found.append(_carry_group((before, own, nodes_n), (after, at_rest, nodes), carrier, becomes.kind))
            joined = (
                found if isinstance(values, list) else np.concatenate(found or [np.moveaxis(values, becomes.axis, 0)])
            )
            if not isinstance(values, list):
                joined = np.ascontiguousarray(np.moveaxis(cast(FloatArray, joined), 0, becomes.axis))
            setattr(arrays, name, joined)
    if ContactArrays in after.state:
        contact = after.state[ContactArrays]
        contact.drag = np.where((contact.status > 0).any(axis=0), contact.drag, 0.0)


_Group = tuple[OnMesh, FloatArray, IntArray | IndexArray | None]
"""A mesh, values, and the nodes that these are of; None: of all."""


def _split_groups(
    values: FloatArray | list[FloatArray], becomes: OnNewMesh, rows: Sequence[IntArray | IndexArray] | None
) -> list[FloatArray]:
    """Return the values of each group of nodes, which come first in them."""
    if isinstance(values, list):
        return values
    moved = np.moveaxis(values, becomes.axis, 0)
    if rows is None:
        return [moved]
    return np.split(moved, np.cumsum([len(nodes) for nodes in rows])[:-1]) if rows else []


def _carry_group(old: _Group, new: _Group, carrier: Carrier, kind: str) -> FloatArray:
    """Return the values of a group of nodes on the new mesh."""
    (before, given, nodes_n), (after, rest, nodes) = old, new
    everywhere = spread_over_nodes(before, given, nodes_n)
    at_rest = spread_over_nodes(after, rest, nodes)
    if nodes_n is not None and nodes is not None and is_other_body(before.model, nodes_n, after.model, nodes):
        copy_to_facing(everywhere, nodes_n, before.position, before.sides)
    own = slice(None) if nodes is None else nodes
    if kind == "surface":
        return carrier.surface(everywhere, at_rest)[own]
    many = (-1, *(1,) * (given.ndim - 1))  # an area for all that stands at a node
    per_area = carrier.surface(everywhere / np.maximum(before.areas, 1e-300).reshape(many), at_rest)
    return np.asarray(per_area[own] * after.areas[own].reshape(many))


def spread_over_nodes(on: OnMesh, values: FloatArray, nodes: IntArray | IndexArray | None) -> FloatArray:
    """Return values of nodes (n, ...) at all nodes of a mesh, zero at others."""
    everywhere = np.zeros((len(on.position), *values.shape[1:]))
    everywhere[slice(None) if nodes is None else nodes] = values
    return everywhere


def carry_peaks(before: OnMesh, after: OnMesh, carrier: Carrier) -> None:
    """Give back the peaks that carry_state has flattened, where the largest value decides.

    These are the equivalent plastic strain, which no point of the material can lose, and quantities of evolution laws.
    """
    for (name, given), (_, carried) in zip(_list_peaks(before.state), _list_peaks(after.state), strict=True):
        for own, found in zip(carried, carrier.peaks(name, given, carried, after.volumes), strict=True):
            own[...] = found


def _list_peaks(state: State) -> Iterator[tuple[str, list[FloatArray]]]:
    """Yield views of the fields at points whose largest value decides, by name and block."""
    quantities: list[Mapping[str, list[FloatArray]]] = []
    if CellArrays in state:
        yield EQPS, state.cells.eqps
    if SolidArrays in state:
        solids = state[SolidArrays]
        yield EQPS, [solids.find_kept(block, EQPS) for block in range(len(solids.points))]
        quantities.append(solids.damage)
    if EvolvedArrays in state:
        quantities.append(state[EvolvedArrays].values)
    for each in quantities:
        yield from ((name, of) for name, of in each.items() if BY_NAME[name].peak_counts)


def _pair(before: State, after: State) -> Iterator[tuple[Arrays, Arrays]]:
    """Yield the arrays of every owner on the old and on the new mesh."""
    for arrays in after:
        yield before[type(arrays)], arrays


def _find_rows(run: ImplicitProcedure, arrays: Arrays, _name: str) -> list[IntArray] | None:
    """Return the nodes that the rows of an interaction's surface arrays stand for, group after group."""
    for interaction in run.interactions.all:
        if any(isinstance(arrays, type(own)) for own in interaction.at_rest()):
            return interaction.surface_nodes()
    return None


def is_other_body(before: Model, nodes_n: IntArray | IndexArray, after: Model, nodes: IntArray | IndexArray) -> bool:
    """Return whether a group of nodes belongs to another body now: the slave of a contact has been chosen anew."""
    if len(before.bodies) < 2:
        return False
    places = [
        {i for i, body in enumerate(model.bodies) if np.isin(own, body.points).any()}
        for model, own in ((before, nodes_n), (after, nodes))
    ]
    return len(places[0]) == len(places[1]) == 1 and places[0] != places[1]


def copy_to_facing(values: FloatArray, nodes: IndexArray | IntArray, position: FloatArray, sides: IntArray) -> None:
    """Give what stands at nodes of one surface to the nodes of others that face it, in place.

    Vectors (n_points, 3) turn round: what one body feels the other one gives. position: of all nodes (n_points, d)
    [mm]; sides: of the whole boundary (n, k).
    """
    dimension = position.shape[1]
    near = float(np.linalg.norm(position[np.roll(sides, -1, axis=1)] - position[sides], axis=2).max())
    others, tree = np.setdiff1d(sides, nodes), scipy.spatial.cKDTree(position[nodes])
    distance, place = tree.query(position[others], k=dimension, distance_upper_bound=near)
    faces = np.isfinite(distance).all(axis=1)
    share = 1.0 / (distance[faces] + 1e-9 * near)
    share /= share.sum(axis=1, keepdims=True)
    sign = -1.0 if values.ndim > 1 else 1.0
    values[others[faces]] = sign * np.einsum("nk,nk...->n...", share, values[nodes[place[faces]]])


def _return_to_yield(after: Epoch, blocks: Iterable[int]) -> None:
    """Scale deviators beyond the flow stress to it in blocks of cells, of laws with isotropic hardening alone."""
    mechanics, state = after.run.mechanics, after.state
    assert isinstance(mechanics, Mechanics)
    for number in sorted(blocks):
        stress = state.cells.stress[number]
        if state.cells.kept[number].size > 0:
            continue
        flow = mechanics.flow_stress(number, state)
        mean = stress[..., :3].mean(axis=-1)
        deviator = stress.copy()
        deviator[..., :3] -= mean[..., None]
        effective = np.sqrt(1.5 * ((deviator[..., :3] ** 2).sum(axis=-1) + 2.0 * (deviator[..., 3:] ** 2).sum(axis=-1)))
        factor = np.minimum(1.0, flow / np.maximum(effective, 1e-300))
        stress[...] = deviator * factor[..., None]
        stress[..., :3] += mean[..., None]
