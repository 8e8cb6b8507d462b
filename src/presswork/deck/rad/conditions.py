# SPDX-License-Identifier: Apache-2.0
"""What a starter's deck of OpenRadioss does to its rigid bodies and nodes: motions, forces, supports, contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from presswork.deck.contents import Contact, Deck, Held, Motion, Push, Shells
from presswork.deck.fields import FieldError
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_row
from presswork.deck.rad.cards import leave_fields, leave_rows
from presswork.deck.rad.groups import Groups
from presswork.model import IndexArray

_AXES = {"X": 0, "Y": 1, "Z": 2, "XX": 3, "YY": 4, "ZZ": 5}
_KINDS: dict[str, Literal["velocity", "acceleration", "displacement"]] = {
    "IMPVEL": "velocity",
    "IMPACC": "acceleration",
    "IMPDISP": "displacement",
}
_FOREVER = 1e20


@dataclass(frozen=True)
class RigidBody:
    """A rigid body: its main node, all its nodes, and the parts that they are."""

    main: int
    nodes: IndexArray
    parts: tuple[int, ...]

    @property
    def part(self) -> int:
        """The part that stands for all of them."""
        return self.parts[0]


class Conditions:
    """Reads the keywords that name groups of nodes, once nodes, parts and rigid bodies are known."""

    def __init__(self, deck: Deck, notes: Notes, groups: Groups, shells: Shells, bodies: Sequence[RigidBody]) -> None:
        self.deck, self.notes = deck, notes
        self._groups, self._shells, self._bodies = groups, shells, bodies
        self._handlers = {
            **dict.fromkeys(_KINDS, self._motion),
            "CLOAD": self._push,
            "BCS": self._support,
            "INTER": self._contact,
        }

    def take(self, block: Block) -> None:
        """Take one of them into the deck."""
        self._handlers[block.words[0]](block)

    def _bodies_of(self, nodes: IndexArray) -> list[RigidBody]:
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
        leave_fields(block, rows[0], "fct_ID Dir skew_ID sens_ID grnd_ID frame_ID Icoor", self.notes)
        leave_rows(block, rows[2:], "further rows", self.notes)
        if len(rows) > 1:
            leave_fields(block, rows[1], "Ascale:20 Fscale:20 Tstart:20 Tstop:20", self.notes)
        along, scale, begin, end = read_row(rows[1] if len(rows) > 1 else b"", 20, 20, 20, 20)
        bodies = self._driven(block, group)
        number = self._scaled(curve, along, begin)
        for body in bodies:
            motion = (kind, number, scale or 1.0, begin, end or _FOREVER, block.place, block.keyword)
            self.deck.motions.append(Motion(body.part, _AXES[direction], *motion))

    def _push(self, block: Block) -> None:
        rows = block.titled()[1]
        row = rows[0]
        leave_rows(block, rows[1:], "further rows", self.notes)
        direction = row[10:20].decode("latin-1").strip().upper()
        curve, _, skew, sensor, group, _, along, scale = read_row(row[:10] + b" " * 10 + row[20:], *[10] * 6, 20, 20)
        if skew or sensor or direction not in ("X", "Y", "Z"):
            text = "a moment, or a force in a frame of its own or by a sensor"
            self.notes.refuse(block.place, block.keyword, text, "give it along X, Y or Z of the deck")
            return
        layout = "fct_ID Dir skew_ID sens_ID grnd_ID - Ascale:20 Fscale:20"
        leave_fields(block, row, layout, self.notes)
        nodes = self._groups.nodes("GRNOD", int(group), self._shells)
        for body in self._driven(block, int(group)):
            n = int(np.isin(body.nodes, nodes).sum())
            number = self._scaled(int(curve), along, 0.0)
            push = Push(body.part, _AXES[direction], number, n * (scale or 1.0), block.place, block.keyword)
            self.deck.pushes.append(push)

    def _driven(self, block: Block, group: int) -> list[RigidBody]:
        nodes = self._groups.nodes("GRNOD", group, self._shells)
        bodies = self._bodies_of(nodes)
        others = np.setdiff1d(nodes, np.concatenate([[0], *(body.nodes for body in bodies)]))
        if bodies and len(others):
            text = f"{len(others)} nodes of no rigid body that is driven, the first {others[0]}"
            self.notes.leave(block.place, block.keyword, text)
        if not bodies:
            text = "drives nodes that are not a rigid body"
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
        leave_fields(block, row, "fixed skew_ID grnod_ID", self.notes)
        if len(fixed) != 6:
            raise FieldError(f"`{row[:10].decode('latin-1')}` is not a row of six digits")
        if skew:
            self.notes.refuse(block.place, block.keyword, "a support in a frame of its own")
            return
        if any(fixed):
            nodes = self._groups.nodes("GRNOD", group, self._shells)
            self.deck.held.append(Held(nodes, fixed, block.place, block.keyword))

    def _contact(self, block: Block) -> None:
        kind = block.words[1] if len(block.words) > 1 else ""
        if kind not in ("TYPE7", "TYPE21"):
            self.notes.refuse(block.place, block.keyword, "a contact of another kind", "take TYPE7 or TYPE21")
            return
        rows = block.titled()[1]
        leave_fields(block, rows[0], "s m -Istf !Ithe -Igap - -Ibag -Idel Icurv -Iadm", self.notes)
        second, main, _, _, _, _, _, _, curved, _ = (int(each) for each in read_row(rows[0], *[10] * 10))
        last = 4 if kind == "TYPE7" and curved in (1, 2) else 3
        leave_rows(block, rows[1:last], "gaps and stiffnesses", self.notes)
        leave_fields(block, rows[last], "-Stfac:20 Fric:20 Gap:20 Tstart:20 Tstop:20", self.notes)
        leave_rows(block, rows[last + 1 : last + 2], "numerics", self.notes)
        if len(rows) > last + 2:
            layout = "Ifric -Ifiltr -Xfreq:20 -Iform sens_ID fct_ID -AscaleF:20 fric_ID"
            leave_fields(block, rows[last + 2], layout, self.notes)
        leave_rows(block, rows[last + 3 :], "factors of friction", self.notes)
        _, friction, gap, begin, end = read_row(rows[last], *[20] * 5)
        law, sensor, table = 0.0, 0.0, 0.0
        if len(rows) > last + 2:
            law, _, _, _, sensor, curve, _, named = read_row(rows[last + 2], 10, 10, 20, 10, 10, 10, 20, 10)
            table = curve or named
        if sensor or table or begin or 0.0 < end < (self.deck.end or 0.0):
            text = "a contact for a part of the time, by a sensor, or with a table of friction"
            self.notes.refuse(block.place, block.keyword, text)
        if law:
            self.notes.change(
                block.place, block.keyword, f"one coefficient of friction, Fric; Ifric = {law:g} is left out"
            )
        if not 0.0 <= friction < 1.0:
            self.notes.refuse(block.place, block.keyword, f"friction by Fric = {friction:g}", "give one below 1")
        if gap:
            self.notes.change(block.place, block.keyword, f"a gap of {gap:g}: the sheet touches with its faces")
        room = "GRNOD" if kind == "TYPE7" else "SURF"
        found = (self._groups.parts(room, second, self._shells), self._groups.parts("SURF", main, self._shells))
        stands = {each: body.part for body in self._bodies for each in body.parts}
        sides = (tuple(stands.get(n, n) for n in found[0]), tuple(stands.get(n, n) for n in found[1]))
        rigid = {body.part for body in self._bodies}
        if all(set(side) - rigid for side in sides):
            self.notes.refuse(block.place, block.keyword, "a sheet that touches itself")
        self.deck.contacts.append(Contact(sides, (friction, 0.0), block.place, block.keyword))
