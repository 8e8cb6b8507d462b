# SPDX-License-Identifier: Apache-2.0
"""A starter's deck of OpenRadioss, read: shells, rigid bodies, what drives them, contact and the material of a sheet.

Materials and properties are read for the sheet alone: those of parts in rigid bodies do not matter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from presswork.deck.contents import Deck, MaterialCard, PartCard, Shells
from presswork.deck.fields import FieldError, read_table
from presswork.deck.keyword_file import explain_unreadable
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_blocks, read_row
from presswork.deck.rad.cards import leave_behind, leave_fields, leave_rows, refuse_second
from presswork.deck.rad.conditions import Conditions, RigidBody
from presswork.deck.rad.engine import read_engine, take_engine_block
from presswork.deck.rad.groups import Groups
from presswork.deck.rad.keywords import SEEN, STARTER
from presswork.deck.rad.materials import read_material
from presswork.deck.rad.sections import read_property
from presswork.deck.units import Units, name_units
from presswork.model import IndexArray

_OLDEST = 51
"""The first version whose fields are 10 and 20 characters wide."""


@dataclass(frozen=True)
class _Part:
    title: str
    section: int
    material: int
    thickness: float
    block: Block


class RadDeck:
    """Reads one deck; what is in it, and the notes on it."""

    def __init__(self, path: Path, notes: Notes) -> None:
        self.deck = Deck()
        self.notes = notes
        self._path = path
        self._version = 0
        self._local_units: dict[int, Units] = {}
        self._labels: list[IndexArray] = []
        self._points: list[np.ndarray] = []
        self._rows: list[tuple[int, np.ndarray]] = []
        self._parts: dict[int, _Part] = {}
        self._properties: dict[int, Block] = {}
        self._materials: dict[int, Block] = {}
        self._node_blocks: list[tuple[Block, int]] = []
        self._groups = Groups()
        self._later: list[Block] = []
        self._bodies: list[RigidBody] = []
        self._all = Shells(np.empty(0, dtype=np.intp), np.empty((0, 4), dtype=np.intp), np.empty(0))

    def read(self) -> Deck:
        """Read it all, with the engine's files beside it. Raises CaseError."""
        with explain_unreadable():
            for block in read_blocks(self._path, self._path, self.notes):
                self._try(self._take, block)
            if not self._version:
                raise self.notes.fail(None, "no /BEGIN in it", "give the starter's file, NAME_0000.rad")
            for block in read_engine(self._path, self.notes):
                self._try(self._take_engine, block)
        if not self._labels or not self._rows:
            raise self.notes.fail(None, "no /NODE or no /SHELL in it", "give the whole deck, with its files")
        self._finish()
        return self.deck

    def _try(self, handler: Callable[[Block], None], block: Block) -> None:
        try:
            handler(block)
        except (FieldError, IndexError, KeyError, ValueError) as error:
            text, remedy = "the rows below it are cut short", "check the rows below it"
            if isinstance(error, KeyError) and not isinstance(error.args[0], tuple):
                text, remedy = (
                    f"there is no part or body {error.args[0]}",
                    "check its number: the deck may be cut short",
                )
            elif isinstance(error, KeyError):
                text = f"there is no group {error.args[0][1]} of {error.args[0][0]}"
                remedy = "give it by nodes, parts or other groups (/GRNOD/NODE, GENE, PART, SURF; /SURF/PART, SEG)"
            elif not isinstance(error, IndexError):
                text = str(error)
            raise self.notes.fail(block.place, f"{block.keyword}: {text}", remedy) from error

    def _take(self, block: Block) -> None:
        word = block.words[0]
        if word in SEEN:
            fate, text = SEEN[word]
            self.notes.see(block.place, block.keyword, text, fate)
        handler = _HANDLERS.get(word)
        if handler is not None:
            handler(self, block)
        elif word in _LATER:
            self._check_units(block, 1)
            self._later.append(block)
        elif self._groups.take(block):
            self.notes.see(block.place, block.keyword, "a group, for keywords that name it")
        elif word == "RUN":
            self._take_engine(block)
        elif word in STARTER:
            self.notes.drop(
                block.place, block.keyword, "controls numerics or output, or matters only where it is named"
            )
        else:
            self.notes.refuse(block.place, block.keyword, "carries physics that has no counterpart here")

    def _take_engine(self, block: Block) -> None:
        take_engine_block(block, self.deck, self.notes)

    # --- head and mesh -----------------------------------------------------------------------------------------------

    def _begin(self, block: Block) -> None:
        title, rows = block.titled()
        self.deck.title = self.deck.title or title
        self._version = int(read_row(rows[0], 10)[0])
        if self._version < _OLDEST:
            raise ValueError(f"version {self._version}, whose fields are 8 and 16 wide: write it anew from version 51")
        leave_fields(block, rows[0], "Invers", self.notes)
        self.deck.units = self._name_units(rows[1] if len(rows) > 1 else b"")
        if len(rows) > 1:
            leave_fields(block, rows[1], "mass:20 length:20 time:20", self.notes)
        leave_rows(block, rows[2:], "units of output", self.notes)
        self.notes.keep(block.place, block.keyword, f"version {self._version}, units {self.deck.units.name}")

    def _unit(self, block: Block) -> None:
        self._local_units[block.number] = self._name_units(block.titled()[1][0])

    @staticmethod
    def _name_units(row: bytes) -> Units:
        text = row.decode("latin-1")
        try:
            return name_units(*(text[i : i + 20].strip() for i in (0, 20, 40)))
        except ValueError as error:
            raise ValueError(f"units that are not known: {' '.join(text.split())}") from error

    def _check_units(self, block: Block, place: int) -> None:
        """Refuse numbers in other units than the deck's own; place: of the number of their units in the keyword."""
        if len(block.numbers) <= place or not block.numbers[place]:
            return
        own = self._local_units.get(block.numbers[place])
        if own is None or self.deck.units is None or not own.is_as(self.deck.units):
            text = f"numbers in units of their own ({own.name if own else 'not defined above'})"
            self.notes.refuse(block.place, block.keyword, text, "write them in the units of /BEGIN")

    def _title(self, block: Block) -> None:
        self.deck.title, rows = block.titled()
        leave_rows(block, rows, "further rows", self.notes)

    def _nodes(self, block: Block) -> None:
        self._check_units(block, 0)
        self.deck.node_place = self.deck.node_place or block.place
        n = 0
        for rows in block.pieces():
            table = read_table(rows, (10, 20, 20, 20), {})
            leave_behind(block, rows, 70, self.notes)
            self._labels.append(table[:, 0].astype(np.intp))
            self._points.append(table[:, 1:].copy())
            n += len(table)
        self.notes.see(block.place, block.keyword, f"{n} nodes")
        self._node_blocks.append((block, n))

    def _shells(self, block: Block) -> None:
        n = 0
        for rows in block.pieces():
            table = read_table(rows, (10,) * 6 + (20, 20), {})
            if block.words[0] == "SH3N":
                table[:, 4] = 0.0
            table[:, 4] = np.where(table[:, 4] == 0, table[:, 3], table[:, 4])
            leave_behind(block, rows, 100, self.notes)
            if table[:, 5].any():
                self.notes.leave(block.place, block.keyword, f"the sixth field of shells, {table[:, 5].max():g}")
            if table[:, 6].any():
                self.notes.refuse(block.place, block.keyword, "axes of the material turned cell by cell (Phi)")
            self._rows.append((block.number, table[:, [1, 2, 3, 4, 7, 0]]))
            n += len(table)
        self.notes.see(block.place, block.keyword, f"{n} shells of part {block.number}")

    def _part(self, block: Block) -> None:
        title, rows = block.titled()
        section, material, _, thickness = read_row(rows[0], 10, 10, 10, 20)
        leave_fields(block, rows[0], "prop_ID mat_ID -subset_ID Thick:20", self.notes)
        leave_rows(block, rows[1:], "further rows", self.notes)
        refuse_second(block, "part", self._parts, self.notes)
        name = title or f"part {block.number}"
        self._parts[block.number] = _Part(name, int(section), int(material), thickness, block)

    def _property(self, block: Block) -> None:
        self._check_units(block, 1)
        refuse_second(block, "property", self._properties, self.notes)
        self._properties[block.number] = block

    def _material(self, block: Block) -> None:
        self._check_units(block, 1)
        refuse_second(block, "material", self._materials, self.notes)
        self._materials[block.number] = block

    def _failure(self, block: Block) -> None:
        rows = " / ".join(" ".join(row.decode("latin-1").split()) for row in block.rows() if row.strip())
        self.notes.change(block.place, block.keyword, f"deletes no cells: look at the forming limit ({rows})")

    def _curve(self, block: Block) -> None:
        rows = [row for row in block.titled()[1] if row.strip()]
        refuse_second(block, "curve", self.deck.curves, self.notes)
        self.deck.curves[block.number] = read_table(rows, (20, 20), {})
        leave_behind(block, rows, 40, self.notes)
        self.deck.curve_lines[block.number] = (block.place, block.keyword)

    def _adaptive(self, block: Block) -> None:
        if "GLOBAL" in block.words:
            rows = block.rows()
            self.deck.levels = int(read_row(rows[0], 10)[0])
            leave_fields(block, rows[0], "Levelmax", self.notes)
            leave_rows(block, rows[1:], "further rows", self.notes)
            self.notes.change(block.place, block.keyword, "shells are split where tools bend them (blank.refine)")

    # --- the whole ---------------------------------------------------------------------------------------------------

    def _finish(self) -> None:
        deck = self.deck
        deck.labels, deck.points = np.concatenate(self._labels), np.concatenate(self._points)
        numbers, count = np.unique(deck.labels, return_counts=True)
        if (count > 1).any():
            text = f"a second node {numbers[count > 1][0]}"
            raise self.notes.fail(deck.node_place, text, "give nodes of all files numbers of their own")
        table = np.concatenate([rows for _, rows in self._rows])
        part = np.concatenate([np.full(len(rows), number, dtype=np.intp) for number, rows in self._rows])
        self._labels, self._points, self._rows = [], [], []  # a million nodes are not kept twice
        own = np.where(table[:, 4] > 0.0, table[:, 4], np.nan)
        self._all = Shells(part, table[:, :4].astype(np.intp), own, table[:, 5].astype(np.intp))
        for block in self._later:
            if block.words[0] == "RBODY":
                self._try(self._body, block)
        for body in self._bodies:
            part = np.where(np.isin(part, body.parts), body.part, part)
        deck.shells = replace(self._all, part=part)
        for number, each in self._parts.items():
            if number not in {each for body in self._bodies for each in body.parts}:
                self._try(self._sheet, each.block)
        for number in {each for body in self._bodies for each in body.parts}:
            self._leave_rigid(self._parts[number])
        conditions = Conditions(deck, self.notes, self._groups, self._all, self._bodies)
        for block in self._later:
            if block.words[0] != "RBODY":
                self._try(conditions.take, block)
        self._groups.note_unused(deck.labels, np.unique(self._all.part), self.notes)
        self._note_idle_nodes()

    def _leave_rigid(self, part: _Part) -> None:
        """List what a rigid part has and does not need."""
        text = f"prop_ID = {part.section}, mat_ID = {part.material}"
        thickness = self._all.thickness[self._all.part == part.block.number]
        thick = max(part.thickness, float(np.nanmax(thickness)) if np.isfinite(thickness).any() else 0.0)
        if thick:
            text += f", a thickness of {thick:g}"
        self.notes.leave(part.block.place, part.block.keyword, text, "the part is rigid")

    def _note_idle_nodes(self) -> None:
        """List blocks of nodes none of which a shell has."""
        begin = 0
        for block, n in self._node_blocks:
            if n and not np.isin(self.deck.labels[begin : begin + n], self._all.nodes).any():
                text = f"{n} nodes of no shell: main nodes of rigid bodies, which move by the stages, or unused"
                self.notes.see(block.place, block.keyword, text, "dropped")
            begin += n

    def _body(self, block: Block) -> None:
        """Find the part that a rigid body is; several parts become one."""
        rows = block.titled()[1]
        row = rows[0]
        layout = "node_ID sens_ID -skew_ID -Ispher -Mass:20 grnd_ID -Ikrem -ICoG surf_ID"
        leave_fields(block, row, layout, self.notes)
        leave_rows(block, rows[1:], "inertia", self.notes)
        main, sensor, _, _, _, group, _, _, surface = (
            int(each) for each in read_row(row, 10, 10, 10, 10, 20, *[10] * 4)
        )
        if not np.isin(main, self.deck.labels):
            self.notes.refuse(block.place, block.keyword, f"there is no node {main}", "check its number")
        if group and surface:
            self.notes.leave(block.place, block.keyword, f"surf_ID = {surface}", "the group of nodes is taken")
        if sensor:
            self.notes.refuse(block.place, block.keyword, "a rigid body that a sensor makes (sens_ID)")
        room, number = ("GRNOD", group) if group else ("SURF", surface)
        nodes = np.union1d(self._groups.nodes(room, number, self._all), [main])
        inside = np.asarray(np.isin(self._all.nodes, nodes).all(axis=1))
        parts = tuple(int(each) for each in np.unique(self._all.part) if inside[self._all.part == each].all())
        if not parts:
            self.notes.drop(block.place, block.keyword, "holds no whole part of shells together")
            return
        if len(parts) > 1:
            names = ", ".join(str(each) for each in parts)
            self.notes.change(block.place, block.keyword, f"parts {names} move together: one tool")
        of = self._parts[parts[0]]
        self.deck.parts[parts[0]] = PartCard(of.title, 0, 0, of.block.place, of.block.keyword)
        self.deck.materials[0] = MaterialCard(block.keyword, 0.0, 0.0, 0.0, block.place, is_rigid=True)
        self._bodies.append(RigidBody(main, nodes, parts))

    def _sheet(self, block: Block) -> None:
        """Take a part that is not rigid, with its property and material."""
        deck, number = self.deck, block.number
        own = self._all.part == number
        if not own.any():
            return
        part = self._parts[number]
        if part.section not in self._properties:
            raise self.notes.fail(block.place, f"/PART: there is no property {part.section}", "give it by /PROP")
        read = read_property(self._properties[part.section], self.notes)
        if read is None:
            return
        index = np.zeros(int(deck.labels.max()) + 1, dtype=np.intp)
        index[deck.labels] = np.arange(len(deck.labels))
        a, b, c, d = deck.points[index[self._all.nodes[own]]].swapaxes(0, 1)
        normals = np.cross(c - a, d - b)
        areas = np.linalg.norm(normals, axis=1)
        if not areas.max() > 0.0:
            raise self.notes.fail(block.place, f"{block.keyword}: shells without area", "mend the mesh of the sheet")
        rolling = read.rolling(normals[areas.argmax()] / areas.max())
        card = replace(read.card, thickness=part.thickness or read.card.thickness)
        deck.parts[number] = PartCard(part.title, number, number, block.place, block.keyword)
        deck.sections[number] = card
        law = self._materials.get(read.material or part.material)
        material = read_material(law, self._version, self.notes) if law is not None else None
        if material is not None:
            deck.materials[number] = replace(material, rolling=rolling if material.yield_function else None)


_HANDLERS: dict[str, Callable[[RadDeck, Block], None]] = {
    "BEGIN": RadDeck._begin,
    "UNIT": RadDeck._unit,
    "TITLE": RadDeck._title,
    "NODE": RadDeck._nodes,
    "SHELL": RadDeck._shells,
    "SH3N": RadDeck._shells,
    "PART": RadDeck._part,
    "PROP": RadDeck._property,
    "MAT": RadDeck._material,
    "FAIL": RadDeck._failure,
    "FUNCT": RadDeck._curve,
    "ADMESH": RadDeck._adaptive,
}
_LATER = ("RBODY", "IMPVEL", "IMPACC", "IMPDISP", "CLOAD", "BCS", "INTER")
"""What names groups, which may stand below it."""
