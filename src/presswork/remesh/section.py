# SPDX-License-Identifier: Apache-2.0
"""A new mesh for one deformed section of quadrilaterals, and where its parts lie on the old mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.topology import find_boundary_edges, halve_edges
from presswork.model import (
    ELEMENTS,
    BoolArray,
    ElementName,
    FloatArray,
    IndexArray,
    IntArray,
    Mesh,
    Remeshing,
)
from presswork.remesh.boundary import NewLine, OldLine, refuse_fold, resample
from presswork.remesh.carrier import SurfacePlaces
from presswork.remesh.crack_faces import part_faces
from presswork.remesh.fill import close_loops, fill_with_quadrilaterals, measure_quality
from presswork.remesh.old_section import OldSection
from presswork.remesh.section_sizes import ask_for_sizes, expect_cells, keep_budget, refuse_small_budget
from presswork.remesh.volume import enclosed_volume

_NOTHING = 1e-12
"""Area of a body over the square of its diagonal, at or below which it has none."""
CRACKED_PARTS = (1.0, 0.95, 1.05, 0.9, 1.1, 0.85)
"""Factors on the size of cells, tried one after the other where there are cracks."""
GOOD_CRACKED = 0.15
"""Quality of the worst cell with which such a mesh is taken at once."""
_ATTEMPTS, _FINER = 3, 0.8
"""Where the boundary cannot be kept, or filled, cells are made smaller by a factor, and tried again."""


@dataclass(frozen=True)
class NewSection:
    """The new mesh in the deformed place."""

    mesh: Mesh
    line: NewLine
    """Its nodes come first among those of the mesh."""
    chain: IndexArray
    """Nodes of the old boundary, to which places on the line refer (k,)."""
    following: IndexArray
    """Number of the one that follows each (k,)."""
    n_old: int
    """Nodes of the old mesh; beyond them are those of cracks cut into it."""

    def surface(self, first_old: int, first_new: int) -> SurfacePlaces:
        """Return where its boundary nodes lie on the old boundary; first: node of the body in all of the mesh."""
        before = self.line.place.astype(int)
        after, preceding = self.following[before], np.argsort(self.following)
        old, part = self.chain + first_old, np.asarray(self.line.place - before)
        node = first_new + np.arange(len(before))
        around = np.stack([before, after, preceding[before], self.following[after]])
        own = (self.chain[around] < self.n_old).all(axis=0)  # faces of a crack take what the metal has there
        before, after, earlier, later = old[around[:, own]]
        return SurfacePlaces(node[own], before, after, part[own], earlier, later)


def _check_volume(old: OldSection, chains: Sequence[IndexArray]) -> None:
    """Raise MeshError for a body that encloses nothing, or whose edges have no length."""
    size = float(np.linalg.norm(np.ptp(old.position, axis=0)))
    area = sum(enclosed_volume(old.position[chain], ring=False) for chain in chains)
    if not area > _NOTHING * size**2:
        raise MeshError(
            f"the body has no volume left: its outline of {size:.4g} mm encloses {area:.4g} mm2",
            "give its size in mm, or end the stroke before it is pressed flat",
        )


def remesh_section(old: OldSection, settings: Remeshing, *, part: float = 1.0) -> NewSection:
    """Return a new mesh of the same element and material, of a part of the size. Raises MeshError if there is none."""
    chains = old.chains
    _check_volume(old, chains)
    size = ask_for_sizes(old, settings)
    expected = expect_cells(old, size)
    refuse_small_budget(old, settings, size, expected)
    keep_budget(settings, size, part, expected)
    old_lines = [
        OldLine(
            old.position[chain], old.on_tool[:, chain], old.fixed[chain],
            find_set_ends(old.mesh, chain) | np.isin(chain, old.firm), old.profiles,
            old.ring, lost, old.is_cracked,
        )
        for chain, lost in zip(chains, _share_lost(old, chains), strict=True)
    ]  # fmt: skip
    for attempt in range(_ATTEMPTS):
        try:
            line, after = _join_lines(
                [resample(old_line, size) for old_line in old_lines], chains, old.profiles if old.is_cracked else None
            )
            points, cells = fill_with_quadrilaterals(line.points, size, after, has_slits=old.is_cracked)
        except MeshError:
            if attempt == _ATTEMPTS - 1:
                raise
            size.scale(_FINER)
            continue
        break
    return NewSection(
        _name_mesh(old.mesh, chains, line, after, points, cells, old.element),
        line,
        np.concatenate(chains),
        _follow(chains),
        len(old.mesh.points),
    )


def remesh_with_cracks(old: OldSection, settings: Remeshing, *, part: float = 1.0, tries: int = 0) -> NewSection:
    """Return a new mesh as remesh_section: of sections with cracks the first one good enough of several sizes, or else
    the best one. tries: meshes that were made of it before, and have failed. Raises MeshError.
    """
    best, found, fault = -np.inf, None, None
    first = tries % len(CRACKED_PARTS)
    for size in CRACKED_PARTS[first:] + CRACKED_PARTS[:first]:
        try:
            new = remesh_section(old, settings, part=part * size)
        except MeshError as error:
            fault = fault or error
            continue
        worst = float(measure_quality(new.mesh.points, new.mesh.blocks[0].connectivity.astype(np.intp)).min())
        if worst > best:
            best, found = worst, new
        if best > GOOD_CRACKED:
            break
    if found is None:
        assert fault is not None
        raise fault
    return found


def _share_lost(old: OldSection, chains: Sequence[IndexArray]) -> list[float]:
    """Return the part of the volume inside each loop that it gives back: the outer ones alone, for all of them."""
    inside = np.array([enclosed_volume(old.position[chain], ring=old.ring) for chain in chains])
    outer = inside > 0.0
    part = old.lost * float(inside.sum() / inside[outer].sum())
    return [part * float(is_outer) for is_outer in outer]


def _follow(chains: Sequence[IndexArray]) -> IndexArray:
    """Return the place of the node that follows each in loops put one behind the other (k,)."""
    return close_loops([len(chain) for chain in chains])


def _join_lines(
    lines: Sequence[NewLine], chains: Sequence[IndexArray], profiles: Sequence[FloatArray] | None
) -> tuple[NewLine, IndexArray]:
    """Return new loops as one line whose places count through all loops, and the node that follows each.

    profiles: of the tools, where faces of cracks that cross each other are parted; None: there are no cracks.

    Raises MeshError where sides cross each other.
    """
    firsts = np.cumsum([0, *(len(chain) for chain in chains)])[:-1].tolist()
    joined = NewLine(
        np.concatenate([line.points for line in lines]),
        np.concatenate([first + line.place for first, line in zip(firsts, lines, strict=True)]),
        np.concatenate([line.is_free for line in lines]),
        max((line.offset for line in lines), key=abs),
        np.concatenate([line.in_plane for line in lines]),
        tuple(seam for line in lines for seam in line.seams),
    )
    after = close_loops([len(line.points) for line in lines])
    if profiles is not None:
        joined = replace(joined, points=part_faces(joined.points, after, ~joined.in_plane, profiles))
    if profiles is not None or len(lines) > 1:
        refuse_fold(np.stack([joined.points, joined.points[after]], axis=1))
    return joined, after


def _edges_in(
    sets: Mapping[str, IntArray], chain: IndexArray, following: IndexArray
) -> dict[str, tuple[BoolArray, BoolArray]]:
    """Return by set which nodes of the chain it holds, and which sides after them lie in it whole."""
    found = {}
    for name, nodes in sets.items():
        inside = _mark(nodes, chain)[chain]
        found[name] = inside, inside & inside[following]
    return found


def _mark(nodes: IntArray, chain: IndexArray) -> BoolArray:
    """Mark nodes among all up to the highest of them and of a chain."""
    marked = np.zeros(1 + max(int(nodes.max(initial=0)), int(chain.max())), dtype=bool)
    marked[nodes] = True
    return marked


def find_set_ends(mesh: Mesh, chain: IndexArray) -> BoolArray:
    """Mark the nodes of the boundary at which a named set ends (k,)."""
    ends = np.zeros(len(chain), dtype=bool)
    for inside, sides in _edges_in(mesh.node_sets, chain, _follow([chain])).values():
        ends |= inside & ~(sides & np.roll(sides, 1))
    following = np.full(max(len(mesh.points), 1 + int(chain.max())), -1)
    following[chain] = np.roll(chain, -1)
    for edges in map(halve_edges, mesh.edge_sets.values()):
        sides = _mark(edges[following[edges[:, 0]] == edges[:, 1], 0], chain)[chain]
        ends |= sides != np.roll(sides, 1)
    return ends


def _name_mesh(
    old: Mesh, chains: Sequence[IndexArray], line: NewLine, new_following: IndexArray, points: FloatArray,
    cells: IndexArray, new_element: ElementName,
) -> Mesh:  # fmt: skip
    """Return the mesh with the sets of the old one: by the sides of the old boundary that nodes and edges lie on.

    new_following: the node that follows each of the new boundary (n,).
    """
    chain, following = np.concatenate(chains), _follow(chains)
    connectivity: IntArray = cells.astype(np.int32)
    n_line = len(line.points)
    side = line.place.astype(int)
    at_node = line.place == side
    node_sets: dict[str, IntArray] = {}
    for name, (inside, sides) in _edges_in(old.node_sets, chain, following).items():
        own = np.where(at_node, inside[side], sides[side])
        everything = len(old.node_sets[name]) == len(old.points)
        node_sets[name] = np.arange(len(points) if everything else n_line)[... if everything else own].astype(np.int32)
    after = line.place[new_following]
    middle = np.where(after > line.place, 0.5 * (line.place + after), line.place + 1e-9).astype(int) % len(chain)
    boundary = find_boundary_edges([connectivity])
    edge_sets = {}
    for name, whole in old.edge_sets.items():
        edges = halve_edges(whole)
        own_sides = _mark(edges[:, 0], chain)[chain] & _mark(edges[:, 1], chain)[chain[following]]
        edge_sets[name] = boundary[own_sides[middle][boundary[:, 0]]]
    element = old.blocks[0].element
    if ELEMENTS[element].cell != "quad4":
        element = new_element
    block = replace(old.blocks[0], element=element, connectivity=connectivity)
    return Mesh(points, (block,), node_sets, edge_sets, boundary)
