# SPDX-License-Identifier: Apache-2.0
"""Trimming: a formed sheet is cut along lines in its plan, and goes on on another mesh.

Nodes take means of positions; a new cell takes thickness, stress and history, at each of its points, from the nearest
point of the cell that it lies in. So no state is made that the law would not admit, and what is at a point is wrong by
its distance from that point, at most half an element.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace

import numpy as np

from presswork import _core
from presswork.mesh.beside import Beside, find_beside
from presswork.mesh.checks import MeshError
from presswork.mesh.cut import CutCells, CutMesh, cut_mesh
from presswork.mesh.topology import find_boundary_edges
from presswork.model import FloatArray, IndexArray, Mesh, ShellElement, TrimLine, find_cell
from presswork.process.mesh_change.transfer import SheetBlock, SheetState, at_points


@dataclass(frozen=True)
class Cut:
    """How well a sheet was cut along its lines."""

    off_line: float
    """The farthest that a trim line is from the outline [mm]."""
    element_size: float
    """Mean length of the new outline's edges [mm]."""
    beside: Mapping[str, Beside]
    """Distances by line, where one runs beside the sheet."""

    def to_text(self) -> str:
        """Return all of it as a text."""
        return json.dumps(asdict(self))

    @classmethod
    def from_text(cls, text: str) -> Cut:
        """Return what to_text gave."""
        values = json.loads(text)
        beside = {
            name: Beside(**(each | {"place": tuple(each["place"])})) for name, each in values.pop("beside").items()
        }
        return cls(**values, beside=beside)


@dataclass(frozen=True)
class TrimmedSheet:
    """A sheet after it was cut."""

    mesh: Mesh
    """Undeformed; its node sets hold the nodes whose neighbours before the cut were all in them."""
    state: SheetState
    cut: Cut


EVOLVED = "evolved "
"""Prefix of the names of evolution laws' quantities among those of a block."""


class TrimError(Exception):
    """A line that a sheet cannot be cut along."""


def trim_sheet(
    mesh: Mesh,
    state: SheetState,
    lines: tuple[TrimLine, ...],
    elements: Mapping[str, ShellElement],
    symmetry: tuple[bool, bool] = (False, False),
) -> TrimmedSheet:
    """Cut a sheet along one line after the other.

    mesh: undeformed, with the blocks of the state; elements: of the cells of three and four nodes after the cut, at
    whose points the state is given; symmetry: whether planes normal to x and y cut the sheet. Raises TrimError.
    """
    off_line, sizes = 0.0, []
    beside: dict[str, Beside] = {}
    for line in lines:
        outline = state.position[find_boundary_edges([b.connectivity for b in state.blocks])[:, :2], :2]
        found = find_beside(outline, line.polygon, symmetry)
        if found is not None:
            beside[line.name] = found
        try:
            cut = cut_mesh(state.position, tuple(b.connectivity for b in state.blocks), line.polygon, line.keep)
        except MeshError as error:
            raise TrimError(f"trim.{line.name}: {error}") from error
        off_line = max(off_line, cut.off_line)
        edges = (cut.weights @ state.position)[cut.cut_edges]
        sizes.append(float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).mean()))
        state = _cut_state(state, cut, mesh, elements)
        mesh = _cut_mesh(mesh, cut, elements)
    return TrimmedSheet(mesh, state, Cut(off_line, float(np.mean(sizes)), beside))


def explain_beside(cut: Cut) -> list[str]:
    """Describe for each line that runs beside the sheet where, and at what distance."""
    return [
        f"the line trim.{name} runs beside the formed sheet over {each.length:.4g} of its {each.whole:.4g} mm, by up "
        f"to {each.depth:.3g} mm at ({each.place[0]:.4g}, {each.place[1]:.4g}) mm: there the part keeps the edge of "
        "the blank; make the blank larger or the line smaller, unless this is meant"
        for name, each in cut.beside.items()
    ]


def _cut_mesh(mesh: Mesh, cut: CutMesh, elements: Mapping[str, ShellElement]) -> Mesh:
    """Return the undeformed mesh after a cut."""
    thickness = np.concatenate([block.thickness for block in mesh.blocks])
    first = np.cumsum([0, *(len(block.connectivity) for block in mesh.blocks)])
    blocks = []
    for cells in _sort_by_zone(cut, mesh):
        parent = mesh.blocks[cells.parent[0, 0]]
        own = thickness[first[cells.parent[:, 0]] + cells.parent[:, 1]] if parent.own_thickness is not None else None
        element = elements[find_cell(2, cells.connectivity).name]
        blocks.append(replace(parent, element=element, connectivity=cells.connectivity, own_thickness=own))
    share = (cut.weights > 1e-12).astype(np.float64)
    node_sets = {}
    for name, nodes in mesh.node_sets.items():
        outside = np.ones(len(mesh.points))
        outside[nodes] = 0.0
        node_sets[name] = np.flatnonzero(share @ outside == 0.0).astype(np.int32)
    boundary = find_boundary_edges([block.connectivity for block in blocks])
    return Mesh(cut.weights @ mesh.points, tuple(blocks), node_sets, {"boundary": boundary}, boundary)


def _sort_by_zone(cut: CutMesh, mesh: Mesh) -> Iterator[CutCells]:
    """Yield the cells of a cut zone after zone, quadrilaterals before triangles."""
    of_block = np.array([block.zone for block in mesh.blocks])
    for zone in dict.fromkeys(of_block.tolist()):
        for cells in cut.cells:
            own = of_block[cells.parent[:, 0]] == zone
            if own.any():
                yield CutCells(cells.connectivity[own], cells.parent[own], cells.natural[own])


def _cut_state(state: SheetState, cut: CutMesh, mesh: Mesh, elements: Mapping[str, ShellElement]) -> SheetState:
    """Return the state after a cut; mesh: before."""
    blocks = tuple(_cut_block(state, cells, elements) for cells in _sort_by_zone(cut, mesh))
    heated = {name: np.asarray(cut.weights @ values) for name, values in state.heated.items()}
    return SheetState(cut.weights @ state.position, blocks, heated)


def _cut_block(state: SheetState, cells: CutCells, elements: Mapping[str, ShellElement]) -> SheetBlock:
    """Return the state of cells of one kind, each point from the nearest one of the cell's parent."""
    shape = _core.shell_shape(elements[find_cell(2, cells.connectivity).name])[0]
    places = np.einsum("qa,cai->cqi", shape, cells.natural)
    found: dict[str, FloatArray] = {}
    for number, block in enumerate(state.blocks):
        own = cells.parent[:, 0] == number
        parent = cells.parent[own, 1]
        nearest = _nearest_points(block, places[own], elements)
        for name, values in _values_of(block).items():
            taken = values[parent[:, None], nearest]
            found.setdefault(name, np.empty((len(own), *taken.shape[1:])))[own] = taken
    evolved = {name.removeprefix(EVOLVED): v for name, v in found.items() if name.startswith(EVOLVED)}
    plain = {name: v for name, v in found.items() if not name.startswith(EVOLVED)}
    return SheetBlock(cells.connectivity, evolved=evolved, **plain)


def _values_of(block: SheetBlock) -> dict[str, FloatArray]:
    """Return what a block has at its points, by name, also what it has once for all points of a shell."""
    q = block.history.shape[1]
    found = {"axis": block.axis, "thickness": block.thickness, "stress": block.stress, "history": block.history}
    found |= {f"{EVOLVED}{name}": values for name, values in block.evolved.items()}
    if block.temperature is not None:
        found["temperature"] = block.temperature
    return {name: at_points(values, q) for name, values in found.items()}


def _nearest_points(block: SheetBlock, places: FloatArray, elements: Mapping[str, ShellElement]) -> IndexArray:
    """Return which of a block's points in the plane lies nearest to places in natural coordinates (n, q, 2) (n, q)."""
    cell, q = find_cell(2, block.connectivity), block.history.shape[1]
    if q == 1:
        return np.zeros(places.shape[:2], dtype=np.intp)
    points = _core.shell_shape(elements[cell.name])[0] @ cell.places
    return np.asarray(((places[:, :, None] - points) ** 2).sum(axis=3).argmin(axis=2))
