# SPDX-License-Identifier: Apache-2.0
"""Abaqus/CalculiX .inp: *NODE, *ELEMENT, *NSET, *ELSET of a flat mesh, of hexahedra or of tetrahedra.

Read here and not through meshio, which (5.3) knows neither the axisymmetric nor most plane-strain elements, and mixes
up element sets when there are several *ELEMENT blocks.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.raw import RawMesh
from presswork.model import CELLS, Cell, IntArray


def read_abaqus(path: Path) -> RawMesh:
    """Read the mesh of an input deck; raises MeshError or ValueError on a deck that cannot be understood."""
    coordinates: dict[int, list[float]] = {}
    elements: dict[int, tuple[str, list[int]]] = {}
    node_sets: dict[str, list[int]] = {}
    element_sets: dict[str, list[int]] = {}
    other: set[str] = set()
    for keyword, parameters, rows in _split_blocks(path.read_text(encoding="utf-8", errors="replace")):
        if keyword == "NODE":
            for row in rows:
                coordinates[int(row[0])] = [float(value) for value in [*row[1:4], "0", "0"][:3]]
            _extend(node_sets, parameters.get("NSET"), [int(row[0]) for row in rows])
        elif keyword == "ELEMENT":
            labels = _read_elements(parameters.get("TYPE", "").upper(), rows, elements, other)
            _extend(element_sets, parameters.get("ELSET"), labels)
        elif keyword in ("NSET", "ELSET"):
            sets = node_sets if keyword == "NSET" else element_sets
            _extend(sets, parameters.get(keyword), _read_labels(rows, sets, "GENERATE" in parameters))
    return _to_raw(coordinates, elements, node_sets, element_sets, other)


def _split_blocks(text: str) -> list[tuple[str, dict[str, str], list[list[str]]]]:
    """Split a deck into keyword, parameters and the rows of data below it."""
    blocks: list[tuple[str, dict[str, str], list[list[str]]]] = []
    for line in text.splitlines():
        line = line.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*"):
            words = [word.strip() for word in line[1:].split(",")]
            pairs = [word.partition("=") for word in words[1:]]
            blocks.append((words[0].upper(), {key.strip().upper(): value.strip() for key, _, value in pairs}, []))
        elif blocks:
            blocks[-1][2].append([word.strip() for word in line.split(",")])
    return blocks


def _read_elements(
    element_type: str, rows: list[list[str]], elements: dict[int, tuple[str, list[int]]], other: set[str]
) -> list[int]:
    """Read the elements of one block, whose data may run over several rows; return their labels."""
    cell = _find_cell(element_type)
    if cell is None:
        other.add(element_type)
        return []
    n_nodes = cell.nodes
    values = [int(word) for row in rows for word in row if word]
    if len(values) % (n_nodes + 1):
        raise MeshError(
            f"the file is cut short: {element_type} elements need {n_nodes} nodes each, the last has fewer",
            "write it again from the mesher",
        )
    labels = []
    for start in range(0, len(values), n_nodes + 1):
        labels.append(values[start])
        elements[values[start]] = (cell.name, values[start + 1 : start + n_nodes + 1])
    return labels


def _find_cell(element_type: str) -> Cell | None:
    """Return the kind of cell of an Abaqus element type, None if it is not read."""
    return next((cell for cell in CELLS.values() if re.match(cell.files.abaqus, element_type)), None)


def _read_labels(rows: list[list[str]], sets: dict[str, list[int]], generate: bool) -> list[int]:
    """Read the labels of a set: numbers, names of sets already read, or first, last, step."""
    labels: list[int] = []
    for row in rows:
        words = [word for word in row if word]
        if generate:
            first, last, *step = (int(word) for word in words)
            labels.extend(range(first, last + 1, step[0] if step else 1))
            continue
        for word in words:
            labels.extend([int(word)] if word.isdigit() else sets.get(word.upper(), []))
    return labels


def _extend(sets: dict[str, list[int]], name: str | None, labels: list[int]) -> None:
    if name:
        sets.setdefault(name.upper(), []).extend(labels)


def _to_raw(
    coordinates: dict[int, list[float]],
    elements: dict[int, tuple[str, list[int]]],
    node_sets: dict[str, list[int]],
    element_sets: dict[str, list[int]],
    other: set[str],
) -> RawMesh:
    """Number everything from 0 and sort it by kind; names of sets become lower case, as Abaqus ignores case."""
    index = {label: position for position, label in enumerate(coordinates)}
    raw = RawMesh(np.array(list(coordinates.values())).reshape(-1, 3), other_kinds=other)

    def connect(labels: list[int], kind: str) -> IntArray:
        rows = [elements[label][1] for label in labels if label in elements and elements[label][0] == kind]
        try:
            return np.array([[index[node] for node in row] for row in rows], dtype=np.int32)
        except KeyError as error:
            raise MeshError(
                f"elements use node {error.args[0]}, which the file does not have",
                "the file is cut short; write it again",
            ) from None

    kinds = {kind for kind, _ in elements.values()}
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
