# SPDX-License-Identifier: Apache-2.0
"""Abaqus/CalculiX .inp: parts, instances, nodes, elements and sets of a flat mesh, of hexahedra or of tetrahedra.

Read here and not through meshio, which (5.3) knows neither the axisymmetric nor most plane-strain elements, and mixes
up element sets when there are several *ELEMENT blocks.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from presswork.keyword_file import KeywordFileError
from presswork.mesh.checks import MeshError
from presswork.mesh.files.abaqus_blocks import Block, DataError, read_blocks, read_labels
from presswork.mesh.files.abaqus_places import GENERATED, GLOBAL, Frame, make_pose, read_nodes, read_system
from presswork.mesh.files.raw import RawMesh
from presswork.model import CELLS, Cell, FloatArray, IntArray

Element = tuple[Cell, list[int]]
_BITS = 40
"""Number of bits of labels as in the file; the bits above are the instance."""


@dataclass
class _Piece:
    """Nodes, elements and sets of a part, of an instance, or of what is in none; labels as in the file."""

    coordinates: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[int, Element] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    frame: Frame = GLOBAL
    """What coordinates below a *SYSTEM are given in."""
    n_added: int = 0
    """Pieces that were added."""

    def copy(self) -> _Piece:
        """Return a piece of its own of the same nodes and elements."""
        nodes = {name: [*labels] for name, labels in self.node_sets.items()}
        cells = {name: [*labels] for name, labels in self.element_sets.items()}
        return _Piece(dict(self.coordinates), dict(self.elements), nodes, cells)

    def add(self, other: _Piece, turn: FloatArray, shift: FloatArray, prefix: str) -> int:
        """Add another piece turned and moved, under new labels; return what was added to its own.

        Its sets join those of their names, and have names of their own with a prefix.
        """
        self.n_added += 1
        first = self.n_added << _BITS
        points = np.array(list(other.coordinates.values())).reshape(-1, 3) @ turn.T + shift
        self.coordinates |= dict(zip((first + label for label in other.coordinates), points.tolist(), strict=True))
        self.elements |= {
            first + label: (kind, [first + n for n in nodes]) for label, (kind, nodes) in other.elements.items()
        }
        for own, its in ((self.node_sets, other.node_sets), (self.element_sets, other.element_sets)):
            for name, labels in its.items():
                for each in (name, f"{prefix}.{name}") if prefix else (name,):
                    _extend(own, each, [first + label for label in labels])
        return first


class _Reader:
    """Takes the blocks of a file; parts are put where their instances are."""

    def __init__(self) -> None:
        self.other: set[str] = set()
        self._whole = _Piece()
        self._parts: dict[str, _Piece] = {}
        self._now = self._whole
        self._instance: tuple[str, FloatArray, FloatArray] | None = None
        self._labels: dict[str, tuple[int, _Piece]] = {}
        """Numbers that were added to labels, and the piece, by instance."""

    def take(self, block: Block) -> None:
        """Take one block. Raises DataError, MeshError."""
        match block.name:
            case "PART":
                name = block.name_of("NAME")
                if name in self._parts:
                    raise DataError(f"a second part {name}")
                self._now = self._parts[name] = _Piece()
            case "INSTANCE":
                self._begin_instance(block)
            case "END PART" | "END INSTANCE":
                self._end_piece()
            case "SYSTEM":
                self._now.frame = read_system(block)
            case "NODE":
                table = read_nodes(block, self._now.frame)
                labels = table[:, 0].astype(int).tolist()
                _add_new(self._now.coordinates, dict(zip(labels, table[:, 1:].tolist(), strict=True)), "node")
                _extend(self._now.node_sets, block.name_of("NSET"), labels)
            case "ELEMENT":
                labels = _read_elements(block, self._now.elements, self.other)
                _extend(self._now.element_sets, block.name_of("ELSET"), labels)
            case "NSET" | "ELSET":
                self._take_set(block)
            case name if name in GENERATED:
                raise MeshError(f"*{name} in {block.place} makes nodes or elements", "write all of them out")

    def finish(self) -> _Piece:
        """Return all there is; parts without instances lie where they were drawn."""
        if not self._labels:
            for part in self._parts.values():
                self._whole.add(part, np.eye(3), np.zeros(3), "")
        return self._whole

    def _begin_instance(self, block: Block) -> None:
        name, part = block.name_of("NAME"), block.name_of("PART")
        if part not in self._parts:
            raise DataError(f"there is no part {part or 'named'}")
        if name in self._labels:
            raise DataError(f"a second instance {name}")
        self._instance = name, *make_pose(block.rows())
        self._now = self._parts[part].copy()

    def _end_piece(self) -> None:
        if self._instance is not None:
            name, turn, shift = self._instance
            self._labels[name] = self._whole.add(self._now, turn, shift, name), self._now
        self._now, self._instance = self._whole, None

    def _take_set(self, block: Block) -> None:
        is_nodes, name, instance = block.name == "NSET", block.name_of(block.name), block.name_of("INSTANCE")
        first, piece = 0, self._now
        if instance:
            if instance not in self._labels:
                raise DataError(f"there is no instance {instance}")
            first, piece = self._labels[instance]
        labels = read_labels(block, piece.node_sets if is_nodes else piece.element_sets)[0]
        sets = self._now.node_sets if is_nodes else self._now.element_sets
        _extend(sets, name, [first + label for label in labels])


def read_abaqus(path: Path) -> RawMesh:
    """Read the mesh of an input deck and of the files that it includes; raises MeshError or ValueError."""
    reader = _Reader()
    try:
        for block in read_blocks(path):
            reader.take(block)
    except KeywordFileError as error:
        raise MeshError(f"{error.path.name}: {error.fault}", error.remedy) from error
    except DataError as error:
        raise MeshError(f"*{block.name} in {block.place}: {error}", "check the rows below it") from error
    return _to_raw(reader.finish(), reader.other)


def _read_elements(block: Block, elements: dict[int, Element], other: set[str]) -> list[int]:
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
    _add_new(elements, {label: (cell, nodes) for label, *nodes in rows}, "element")
    return [row[0] for row in rows]


def _find_cell(element_type: str) -> Cell | None:
    """Return the kind of cell of an Abaqus element type, None if it is not read."""
    return next((cell for cell in CELLS.values() if re.match(cell.files.abaqus, element_type)), None)


def _add_new(all_of_them: dict[int, Any], new: dict[int, Any], what: str) -> None:
    """Add nodes or elements by label. Raises DataError for a label that stands for something else."""
    for label in all_of_them.keys() & new.keys():
        if all_of_them[label] != new[label]:
            raise DataError(f"{what} {label} is there already, and is another one")
    all_of_them.update(new)


def _extend(sets: dict[str, list[int]], name: str, labels: list[int]) -> None:
    if name:
        sets.setdefault(name, []).extend(labels)


def _to_raw(piece: _Piece, other: set[str]) -> RawMesh:
    """Number everything from 0 and sort it by kind; names of sets become lower case, as Abaqus ignores case."""
    elements = piece.elements
    index = {label: position for position, label in enumerate(piece.coordinates)}
    raw = RawMesh(np.array(list(piece.coordinates.values())).reshape(-1, 3), other_kinds=other)

    def connect(labels: list[int], kind: str) -> IntArray:
        rows = [elements[label][1] for label in labels if label in elements and elements[label][0].name == kind]
        try:
            return np.array([[index[node] for node in row] for row in rows], dtype=np.int32)
        except KeyError as error:
            raise MeshError(
                f"elements use node {error.args[0] % (1 << _BITS)}, which the file does not have",
                "the file is cut short; write it again",
            ) from None

    kinds = {cell.name for cell, _ in elements.values()}
    for kind in sorted(kinds):
        raw.add_cells(CELLS[kind], connect(list(elements), kind))
    for name, labels in piece.element_sets.items():
        for kind in kinds:
            raw.add_to_set(name.lower(), kind, connect(labels, kind))
    for name, labels in piece.node_sets.items():
        raw.add_to_set(
            name.lower(), "point", np.array([index[node] for node in labels if node in index], dtype=np.int32)
        )
    return raw
