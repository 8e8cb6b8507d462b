# SPDX-License-Identifier: Apache-2.0
"""A starter's deck of OpenRadioss, read: shells, rigid bodies, what drives them, contact and the material of a sheet.

Materials and properties are read for the sheet alone: those of parts in rigid bodies do not matter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from presswork.deck.contents import Contact, Deck, Held, MaterialCard, Motion, PartCard, Push, Shells
from presswork.deck.fields import FieldError, read_table
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_blocks, read_row
from presswork.deck.rad.engine import read_engine, take_engine_block
from presswork.deck.rad.groups import Groups
from presswork.deck.rad.keywords import SEEN, STARTER
from presswork.deck.rad.materials import read_material
from presswork.deck.rad.sections import read_property
from presswork.deck.units import Units, name_units
from presswork.model import IndexArray

_OLDEST = 51
"""The first version whose fields are 10 and 20 characters wide."""
_AXES = {"X": 0, "Y": 1, "Z": 2, "XX": 3, "YY": 4, "ZZ": 5}
_KINDS: dict[str, Literal["velocity", "acceleration", "displacement"]] = {
    "IMPVEL": "velocity",
    "IMPACC": "acceleration",
    "IMPDISP": "displacement",
}
_FOREVER = 1e20


@dataclass(frozen=True)
class _Part:
    title: str
    section: int
    material: int
    thickness: float
    block: Block


@dataclass(frozen=True)
class _Body:
    """A rigid body: its main node, all its nodes, and the parts that they are."""

    main: int
    nodes: IndexArray
    parts: tuple[int, ...]

    @property
    def part(self) -> int:
        """The part that stands for all of them."""
        return self.parts[0]


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
        self._groups = Groups()
        self._later: list[Block] = []
        self._bodies: list[_Body] = []
        self._all = Shells(np.empty(0, dtype=np.intp), np.empty((0, 4), dtype=np.intp), np.empty(0))

    def read(self) -> Deck:
        """Read it all, with the engine's files beside it. Raises CaseError."""
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
            self.notes.drop(block.place, block.keyword, "steers numerics or output, or matters only where it is named")
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
        self.deck.units = self._name_units(rows[1] if len(rows) > 1 else b"")
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
        self.deck.title = block.titled()[0]

    def _nodes(self, block: Block) -> None:
        self._check_units(block, 0)
        self.deck.node_place = self.deck.node_place or block.place
        n = 0
        for rows in block.pieces():
            table = read_table(rows, (10, 20, 20, 20), {})
            self._labels.append(table[:, 0].astype(np.intp))
            self._points.append(table[:, 1:].copy())
            n += len(table)
        self.notes.see(block.place, block.keyword, f"{n} nodes")

    def _shells(self, block: Block) -> None:
        n = 0
        for rows in block.pieces():
            table = read_table(rows, (10,) * 6 + (20, 20), {})
            if block.words[0] == "SH3N":
                table[:, 4] = 0.0
            table[:, 4] = np.where(table[:, 4] == 0, table[:, 3], table[:, 4])
            if table[:, 6].any():
                self.notes.refuse(block.place, block.keyword, "axes of the material turned cell by cell (Phi)")
            self._rows.append((block.number, table[:, [1, 2, 3, 4, 7]]))
            n += len(table)
        self.notes.see(block.place, block.keyword, f"{n} shells of part {block.number}")

    def _part(self, block: Block) -> None:
        title, rows = block.titled()
        section, material, _, thickness = read_row(rows[0], 10, 10, 10, 20)
        name = title or f"part {block.number}"
        self._parts[block.number] = _Part(name, int(section), int(material), thickness, block)

    def _property(self, block: Block) -> None:
        self._check_units(block, 1)
        self._properties[block.number] = block

    def _material(self, block: Block) -> None:
        self._check_units(block, 1)
        self._materials[block.number] = block

    def _failure(self, block: Block) -> None:
        self.notes.change(block.place, block.keyword, "deletes no cells: look at the forming limit")

    def _curve(self, block: Block) -> None:
        rows = [row for row in block.titled()[1] if row.strip()]
        self.deck.curves[block.number] = read_table(rows, (20, 20), {})
        self.deck.curve_lines[block.number] = (block.place, block.keyword)

    def _adaptive(self, block: Block) -> None:
        if "GLOBAL" in block.words:
            self.deck.levels = int(read_row(block.rows()[0], 10)[0])
            self.notes.change(block.place, block.keyword, "shells are split where tools bend them (blank.refine)")

    # --- the whole ---------------------------------------------------------------------------------------------------

    def _finish(self) -> None:
        deck = self.deck
        deck.labels, deck.points = np.concatenate(self._labels), np.concatenate(self._points)
        table = np.concatenate([rows for _, rows in self._rows])
        part = np.concatenate([np.full(len(rows), number, dtype=np.intp) for number, rows in self._rows])
        self._labels, self._points, self._rows = [], [], []  # a million nodes are not kept twice
        own = np.where(table[:, 4] > 0.0, table[:, 4], np.nan)
        self._all = Shells(part, table[:, :4].astype(np.intp), own)
        for block in self._later:
            if block.words[0] == "RBODY":
                self._try(self._body, block)
        for body in self._bodies:
            part = np.where(np.isin(part, body.parts), body.part, part)
        deck.shells = replace(self._all, part=part)
        for number, each in self._parts.items():
            if number not in {each for body in self._bodies for each in body.parts}:
                self._try(self._sheet, each.block)
        for block in self._later:
            if block.words[0] != "RBODY":
                self._try(_LATER[block.words[0]].__get__(self), block)

    def _body(self, block: Block) -> None:
        """Find the part that a rigid body is; several parts become one."""
        row = block.titled()[1][0]
        main, sensor, _, _, _, group, _, _, surface = (
            int(each) for each in read_row(row, 10, 10, 10, 10, 20, *[10] * 4)
        )
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
        self._bodies.append(_Body(main, nodes, parts))

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
        a, b, c, d = deck.points[index[self._all.nodes[own][0]]]
        normal = np.cross(c - a, d - b)
        rolling = read.rolling(normal / np.linalg.norm(normal))
        card = replace(read.card, thickness=part.thickness or read.card.thickness)
        deck.parts[number] = PartCard(part.title, number, number, block.place, block.keyword)
        deck.sections[number] = card
        law = self._materials.get(read.material or part.material)
        material = read_material(law, self._version, self.notes) if law is not None else None
        if material is not None:
            deck.materials[number] = replace(material, rolling=rolling if material.yield_function else None)

    def _bodies_of(self, nodes: IndexArray) -> list[_Body]:
        """Return the rigid bodies that a group drives: by their main node, or all their nodes."""
        return [body for body in self._bodies if body.main in nodes or np.isin(body.nodes, nodes).all()]

    def _motion(self, block: Block) -> None:
        rows = block.titled()[1]
        direction, kind = rows[0][10:20].decode("latin-1").strip().upper(), _KINDS[block.words[0]]
        curve, _, skew, sensor, group, frame, around = (
            int(each) for each in read_row(rows[0][:10] + b" " * 10 + rows[0][20:], *[10] * 7)
        )
        if skew or sensor or frame or around or direction not in _AXES:
            text = "a motion in a frame of its own, by a sensor, or along a direction that is not known"
            self.notes.refuse(block.place, block.keyword, text, "give it along X, Y or Z of the deck")
            return
        along, scale, begin, end = read_row(rows[1] if len(rows) > 1 else b"", 20, 20, 20, 20)
        bodies = self._driven(block, group)
        number = self._scaled(curve, along, begin)
        for body in bodies:
            motion = (kind, number, scale or 1.0, begin, end or _FOREVER, block.place, block.keyword)
            self.deck.motions.append(Motion(body.part, _AXES[direction], *motion))

    def _push(self, block: Block) -> None:
        row = block.titled()[1][0]
        direction = row[10:20].decode("latin-1").strip().upper()
        curve, _, skew, sensor, group, _, along, scale = read_row(row[:10] + b" " * 10 + row[20:], *[10] * 6, 20, 20)
        if skew or sensor or direction not in ("X", "Y", "Z"):
            text = "a moment, or a force in a frame of its own or by a sensor"
            self.notes.refuse(block.place, block.keyword, text, "give it along X, Y or Z of the deck")
            return
        nodes = self._groups.nodes("GRNOD", int(group), self._all)
        for body in self._driven(block, int(group)):
            n = int(np.isin(body.nodes, nodes).sum())
            number = self._scaled(int(curve), along, 0.0)
            push = Push(body.part, _AXES[direction], number, n * (scale or 1.0), block.place, block.keyword)
            self.deck.pushes.append(push)

    def _driven(self, block: Block, group: int) -> list[_Body]:
        bodies = self._bodies_of(self._groups.nodes("GRNOD", group, self._all))
        if not bodies:
            text = "drives nodes that are no rigid body"
            self.notes.refuse(block.place, block.keyword, text, "drive the main nodes of /RBODY")
        return bodies

    def _scaled(self, number: int, along: float, begin: float) -> int:
        """Return the number of a curve whose times are scaled, and counted from where it begins to act."""
        along = along or 1.0
        curve = self.deck.curves.get(number)
        if curve is None or (along == 1.0 and not begin):
            return number
        found = max(self.deck.curves) + 1
        self.deck.curve_lines[found] = self.deck.curve_lines[number]
        self.deck.curves[found] = np.column_stack([curve[:, 0] * along - begin, curve[:, 1]])
        return found

    def _support(self, block: Block) -> None:
        row = block.titled()[1][0]
        fixed = tuple(each == "1" for each in row[:10].decode("latin-1") if each in "01")
        skew, group = (int(each) for each in read_row(row[10:], 10, 10))
        if len(fixed) != 6:
            raise FieldError(f"`{row[:10].decode('latin-1')}` is no row of six digits")
        if skew:
            self.notes.refuse(block.place, block.keyword, "a support in a frame of its own")
            return
        if any(fixed):
            nodes = self._groups.nodes("GRNOD", group, self._all)
            self.deck.held.append(Held(nodes, fixed, block.place, block.keyword))

    def _contact(self, block: Block) -> None:
        kind = block.words[1] if len(block.words) > 1 else ""
        if kind not in ("TYPE7", "TYPE21"):
            self.notes.refuse(block.place, block.keyword, "a contact of another kind", "take TYPE7 or TYPE21")
            return
        rows = block.titled()[1]
        second, main, _, heat, _, _, _, _, curved, _ = (int(each) for each in read_row(rows[0], *[10] * 10))
        last = 4 if kind == "TYPE7" and curved in (1, 2) else 3
        _, friction, gap, begin, end = read_row(rows[last], *[20] * 5)
        law, sensor, table = 0.0, 0.0, 0.0
        if len(rows) > last + 2:
            law, _, _, _, sensor, curve, _, named = read_row(rows[last + 2], 10, 10, 20, 10, 10, 10, 20, 10)
            table = curve or named
        if heat or sensor or table or begin or 0.0 < end < (self.deck.end or 0.0):
            text = "a contact with heat, for a part of the time, by a sensor, or with a table of friction"
            self.notes.refuse(block.place, block.keyword, text)
        if law:
            self.notes.change(
                block.place, block.keyword, f"one coefficient of friction, Fric; Ifric = {law:g} is left out"
            )
        if gap:
            self.notes.change(block.place, block.keyword, f"a gap of {gap:g}: the sheet touches with its faces")
        room = "GRNOD" if kind == "TYPE7" else "SURF"
        found = (self._groups.parts(room, second, self._all), self._groups.parts("SURF", main, self._all))
        stands = {each: body.part for body in self._bodies for each in body.parts}
        sides = (tuple(stands.get(n, n) for n in found[0]), tuple(stands.get(n, n) for n in found[1]))
        rigid = {body.part for body in self._bodies}
        if all(set(side) - rigid for side in sides):
            self.notes.refuse(block.place, block.keyword, "a sheet that touches itself")
        self.deck.contacts.append(Contact(sides, (friction, 0.0), block.place, block.keyword))


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
_LATER: dict[str, Callable[[RadDeck, Block], None]] = {
    "RBODY": RadDeck._body,
    "IMPVEL": RadDeck._motion,
    "IMPACC": RadDeck._motion,
    "IMPDISP": RadDeck._motion,
    "CLOAD": RadDeck._push,
    "BCS": RadDeck._support,
    "INTER": RadDeck._contact,
}
"""What names groups, which may stand below it."""
