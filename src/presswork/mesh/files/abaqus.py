# SPDX-License-Identifier: Apache-2.0
"""Abaqus/CalculiX .inp: *NODE, *ELEMENT, *NSET, *ELSET of a flat mesh, of hexahedra or of tetrahedra.

Read here and not through meshio, which (5.3) knows neither the axisymmetric nor most plane-strain elements, and mixes
up element sets when there are several *ELEMENT blocks.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from presswork.keyword_file import KeywordFileError
from presswork.mesh.checks import MeshError
from presswork.mesh.files.abaqus_blocks import Block, DataError, read_blocks, read_labels
from presswork.mesh.files.raw import RawMesh
from presswork.model import CELLS, Cell, IntArray


def read_abaqus(path: Path) -> RawMesh:
    """Read the mesh of an input deck and of the files that it includes; raises MeshError or ValueError."""
    coordinates: dict[int, list[float]] = {}
    elements: dict[int, tuple[Cell, list[int]]] = {}
    node_sets: dict[str, list[int]] = {}
    element_sets: dict[str, list[int]] = {}
    other: set[str] = set()
    try:
        for block in read_blocks(path):
            if block.name == "NODE":
                table = block.table(4)
                labels = table[:, 0].astype(int).tolist()
                coordinates |= dict(zip(labels, table[:, 1:].tolist(), strict=True))
                _extend(node_sets, block.name_of("NSET"), labels)
            elif block.name == "ELEMENT":
                labels = _read_elements(block, elements, other)
                _extend(element_sets, block.name_of("ELSET"), labels)
            elif block.name in ("NSET", "ELSET"):
                sets = node_sets if block.name == "NSET" else element_sets
                _extend(sets, block.name_of(block.name), read_labels(block, sets)[0])
    except KeywordFileError as error:
        raise MeshError(f"{error.path.name}: {error.fault}", error.remedy) from error
    except DataError as error:
        raise MeshError(f"*{block.name} in {block.place}: {error}", "check the rows below it") from error
    return _to_raw(coordinates, elements, node_sets, element_sets, other)


def _read_elements(block: Block, elements: dict[int, tuple[Cell, list[int]]], other: set[str]) -> list[int]:
    """Read the elements of one block, whose data may run over several rows; return their labels."""
    cell = _find_cell(block.name_of("TYPE"))
    if cell is None:
        other.add(block.name_of("TYPE"))
        return []
    width = cell.nodes + 1
    values = [int(word) for word in block.labels()]
    if len(values) % width:
        raise MeshError(
            f"the file is cut short: {block.name_of('TYPE')} elements need {cell.nodes} nodes each, the last has fewer",
            "write it again from the mesher",
        )
    rows = [values[start : start + width] for start in range(0, len(values), width)]
    elements |= {label: (cell, nodes) for label, *nodes in rows}
    return [row[0] for row in rows]


def _find_cell(element_type: str) -> Cell | None:
    """Return the kind of cell of an Abaqus element type, None if it is not read."""
    return next((cell for cell in CELLS.values() if re.match(cell.files.abaqus, element_type)), None)


def _extend(sets: dict[str, list[int]], name: str, labels: list[int]) -> None:
    if name:
        sets.setdefault(name, []).extend(labels)


def _to_raw(
    coordinates: dict[int, list[float]],
    elements: dict[int, tuple[Cell, list[int]]],
    node_sets: dict[str, list[int]],
    element_sets: dict[str, list[int]],
    other: set[str],
) -> RawMesh:
    """Number everything from 0 and sort it by kind; names of sets become lower case, as Abaqus ignores case."""
    index = {label: position for position, label in enumerate(coordinates)}
    raw = RawMesh(np.array(list(coordinates.values())).reshape(-1, 3), other_kinds=other)

    def connect(labels: list[int], kind: str) -> IntArray:
        rows = [elements[label][1] for label in labels if label in elements and elements[label][0].name == kind]
        try:
            return np.array([[index[node] for node in row] for row in rows], dtype=np.int32)
        except KeyError as error:
            raise MeshError(
                f"elements use node {error.args[0]}, which the file does not have",
                "the file is cut short; write it again",
            ) from None

    kinds = {cell.name for cell, _ in elements.values()}
    for kind in sorted(kinds):
        raw.add_cells(CELLS[kind], connect(list(elements), kind))
    for name, labels in element_sets.items():
        for kind in kinds:
            raw.add_to_set(name.lower(), kind, connect(labels, kind))
    for name, labels in node_sets.items():
        raw.add_to_set(
            name.lower(), "point", np.array([index[node] for node in labels if node in index], dtype=np.int32)
        )
    return raw
