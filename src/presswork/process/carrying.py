# SPDX-License-Identifier: Apache-2.0
"""The State on a new mesh: every array of every owner as its owner declares it (state.OnNewMesh)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy

from presswork.body.solids import Mechanics
from presswork.evolution.points import EvolvedArrays
from presswork.implicit.epochs import Epoch, new_epoch
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays
from presswork.mesh.edges import edge_areas
from presswork.mesh.faces import face_areas
from presswork.model import FloatArray, IndexArray, IntArray, Mesh
from presswork.process.carrying_in_space import carry_pressures, hold_on_tools
from presswork.remesh.axes import straighten_axes
from presswork.remesh.carrier import Carrier
from presswork.state import Arrays, State

_SURFACE = ("surface", "surface_force")


def find_undeclared(state: State) -> list[str]:
    """Return the arrays, as owner.name, of which nobody has said what becomes of them on a new mesh."""
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
        carry_state(epoch, next_epoch, carrier)
        if mesh.points.shape[1] == 3:
            carry_pressures(epoch, next_epoch, carrier)

    after = new_epoch(before, mesh, fill)
    if like is not None:
        for interaction in after.interactions.all:
            interaction.hold_anew(after.state, like)
    carry_surface(before, after, carrier)
    hold_on_tools(after, carrier)
    return after


def carry_state(before: Epoch, after: Epoch, carrier: Carrier) -> None:
    """Fill the State on a new mesh, contact apart: carry_surface does that once nodes on tools are known."""
    for arrays_n, arrays in _pair(before.state, after.state):
        for name, becomes in arrays.on_new_mesh.items():
            given, rest = getattr(arrays_n, name), getattr(arrays, name)
            if becomes.kind == "motion":
                setattr(arrays, name, carrier.motion(given))
            elif becomes.kind == "node":
                setattr(arrays, name, carrier.nodes(given))
            elif becomes.kind == "point":
                found = (
                    {key: carrier.points(given[key], rest[key]) for key in rest}
                    if isinstance(rest, dict)
                    else carrier.points(given, rest)
                )
                setattr(arrays, name, found)
            elif becomes.kind == "cell":
                setattr(arrays, name, carrier.cells(given, rest))
    after.run.evolution.clip(after.state)
    _return_to_law(after, {part.block for part in carrier.parts if part.surface is not None})
    if after.run.heat is not None and before.run.heat is not None:
        stored = before.run.heat.forming.stored_in_bodies(before.state[HeatArrays])
        after.run.heat.forming.keep_stored(after.state[HeatArrays], stored, carrier.is_new())
        after.run.heat.spread(after.state)


def carry_surface(before: ImplicitProcedure, after: ImplicitProcedure, carrier: Carrier) -> None:
    """Carry along the boundary what belongs to it; forces go per area, and only to nodes that tools hold."""
    areas_n, areas = _boundary_areas(before), _boundary_areas(after)
    for arrays_n, arrays in _pair(before.state, after.state):
        if all(becomes.kind not in _SURFACE for becomes in arrays.on_new_mesh.values()):
            continue
        rows_n, rows = (_find_rows(run, arrays) for run in (before, after))
        for name, becomes in arrays.on_new_mesh.items():
            if becomes.kind not in _SURFACE:
                continue
            given, rest = (np.moveaxis(getattr(a, name), becomes.axis, 0) for a in (arrays_n, arrays))
            found = rest.copy()
            begin_n = begin = 0
            for nodes_n, nodes in zip(rows_n, rows, strict=True):
                own_n, own = slice(begin_n, begin_n + len(nodes_n)), slice(begin, begin + len(nodes))
                begin_n, begin = own_n.stop, own.stop
                everywhere = np.zeros((len(areas_n), *given.shape[1:]))
                at_rest = np.zeros((len(areas), *given.shape[1:]))
                at_rest[nodes] = rest[own]
                everywhere[nodes_n] = given[own_n]
                if _is_other_body(before, nodes_n, nodes, after):
                    mesh, dimension = before.model.mesh, before.model.dimension
                    position = mesh.points + before.state.nodes.displacement[:, :dimension]
                    sides = mesh.boundary_faces if dimension == 3 else mesh.boundary_edges
                    give_to_facing(everywhere, nodes_n, position, sides)
                if becomes.kind == "surface":
                    found[own] = carrier.surface(everywhere, at_rest)[nodes]
                    continue
                many = (-1, *(1,) * (given.ndim - 1))  # an area for all that stands at a node
                per_area = carrier.surface(everywhere / np.maximum(areas_n, 1e-300).reshape(many), at_rest)
                found[own] = per_area[nodes] * areas[nodes].reshape(many)
            setattr(arrays, name, np.ascontiguousarray(np.moveaxis(found, 0, becomes.axis)))
    if ContactArrays in after.state:
        contact = after.state[ContactArrays]
        contact.drag = np.where((contact.status > 0).any(axis=0), contact.drag, 0.0)


def carry_peaks(before: ImplicitProcedure, after: ImplicitProcedure, carrier: Carrier) -> None:
    """Give back the peaks that carry_state has flattened, where the largest value decides.

    These are the equivalent plastic strain, which no point of the material can lose, and quantities of evolution laws.
    """
    cells_n, cells = before.state.cells, after.state.cells
    cells.eqps = carrier.peaks("eqps", cells_n.eqps, cells.eqps, cells.volume)
    for name in after.evolution.names_with_peaks:
        values_n, values = (run.state[EvolvedArrays].values for run in (before, after))
        values[name] = carrier.peaks(name, values_n[name], values[name], cells.volume)


def _pair(before: State, after: State) -> Iterator[tuple[Arrays, Arrays]]:
    """Yield the arrays of every owner on the old and on the new mesh."""
    for arrays in after:
        yield before[type(arrays)], arrays


def _find_rows(run: ImplicitProcedure, arrays: Arrays) -> list[IntArray]:
    """Return the nodes that the rows of an owner's surface arrays stand for, group after group."""
    for interaction in run.interactions.all:
        if any(isinstance(arrays, type(own)) for own in interaction.at_rest()):
            groups = interaction.surface_nodes()
            if groups is not None:
                return groups
    return [np.arange(len(run.model.mesh.points), dtype=np.int32)]


def _is_other_body(before: ImplicitProcedure, nodes_n: IntArray, nodes: IntArray, after: ImplicitProcedure) -> bool:
    """Say whether a group of rows stands for another body now: the slave of a contact has been chosen anew."""
    if len(before.model.bodies) < 2:
        return False
    places = [
        {i for i, body in enumerate(run.model.bodies) if np.isin(own, body.points).any()}
        for run, own in ((before, nodes_n), (after, nodes))
    ]
    return len(places[0]) == len(places[1]) == 1 and places[0] != places[1]


def give_to_facing(values: FloatArray, nodes: IndexArray | IntArray, position: FloatArray, sides: IntArray) -> None:
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


def _return_to_law(after: Epoch, blocks: set[int]) -> None:
    """Bring what was fitted in blocks of cells back to what a law can have.

    Deviators beyond the flow stress are scaled to it, of laws with isotropic hardening alone. The axes of other laws,
    their last values, become axes again.
    """
    mechanics, state, model = after.run.mechanics, after.state, after.run.model
    assert isinstance(mechanics, Mechanics)
    for number in sorted(blocks):
        block = model.mesh.blocks[number]
        history, stress = state.cells.history[number], state.cells.stress[number]
        if history.shape[2] > 0:
            if model.materials[block.material].umat is None:
                axes = history[..., -6 if model.dimension == 3 else -2 :]
                axes[...] = straighten_axes(axes)
            continue
        flow = mechanics.flow_stress(number, state)
        mean = stress[..., :3].mean(axis=-1)
        deviator = stress.copy()
        deviator[..., :3] -= mean[..., None]
        effective = np.sqrt(1.5 * ((deviator[..., :3] ** 2).sum(axis=-1) + 2.0 * (deviator[..., 3:] ** 2).sum(axis=-1)))
        factor = np.minimum(1.0, flow / np.maximum(effective, 1e-300))
        stress[...] = deviator * factor[..., None]
        stress[..., :3] += mean[..., None]


def _boundary_areas(run: ImplicitProcedure) -> FloatArray:
    """Return the area of the boundary round each node (n_points,) [mm2]."""
    model = run.model
    faces = model.mesh.boundary_faces
    if len(faces):
        areas = face_areas(model.mesh.points + run.state.nodes.displacement[:, :3], faces)
        return np.asarray(np.bincount(faces.ravel(), areas.ravel(), minlength=len(model.mesh.points)), dtype=float)
    thickness = None if model.analysis == "axisymmetric" else model.depth
    edges = model.mesh.boundary_edges
    areas = edge_areas(model.mesh.points + run.state.nodes.displacement, edges, thickness)
    return np.asarray(np.bincount(edges.ravel(), areas.ravel(), minlength=len(model.mesh.points)), dtype=float)
