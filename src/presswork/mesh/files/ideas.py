# SPDX-License-Identifier: Apache-2.0
"""I-DEAS universal files (.unv): nodes and elements through pyuff, groups here.

pyuff (2.5) reads the datasets 2411 (nodes) and 2412 (elements, all types); of groups it knows 2467 only, and prints
while it reads, so the groups of 2435, 2452, 2467 and 2477, which look alike, are read here. A parabolic element lists
its nodes round its edge, corner and mid-side in turn.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.files.raw import RawMesh
from presswork.model import CELLS, Cell, IntArray

_NOT_READ = {112: "wedge", 116: "hexahedron20"}
_GROUPS = (2435, 2452, 2467, 2477)
_NODE_CODE, _ELEMENT_CODE = 7, 8


def read_ideas(path: Path) -> RawMesh:
    """Read the mesh of a universal file; raises MeshError, or what pyuff raises."""
    import pyuff

    datasets = _split_datasets(path)
    if not any(number == 2411 for number, _ in datasets) or not any(number == 2412 for number, _ in datasets):
        raise MeshError("the file has no nodes or no elements (datasets 2411, 2412)", "write it again from the mesher")
    _refuse_long_rows(next(lines for number, lines in datasets if number == 2412))
    file = pyuff.UFF(str(path))
    types = [int(number) for number in file.get_set_types()]
    nodes = file.read_sets(types.index(2411))
    labels = np.asarray(nodes["node_nums"]).astype(np.int64)
    raw = RawMesh(np.column_stack([nodes[axis] for axis in "xyz"]))
    index = {int(label): position for position, label in enumerate(labels)}
    elements: dict[int, tuple[Cell, IntArray]] = {}
    for position in (place for place, number in enumerate(types) if number == 2412):
        _read_elements(file.read_sets(position), index, elements, raw)
    kinds = {cell.name for cell, _ in elements.values()}
    for kind in sorted(kinds):
        raw.add_cells(CELLS[kind], np.array([nodes for cell, nodes in elements.values() if cell.name == kind]))
    for number, lines in datasets:
        if number in _GROUPS:
            _read_groups(lines, index, elements, raw)
    return raw


def _split_datasets(path: Path) -> list[tuple[int, list[str]]]:
    """Split a universal file into dataset number and lines."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    marks = [position for position, line in enumerate(lines) if line.strip() == "-1"]
    if len(marks) % 2:
        raise MeshError("the file is cut short: its last dataset does not end", "write it again from the mesher")
    pairs = zip(marks[::2], marks[1::2], strict=True)
    return [(int(lines[start + 1].split()[0]), lines[start + 2 : end]) for start, end in pairs]


def _refuse_long_rows(lines: list[str]) -> None:
    """Raise MeshError for elements whose nodes take two rows, which pyuff does not read."""
    row = 0
    while row < len(lines):
        _, descriptor, _, _, _, n_nodes = (int(word) for word in lines[row].split()[:6])
        if n_nodes > 8:
            named = _name(descriptor, f"element type {descriptor}")
            raise MeshError(
                f"elements of {n_nodes} nodes ({named}) are not read from this format", "save it as .inp, .msh or .vtk"
            )
        row += 3 if descriptor in CELLS["line2"].files.ideas else 2


def _read_elements(
    dataset: dict[Any, Any], index: dict[int, int], elements: dict[int, tuple[Cell, IntArray]], raw: RawMesh
) -> None:
    """Take the elements of a dataset 2412 as pyuff gives it, by label, in the Model's node order."""
    for descriptor, entries in dataset.items():
        if not isinstance(descriptor, int):
            continue
        for entry in entries:
            try:
                nodes = np.array([index[node] for node in entry["nodes_nums"]], dtype=np.int32)
            except KeyError as error:
                raise MeshError(
                    f"elements use node {error.args[0]}, which the file does not have", "write it again from the mesher"
                ) from None
            cell = _find_cell(descriptor, len(nodes))
            if cell is None:
                named = _name(descriptor, "element type")
                raw.other_kinds.add(f"{named} {descriptor} with {len(nodes)} nodes")
                continue
            if cell.dimension == 2:
                nodes = nodes[np.argsort(cell.ring)]
            elements[int(entry["element_nums"])] = (cell, nodes)


def _find_cell(descriptor: int, n_nodes: int) -> Cell | None:
    """Return the kind of cell of an element type, None if it is not read."""
    fitting = (cell for cell in CELLS.values() if descriptor in cell.files.ideas and cell.nodes == n_nodes)
    return next(fitting, None)


def _name(descriptor: int, otherwise: str) -> str:
    """Return what messages call an element type."""
    names = {number: cell.files.meshio for cell in CELLS.values() if cell.dimension == 3 for number in cell.files.ideas}
    return (_NOT_READ | names).get(descriptor, otherwise)


def _read_groups(
    lines: list[str], index: dict[int, int], elements: dict[int, tuple[Cell, IntArray]], raw: RawMesh
) -> None:
    """Add the permanent groups of a dataset to the sets."""
    position = 0
    while position + 1 < len(lines):
        n_entities = int(lines[position].split()[7])
        name = lines[position + 1].strip()
        n_rows = (n_entities + 1) // 2
        rows = lines[position + 2 : position + 2 + n_rows]
        values = np.array([int(word) for row in rows for word in row.split()]).reshape(-1, 4)
        for code, label in values[:, :2]:
            if code == _NODE_CODE and int(label) in index:
                raw.add_to_set(name, "point", np.array([index[int(label)]]))
            elif code == _ELEMENT_CODE and int(label) in elements:
                cell, nodes = elements[int(label)]
                raw.add_to_set(name, cell.name, nodes[None, :])
        position += 2 + n_rows
