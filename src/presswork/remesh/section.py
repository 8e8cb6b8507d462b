# SPDX-License-Identifier: Apache-2.0
"""A new mesh for one deformed section of quadrilaterals, and where its parts lie on the old mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.topology import chain_edges, find_boundary_edges
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Mesh, Remeshing
from presswork.remesh.boundary import NewLine, OldLine, resample
from presswork.remesh.carrier import SurfacePlaces
from presswork.remesh.fill import fill_with_quadrilaterals
from presswork.remesh.size_field import GradedSize, gap_sources, join_sources, tool_curvature

_ATTEMPTS, _FINER = 3, 0.8
"""Where the boundary cannot be kept, or filled, cells are made smaller by a factor, and tried again."""


@dataclass(frozen=True)
class OldSection:
    """What a remesh needs of the deformed mesh."""

    mesh: Mesh
    position: FloatArray
    """Of the nodes (n_points, 2) [mm]."""
    on_tool: BoolArray
    """Which tools hold a node (n_tools, n_points)."""
    fixed: BoolArray
    """Components that supports hold (n_points, 2)."""
    profiles: Sequence[FloatArray]
    """Of the tools where they stand."""
    ring: bool
    lost: float = 0.0
    """Part of the volume that was lost so far."""

    def chain(self) -> IndexArray:
        """Return the nodes of the boundary in order, counter-clockwise (k,). Raises MeshError if it is not one line."""
        edges = chain_edges(self.mesh.boundary_edges, self.position)
        if (edges[1:, 0] != edges[:-1, 1]).any() or edges[-1, 1] != edges[0, 0]:
            raise MeshError("the boundary of the workpiece is not one closed line", "a section without holes")
        return edges[:, 0].astype(np.intp)


@dataclass(frozen=True)
class NewSection:
    """The new mesh in the deformed place."""

    mesh: Mesh
    line: NewLine
    """Its nodes come first among those of the mesh."""
    chain: IndexArray
    """Nodes of the old boundary, to which places on the line refer (k,)."""

    def surface(self) -> SurfacePlaces:
        """Return where its boundary nodes lie on the old boundary."""
        before = self.line.place.astype(int)
        after = np.roll(self.chain, -1)
        return SurfacePlaces(
            np.arange(len(before)), self.chain[before], after[before], np.asarray(self.line.place - before)
        )


def measure_sizes(old: OldSection, chain: IndexArray, settings: Remeshing) -> GradedSize:
    """Return the size of cells that tools, thickness and budget ask for now."""
    line = old.position[chain]
    held = (old.fixed[chain] & np.roll(old.fixed[chain], -1, axis=0)).any(axis=1)
    sources = [gap_sources(line, np.asarray(held))]
    sources += [tool_curvature(line, p, settings.size, settings.smallest_size) for p in old.profiles]
    size = GradedSize(line, join_sources(*sources), settings.size, settings.smallest_size)
    cells = np.concatenate([block.connectivity for block in old.mesh.blocks])
    corners = old.position[cells]
    diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = 0.5 * np.abs(diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0])
    expected = float((area / size(corners.mean(axis=1)) ** 2).sum())
    if expected > settings.max_cells:
        size.scale(float(np.sqrt(expected / settings.max_cells)))
    return size


def remesh_section(old: OldSection, settings: Remeshing, *, part: float = 1.0) -> NewSection:
    """Return a new mesh of the same element and material, of a part of the size. Raises MeshError if there is none."""
    chain = old.chain()
    size = measure_sizes(old, chain, settings)
    size.scale(part)
    old_line = OldLine(
        old.position[chain], old.on_tool[:, chain], old.fixed[chain], find_set_ends(old.mesh, chain), old.profiles,
        old.ring, old.lost,
    )  # fmt: skip
    for attempt in range(_ATTEMPTS):
        try:
            line = resample(old_line, size)
            points, cells = fill_with_quadrilaterals(line.points, size)
        except MeshError:
            if attempt == _ATTEMPTS - 1:
                raise
            size.scale(_FINER)
            continue
        break
    return NewSection(_name_mesh(old.mesh, chain, line, points, cells), line, chain)


def _edges_in(sets: Mapping[str, IntArray], chain: IndexArray) -> dict[str, tuple[BoolArray, BoolArray]]:
    """Return by set which nodes of the chain it holds, and which sides after them lie in it whole."""
    found = {}
    for name, nodes in sets.items():
        inside = np.isin(chain, nodes)
        found[name] = inside, inside & np.roll(inside, -1)
    return found


def find_set_ends(mesh: Mesh, chain: IndexArray) -> BoolArray:
    """Mark the nodes of the boundary at which a named set ends (k,)."""
    ends = np.zeros(len(chain), dtype=bool)
    for inside, sides in _edges_in(mesh.node_sets, chain).values():
        ends |= inside & ~(sides & np.roll(sides, 1))
    following = dict(zip(chain.tolist(), np.roll(chain, -1).tolist(), strict=True))
    for edges in mesh.edge_sets.values():
        first = {a for a, b in edges[:, :2].tolist() if following.get(a) == b}
        sides = np.array([node in first for node in chain.tolist()], dtype=bool)
        ends |= sides != np.roll(sides, 1)
    return ends


def _name_mesh(old: Mesh, chain: IndexArray, line: NewLine, points: FloatArray, cells: IndexArray) -> Mesh:
    """Return the mesh with the sets of the old one: by the sides of the old boundary that nodes and edges lie on."""
    connectivity: IntArray = cells.astype(np.int32)
    n_line = len(line.points)
    side = line.place.astype(int)
    at_node = line.place == side
    node_sets: dict[str, IntArray] = {}
    for name, (inside, sides) in _edges_in(old.node_sets, chain).items():
        own = np.where(at_node, inside[side], sides[side])
        everything = len(old.node_sets[name]) == len(old.points)
        node_sets[name] = np.arange(len(points) if everything else n_line)[... if everything else own].astype(np.int32)
    after = np.roll(line.place, -1)
    middle = np.where(after > line.place, 0.5 * (line.place + after), line.place + 1e-9).astype(int) % len(chain)
    boundary = find_boundary_edges([connectivity])
    edge_sets = {}
    for name, edges in old.edge_sets.items():
        own_sides = np.isin(chain, edges[:, 0]) & np.isin(np.roll(chain, -1), edges[:, 1])
        edge_sets[name] = boundary[own_sides[middle][boundary[:, 0]]]
    block = replace(old.blocks[0], connectivity=connectivity)
    return Mesh(points, (block,), node_sets, edge_sets, boundary)
