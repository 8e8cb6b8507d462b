# SPDX-License-Identifier: Apache-2.0
"""What a new mesh needs of the deformed section that it replaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from presswork.geometry.polygon import list_sides
from presswork.mesh.checks import MeshError
from presswork.mesh.topology import chain_edges, halve_edges
from presswork.model import (
    Body,
    BoolArray,
    ElementName,
    FloatArray,
    IndexArray,
    IntArray,
    Mesh,
    take_corners,
)
from presswork.remesh.landing import draw_outline
from presswork.remesh.size_field import SizeSources
from presswork.remesh.slit import Outline
from presswork.remesh.volume import enclosed_volume


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
