# SPDX-License-Identifier: Apache-2.0
"""A new mesh for one deformed section of quadrilaterals, and where its parts lie on the old mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from presswork.geometry.polygon import list_sides
from presswork.mesh.checks import MeshError
from presswork.mesh.topology import chain_edges, find_boundary_edges
from presswork.model import (
    ELEMENTS,
    Body,
    BoolArray,
    ElementName,
    FloatArray,
    IndexArray,
    IntArray,
    Mesh,
    Remeshing,
    find_cell,
    take_corners,
)
from presswork.remesh.boundary import NewLine, OldLine, refuse_fold, resample
from presswork.remesh.carrier import SurfacePlaces
from presswork.remesh.crack_faces import part_faces
from presswork.remesh.fill import close_loops, fill_with_quadrilaterals, measure_quality
from presswork.remesh.landing import draw_outline, find_landings
from presswork.remesh.narrow_gaps import find_corners_ahead
from presswork.remesh.size_field import (
    GradedSize,
    SizeSources,
    along_tool,
    error_sources,
    gap_sources,
    join_sources,
    metal_thickness,
    tool_curvature,
)
from presswork.remesh.slit import Outline
from presswork.remesh.volume import enclosed_volume

LEAST_ACROSS = 1.5
"""Cells across the metal below which a budget is too small."""
_NOTHING = 1e-12
"""Area of a body over the square of its diagonal, at or below which it has none."""
CRACKED_PARTS = (1.0, 0.95, 1.05, 0.9, 1.1, 0.85)
"""Factors on the size of cells, tried one after the other where there are cracks."""
GOOD_CRACKED = 0.15
"""Quality of the worst cell with which such a mesh is taken at once."""
_ATTEMPTS, _FINER = 3, 0.8
"""Where the boundary cannot be kept, or filled, cells are made smaller by a factor, and tried again."""


def halve_edges(edges: IntArray) -> IntArray:
    """Return edges with a node in their middle (n, 3) as two each, in their order; others as they are."""
    return np.ascontiguousarray(edges[:, find_cell(1, edges).pieces].reshape(-1, 2))


def _split_loops(edges: IntArray) -> list[IntArray]:
    """Return chained edges (n, 2) loop by loop."""
    ends = np.flatnonzero(np.append(edges[1:, 0] != edges[:-1, 1], True)) + 1
    return np.split(edges, ends[:-1])


def draw_outlines(mesh: Mesh, bodies: Sequence[Body], position: FloatArray) -> list[list[FloatArray]]:
    """Return the loops of each body's boundary as profiles; of one body alone none: it has nothing to land on.

    position: of the nodes (n_points, 2) [mm].
    """
    if len(bodies) == 1:
        return [[]]
    edges = halve_edges(mesh.boundary_edges)
    loops = (_split_loops(chain_edges(edges[body.owns(edges)], position)) for body in bodies)
    return [[draw_outline(position[loop[:, 0]]) for loop in own] for own in loops]


@dataclass(frozen=True)
class OldSection:
    """What a remesh needs of a body's deformed mesh: one block of cells."""

    mesh: Mesh
    position: FloatArray
    """Position of the nodes (n_points, 2) [mm]."""
    on_tool: BoolArray
    """Which tools hold a node; a last row, if there is one more, marks nodes on other bodies (n, n_points)."""
    fixed: BoolArray
    """Components that supports hold (n_points, 2)."""
    profiles: Sequence[FloatArray]
    """Profiles of the tools where they stand."""
    ring: bool
    points: range
    """Its nodes among those of all bodies."""
    lost: float = 0.0
    """Part of the volume that was lost so far."""
    power: FloatArray | None = None
    """Stress power over volume in each cell (n_cells,), in any unit; None: nothing has moved."""
    element: ElementName = "quad4_fbar"
    """Element of its new mesh where the first one has triangles or quadratic cells."""
    others: Sequence[FloatArray] = ()
    """Outlines of the bodies that it may touch, as profiles."""
    closing: BoolArray | None = None
    """Nodes that have come nearer to each tool, and to each of the others (n_tools + n_others, n_points): where they
    land cells are small; None: nowhere."""
    share: FloatArray | None = None
    """Part of the largest force of a tool that tools push each node with (n_points,); None: none."""
    loops: Sequence[IndexArray] | None = None
    """Loops of the boundary with cracks cut into it, whose points come after those of the mesh; None: as the mesh."""
    is_cracked: bool = False
    """Whether it has cracks, or is about to get some."""
    firm: Sequence[int] = ()
    """Mouths and tips of cracks, which stay nodes."""
    cracks: SizeSources | None = None
    """Sizes of cells wanted where cracks grow; None: no crack."""

    def corners(self) -> IndexArray:
        """Return the corners of the cells (n_cells, 3 | 4)."""
        return take_corners(self.mesh.blocks[0].connectivity).astype(np.intp)

    @cached_property
    def chains(self) -> list[IndexArray]:
        """The nodes of each loop of the boundary in order, the metal on the left.

        Raises MeshError where loops are not closed, or share a node.
        """
        if self.loops is not None:
            return list(self.loops)
        edges = chain_edges(halve_edges(self.mesh.boundary_edges), self.position)
        loops = _split_loops(edges)
        if any(loop[-1, 1] != loop[0, 0] for loop in loops) or len(np.unique(edges[:, 0])) < len(edges):
            raise MeshError("the boundary of a body is not made of closed lines", "bodies whose parts do not touch")
        return [loop[:, 0].astype(np.intp) for loop in loops]

    @cached_property
    def held_sides(self) -> BoolArray:
        """The sides both of whose ends a support holds in one component, marked (k,)."""
        held = [(self.fixed[c] & np.roll(self.fixed[c], -1, axis=0)).any(axis=1) for c in self.chains]
        return np.concatenate(held)

    @cached_property
    def before_others(self) -> list[tuple[FloatArray, BoolArray, FloatArray]]:
        """Each loop (k, 2) [mm] before the outline of each body that it may touch, between them its nodes that nothing
        holds and that come nearer to it (k,).
        """
        closing = () if self.closing is None else self.closing[len(self.profiles) :]
        return [
            (self.position[chain], (self.loose & nearer)[chain], outline)
            for chain in self.chains
            for outline, nearer in zip(self.others, closing, strict=False)
        ]

    @cached_property
    def loose(self) -> BoolArray:
        """The nodes that neither tools nor bodies nor supports hold, marked (n_points,)."""
        return np.asarray(~self.on_tool.any(axis=0) & ~self.fixed.any(axis=1))

    @cached_property
    def sides(self) -> FloatArray:
        """The sides of the boundary, loop after loop (k, 2, 2) [mm]."""
        return np.concatenate([list_sides(self.position[chain]) for chain in self.chains])


def with_cracks(old: OldSection, cut: Outline) -> OldSection:
    """Return a section with cracks cut into its outline, as it is without them; the new mesh gives the volume back."""
    more = len(cut.points) - len(old.position)
    volume_n, volume = (
        sum(enclosed_volume(points[loop], ring=old.ring) for loop in loops)
        for points, loops in ((old.position, old.chains), (cut.points, cut.loops))
    )
    none = np.zeros(more, dtype=bool)
    return replace(
        old,
        position=cut.points,
        on_tool=np.concatenate([old.on_tool, np.zeros((len(old.on_tool), more), dtype=bool)], axis=1),
        fixed=np.concatenate([old.fixed, np.zeros((more, 2), dtype=bool)]),
        closing=None
        if old.closing is None
        else np.concatenate([old.closing, np.tile(none, (len(old.closing), 1))], axis=1),
        share=None if old.share is None else np.concatenate([old.share, np.zeros(more)]),
        lost=(1.0 + old.lost) * volume_n / volume - 1.0,
        loops=cut.loops,
        is_cracked=True,
        firm=cut.firm,
    )


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


def measure_sizes(old: OldSection, settings: Remeshing, *, part: float = 1.0) -> GradedSize:
    """Return the size of cells that tools and thickness ask for now, a part of it, within the budget."""
    size = _ask_for_sizes(old, settings)
    _keep_budget(settings, size, part, _expect_cells(old, size))
    return size


def _ask_for_sizes(old: OldSection, settings: Remeshing) -> GradedSize:
    """Return the size of cells that tools and thickness ask for now, whatever the budget."""
    sides = old.sides
    sources = [gap_sources(sides, old.held_sides)]
    sources += [tool_curvature(sides, p, settings.size, settings.smallest_size) for p in old.profiles]
    sources += [
        along_tool(sides, profile, settings.size, own)
        for profile, own in zip(old.profiles, settings.tool_sizes, strict=False)
        if own < settings.size
    ]
    if settings.error and old.power is not None:
        sources.append(error_sources(old.position[old.corners()], old.corners(), old.power, settings.error))
    sources += [
        find_corners_ahead(*before, smallest=settings.smallest_size, largest=settings.size)
        for before in old.before_others
    ]
    sources += [old.cracks] if old.cracks is not None else []
    landings, others = _find_landings(old, settings), join_sources(*sources)
    least = min(settings.smallest_size, float(landings.size.min(initial=np.inf)))
    joined = join_sources(landings, SizeSources(others.place, np.maximum(others.size, settings.smallest_size)))
    size = GradedSize(sides[:, 0], joined, settings.size, least)
    for window in settings.windows:
        size.limit(window.box, window.size)
    return size


def _find_landings(old: OldSection, settings: Remeshing) -> SizeSources:
    """Return the sizes wanted where the free surface comes to lie on tools and on other bodies."""
    sizes = {"smallest": settings.smallest_size, "largest": settings.size}
    closing = () if old.closing is None else old.closing
    share = np.zeros(len(old.position)) if old.share is None else old.share
    held = [*old.on_tool[: len(old.profiles)], *(old.on_tool[-1] for _ in old.others)]
    return join_sources(
        SizeSources(np.zeros((0, 2)), np.zeros(0)),
        *(
            find_landings(
                old.position[chain], on_tool[chain], (old.loose & nearer)[chain], profile, share[chain], **sizes
            )
            for chain in old.chains
            for profile, on_tool, nearer in zip([*old.profiles, *old.others], held, closing, strict=False)
        ),
    )


def _expect_cells(old: OldSection, size: GradedSize) -> float:
    """Return how many cells of a size there will be."""
    x, y = np.moveaxis(old.position[old.corners()], -1, 0)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    return float((area / size(np.column_stack([x.mean(axis=1), y.mean(axis=1)])) ** 2).sum())


def _keep_budget(settings: Remeshing, size: GradedSize, part: float, expected: float) -> None:
    """Make cells smaller by a factor, but no smaller than the budget allows, in place; expected: cells before that."""
    size.scale(max(part, float(np.sqrt(expected / settings.max_cells))))


def check_budget(old: OldSection, settings: Remeshing) -> None:
    """Raise MeshError where the budget leaves less than LEAST_ACROSS cells across the metal, and a larger one not."""
    size = _ask_for_sizes(old, settings)
    _check_budget(old, settings, size, _expect_cells(old, size))


def _check_budget(old: OldSection, settings: Remeshing, size: GradedSize, expected: float) -> None:
    """Raise MeshError where the budget does not suffice for a size with which so many cells are expected."""
    lack = float(np.sqrt(expected / settings.max_cells))
    if lack <= 1.0:
        return
    thickness, middle = metal_thickness(old.sides, old.held_sides), old.sides.mean(axis=1)
    wanted = thickness / size(middle)
    across = wanted / lack
    worst = int(np.argmin(across))
    if across[worst] < min(LEAST_ACROSS, 0.99 * wanted[worst]):
        x, y = middle[worst]
        needed = int(np.ceil(settings.max_cells * (min(wanted[worst], 3.0) / across[worst]) ** 2))
        raise MeshError(
            f"max_cells = {settings.max_cells:,} leaves {across[worst]:.2g} cells across {thickness[worst]:.3g} mm of "
            f"metal near ({x:.4g}, {y:.4g})",
            f"max_cells = {needed:,} for three",
        )


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
    size = _ask_for_sizes(old, settings)
    expected = _expect_cells(old, size)
    _check_budget(old, settings, size, expected)
    _keep_budget(settings, size, part, expected)
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
                [resample(old_line, size) for old_line in old_lines], chains, is_cracked=old.is_cracked
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
    lines: Sequence[NewLine], chains: Sequence[IndexArray], *, is_cracked: bool
) -> tuple[NewLine, IndexArray]:
    """Return new loops as one line whose places count through all loops, and the node that follows each.

    is_cracked: faces of cracks that cross each other are parted.

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
    if is_cracked:
        joined = replace(joined, points=part_faces(joined.points, after, ~joined.in_plane))
    if is_cracked or len(lines) > 1:
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
