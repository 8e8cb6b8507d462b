# SPDX-License-Identifier: Apache-2.0
"""Parts, and the instances of them that an assembly is made of: nodes and shells of all, under labels of their own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from presswork.deck.abaqus.drawn import KINDS, DrawnSurface, read_drawn
from presswork.mesh.files.abaqus_blocks import Block, DataError, read_labels
from presswork.mesh.files.abaqus_places import GLOBAL, Frame, make_pose, read_nodes, read_system
from presswork.model import FloatArray, IndexArray

Name = tuple[str, str]
"""Name of an instance (empty for the assembly itself), and name of a set or surface in it."""
_SHELLS = ("S4", "S4R", "S4RS", "S4RSW", "S3", "S3R", "S3RS", "R3D4", "R3D3")
POINTS = ("MASS", "ROTARYI")
_LOOSE = 1 << 40
"""What is added to labels of the assembly's own nodes and cells: more than any instance has."""


_DRAWN, _APART = 46, 24
"""Labels of what is drawn: bits from which its number stands, and by which nodes of instances are kept apart."""


@dataclass
class PartMesh:
    """What a part, or the assembly, is made of."""

    nodes: list[FloatArray] = field(default_factory=list)
    """Rows of label, x, y, z."""
    shells: list[FloatArray] = field(default_factory=list)
    """Rows of label and four labels of nodes."""
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    cell_sets: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[str]] = field(default_factory=dict)
    """Sets of cells that a surface lies on."""
    drawn: dict[str, DrawnSurface] = field(default_factory=dict)
    """Analytical surfaces."""
    others: dict[str, Block] = field(default_factory=dict)
    """Kinds of elements that are not read."""
    sets: list[tuple[Block, list[int]]] = field(default_factory=list)
    """Keywords of sets, with the labels that they list."""
    other_cells: set[int] = field(default_factory=set)
    """Labels of elements that are not read."""
    frame: Frame = GLOBAL
    """What coordinates of nodes below a *SYSTEM are given in."""

    def take(self, block: Block) -> bool:
        """Take nodes, elements, sets and surfaces; return whether the block was one. Raises DataError."""
        match block.name:
            case "SYSTEM":
                self.frame = read_system(block)
            case "NODE":
                table = read_nodes(block, self.frame)
                self.nodes.append(table)
                self._add(self.node_sets, block.name_of("NSET"), table[:, 0].astype(int).tolist())
            case "ELEMENT":
                self._take_elements(block)
            case "NSET":
                self._add(self.node_sets, block.name_of("NSET"), self.read_set(block))
            case "ELSET":
                self._add(self.cell_sets, block.name_of("ELSET"), self.read_set(block))
            case "SURFACE" if block.name_of("TYPE") in KINDS:
                self.drawn[block.name_of("NAME")] = read_drawn(block)
            case "SURFACE":
                if block.name_of("TYPE") not in ("", "ELEMENT"):
                    raise DataError(f"a surface of TYPE={block.name_of('TYPE')}: give one of elements")
                names = [row[0].upper() for row in block.rows() if row[0]]
                self.surfaces.setdefault(block.name_of("NAME"), []).extend(names)
            case _:
                return False
        return True

    def _take_elements(self, block: Block) -> None:
        kind = block.name_of("TYPE")
        if kind in POINTS:
            return
        if kind not in _SHELLS:
            self.others.setdefault(kind, block)
            self.other_cells |= set(block.table(1)[:, 0].astype(int).tolist())
            self._add(self.cell_sets, block.name_of("ELSET"), [])
            return
        if block.widest() > 5:
            raise DataError(f"more than four nodes of a shell {kind}")
        table = block.table(5)
        table[:, 4] = np.where(table[:, 4] == 0, table[:, 3], table[:, 4])
        self.shells.append(table)
        self._add(self.cell_sets, block.name_of("ELSET"), table[:, 0].astype(int).tolist())

    def draw(self, name: str, number: int, sheet: FloatArray, tolerance: float) -> None:
        """Make shells of an analytical surface, in a set of its name; number: of this one among all. Raises DataError.

        sheet: points of what is formed in the frame of this mesh (n, 3); tolerance: of chords in arcs.
        """
        points, cells = self.drawn[name].mesh(sheet, tolerance)
        labels = (number << _DRAWN) + (np.arange(1, max(len(points), len(cells)) + 1) << _APART)
        self.nodes.append(np.column_stack([labels[: len(points)], points]).astype(np.float64))
        self.shells.append(np.column_stack([labels[: len(cells)], labels[cells]]).astype(np.float64))
        self.cell_sets[name] = labels[: len(cells)].tolist()

    def read_set(self, block: Block) -> list[int]:
        """Return the labels of a set of nodes or cells of this mesh. Raises DataError."""
        labels, unknown = read_labels(block, self.node_sets if block.name == "NSET" else self.cell_sets)
        if unknown:
            raise DataError(f"there is no set {unknown[0]}")
        self.sets.append((block, labels))
        return labels

    def known(self, keyword: str) -> set[int]:
        """Return the labels of all nodes, or of all elements, for NSET or ELSET."""
        tables = self.nodes if keyword == "NSET" else self.shells
        own = {int(label) for table in tables for label in table[:, 0]}
        return own if keyword == "NSET" else own | self.other_cells

    def used_nodes(self) -> FloatArray:
        """Return the labels of nodes of shells (n,)."""
        return np.concatenate([np.empty(0), *(table[:, 1:].ravel() for table in self.shells)])

    def find_double(self) -> str:
        """Describe a label that two nodes at different places, or two shells, have; empty where there is none."""
        if self.shells:
            labels, count = np.unique(np.concatenate(self.shells)[:, 0], return_counts=True)
            if (count > 1).any():
                return f"a second element {labels[count > 1][0]:.0f}"
        if self.nodes:
            rows = np.concatenate(self.nodes)
            rows = rows[np.argsort(rows[:, 0], kind="stable")]
            same = (rows[1:, 0] == rows[:-1, 0]) & (rows[1:] != rows[:-1]).any(axis=1)
            if same.any():
                return f"a second node {rows[1:, 0][same][0]:.0f}, at another place"
        return ""

    @staticmethod
    def _add(sets: dict[str, list[int]], name: str, labels: list[int]) -> None:
        if name:
            sets.setdefault(name, []).extend(labels)


@dataclass(frozen=True)
class Instance:
    """A part in its place: its rows have labels of their own in the assembly."""

    mesh: PartMesh
    turn: FloatArray
    """(3, 3)."""
    shift: FloatArray
    """(3,)."""
    first_node: int
    first_cell: int
    """What is added to its labels."""


class Assembly:
    """All instances, and the nodes, shells and sets that are in none."""

    def __init__(self) -> None:
        self.parts: dict[str, PartMesh] = {}
        self.loose = PartMesh()
        self.instances: dict[str, Instance] = {"": Instance(self.loose, np.eye(3), np.zeros(3), _LOOSE, _LOOSE)}
        self._sets: dict[tuple[str, str], list[int]] = {}

    def add(self, name: str, part: str, rows: list[list[str]]) -> bool:
        """Put an instance of a part in its place. Raises KeyError for an unknown part, DataError.

        One of an empty part has a part of its own, of its name, as analytical surfaces stand in instances; return
        whether it has.
        """
        if name in self.instances:
            raise DataError(f"a second instance {name}")
        mesh = self.parts[part]
        is_empty = not mesh.nodes and not mesh.drawn
        if is_empty:
            mesh = self.parts[name] = PartMesh()
        before = [i for i in self.instances.values() if i.mesh is not self.loose]
        turn, shift = make_pose(rows)
        node = max((i.first_node + _largest(i.mesh.nodes) for i in before), default=0)
        cell = max((i.first_cell + _largest(i.mesh.shells) for i in before), default=0)
        self.instances[name] = Instance(mesh, turn, shift, node, cell)
        return is_empty

    def add_set(self, block: Block) -> None:
        """Take a set of the assembly whose labels are those of an instance. Raises DataError, KeyError."""
        instance = self.instances[block.name_of("INSTANCE")]
        is_nodes = block.name == "NSET"
        first = instance.first_node if is_nodes else instance.first_cell
        labels = [first + label for label in instance.mesh.read_set(block)]
        self._sets.setdefault((block.name, block.name_of(block.name)), []).extend(labels)

    def nodes_of(self, name: str) -> list[int]:
        """Return the labels of a set of nodes, or of one node, by its name in the assembly. Raises KeyError."""
        return self._find("NSET", name)

    def cells_of(self, name: str) -> list[int]:
        """Return the labels of a set of cells, or of a surface on one. Raises KeyError."""
        instance, _, own = name.rpartition(".")
        surfaces = self.instances[instance].mesh.surfaces
        if own in surfaces:
            prefix = f"{instance}." if instance else ""
            return [label for each in surfaces[own] for label in self._find("ELSET", f"{prefix}{each}")]
        return self._find("ELSET", name)

    def _find(self, kind: str, name: str) -> list[int]:
        if (kind, name) in self._sets:
            return self._sets[kind, name]
        instance_name, _, own = name.rpartition(".")
        instance = self.instances[instance_name]
        first = instance.first_node if kind == "NSET" else instance.first_cell
        if own.isdigit():
            return [first + int(own)]
        sets = instance.mesh.node_sets if kind == "NSET" else instance.mesh.cell_sets
        return [first + label for label in sets[own]]

    def sets_in_instances(self, part: str, name: str) -> dict[str, list[int]]:
        """Return the cells of a part's set in each instance of it; for an empty part those of the assembly's own set.

        Raises KeyError.
        """
        if not part:
            return {"": self.cells_of(name)}
        own = self.parts[part]
        labels = own.cell_sets[name]
        return {n: [i.first_cell + label for label in labels] for n, i in self.instances.items() if i.mesh is own}

    def list_sets(self) -> Iterator[tuple[Block, list[int], set[int]]]:
        """Yield the keywords of sets, the labels that they list, and all labels of their kind in their mesh."""
        for mesh in (self.loose, *self.parts.values()):
            known = {keyword: mesh.known(keyword) for keyword in ("NSET", "ELSET")} if mesh.sets else {}
            for block, labels in mesh.sets:
                yield block, labels, known[block.name]

    def all_nodes(self) -> tuple[IndexArray, FloatArray]:
        """Return labels (n,) and points (n, 3)."""
        labels, points = [], []
        for instance in self.instances.values():
            for table in instance.mesh.nodes:
                labels.append(table[:, 0].astype(np.intp) + instance.first_node)
                points.append(table[:, 1:] @ instance.turn.T + instance.shift)
        return np.concatenate(labels), np.concatenate(points)

    def all_shells(self) -> IndexArray:
        """Return rows of label and four labels of nodes (n, 5)."""
        rows = [np.empty((0, 5), dtype=np.intp)]
        for instance in self.instances.values():
            for table in instance.mesh.shells:
                own = table.astype(np.intp)
                own[:, 0] += instance.first_cell
                own[:, 1:] += instance.first_node
                rows.append(own)
        return np.concatenate(rows)


def _largest(tables: list[FloatArray]) -> int:
    return max((int(table[:, 0].max()) for table in tables if len(table)), default=0)
