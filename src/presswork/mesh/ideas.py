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
from presswork.mesh.raw import RawMesh
from presswork.model import IntArray

# Element types by what they are: plane stress, plane strain, plate, membrane, axisymmetric solid, thin shell.
_LINEAR_TRIANGLES = (41, 51, 61, 71, 81, 91)
_PARABOLIC_TRIANGLES = (42, 52, 62, 72, 82, 92)
_LINEAR_QUADS = (44, 54, 64, 74, 84, 94)
_PARABOLIC_QUADS = (45, 55, 65, 75, 85, 95)
_LINES = (11, 21, 22, 23, 24)
_SOLIDS = {111: "tetra", 112: "wedge", 115: "hexahedron", 116: "hexahedron20", 118: "tetra10"}
_FILLING = {"tet4": "tetra", "hex8": "hexahedron"}
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
    elements: dict[int, tuple[str, IntArray]] = {}
    for position in (place for place, number in enumerate(types) if number == 2412):
        _read_elements(file.read_sets(position), index, elements, raw)
    kinds = {kind for kind, _ in elements.values() if not kind.startswith("line")}
    for kind in sorted(kinds):
        cells = np.array([cell for other, cell in elements.values() if other == kind])
        if kind in _FILLING:
            raw.add_volumes(kind, cells)
            raw.other_kinds.add(_FILLING[kind])
        else:
            raw.add_cells(kind, cells)
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
            named = _SOLIDS.get(descriptor, f"element type {descriptor}")
            raise MeshError(
                f"elements of {n_nodes} nodes ({named}) are not read from this format", "save it as .inp, .msh or .vtk"
            )
        row += 3 if descriptor in _LINES else 2


def _read_elements(
    dataset: dict[Any, Any], index: dict[int, int], elements: dict[int, tuple[str, IntArray]], raw: RawMesh
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
            kind = _kind_of(descriptor, len(nodes))
            if kind is None:
                named = _SOLIDS.get(descriptor, "element type")
                raw.other_kinds.add(f"{named} {descriptor} with {len(nodes)} nodes")
                continue
            if kind in ("tri6", "quad8"):
                nodes = np.concatenate([nodes[::2], nodes[1::2]])
            elements[int(entry["element_nums"])] = (kind, nodes)


def _kind_of(descriptor: int, n_nodes: int) -> str | None:
    """Return tri3, tri6, quad4, quad8, line2, line3, tet4 or hex8 for an element type, None for any other."""
    kinds = {
        3: ("tri3", _LINEAR_TRIANGLES),
        6: ("tri6", _PARABOLIC_TRIANGLES),
        4: ("quad4", _LINEAR_QUADS),
        8: ("quad8", _PARABOLIC_QUADS),
    }
    if descriptor in _LINES and n_nodes in (2, 3):
        return f"line{n_nodes}"
    for kind, solid in _FILLING.items():
        if _SOLIDS.get(descriptor) == solid and n_nodes == int(kind[-1]):
            return kind
    kind, descriptors = kinds.get(n_nodes, ("", ()))
    return kind if descriptor in descriptors else None


def _read_groups(
    lines: list[str], index: dict[int, int], elements: dict[int, tuple[str, IntArray]], raw: RawMesh
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
                kind, nodes = elements[int(label)]
                raw.add_to_set(name, kind, nodes[None, :])
        position += 2 + n_rows
