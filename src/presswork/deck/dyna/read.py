# SPDX-License-Identifier: Apache-2.0
"""A deck of LS-DYNA, read: nodes, shells, parts, materials, curves, motions, forces and contacts of a forming job.

What only controls numerics or output is dropped and noted; what carries physics and has no counterpart is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from presswork.deck.contents import Contact, Deck, Held, Motion, PartCard, Push, SectionCard
from presswork.deck.dyna.blocks import Block, BlocksOfDeck
from presswork.deck.dyna.cards import leave_fields, leave_rows
from presswork.deck.dyna.contacts import ContactCard, SideCard, read_contact
from presswork.deck.dyna.materials import read_material
from presswork.deck.dyna.mesh import MeshReader
from presswork.deck.fields import FieldError, read_table
from presswork.deck.notes import Fate, Notes
from presswork.mesh.files.dynain import read_layers, read_strains

_SILENT = ("KEYWORD", "COMMENT")
_NUMERICS = ("CONTROL_", "DATABASE_", "HOURGLASS", "INTERFACE_", "TITLE", "DAMPING_", "DEFINE_BOX", "CASE", "SENSOR_")
"""What controls numerics and output."""
_PHYSICS = ("CONTROL_THERMAL_", "SENSOR_CONTROL")
"""What begins as numerics do, and is physics."""
_OUTPUT_OF_FORMING = "CONTROL_FORMING_OUTPUT"
_FULL = {16, 6, 7, 20, -16}
"""ELFORM of shells with several points in their plane."""
_VELOCITY, _ACCELERATION, _DISPLACEMENT = 0, 1, 2
_FOREVER = 1e20


class DynaDeck:
    """Reads one deck; what is in it, and the notes on it."""

    def __init__(self, path: Path, notes: Notes) -> None:
        self.deck = Deck()
        self.notes = notes
        self._path = path
        self._mesh = MeshReader(self.deck, notes)
        self._contacts: list[ContactCard] = []
        self._set_supports: list[tuple[Block, int, tuple[bool, ...]]] = []

    def read(self) -> Deck:
        """Read it all. Raises CaseError."""
        for block in BlocksOfDeck(self._path, notes=self.notes).read():
            try:
                self._take(block)
            except (FieldError, IndexError, ValueError) as error:
                text = "the rows below it are cut short" if isinstance(error, IndexError) else str(error)
                raise self.notes.fail(block.place, f"*{block.name}: {text}", "check the rows below it") from error
        self._finish()
        return self.deck

    def _take(self, block: Block) -> None:
        for start, handler in _HANDLERS.items():
            if block.name == start or block.name.startswith(f"{start}_"):
                if start in _SEEN:
                    fate, text = _SEEN[start]
                    self.notes.see(block.place, f"*{block.name}", text, fate)
                handler(self, block)
                return
        if block.name.startswith(_SILENT):
            self.notes.see(block.place, f"*{block.name}", "how the deck is written, or a comment")
            return
        if block.name.startswith("CONTROL_FORMING_") and not block.name.startswith(_OUTPUT_OF_FORMING):
            remedy = "write the deck with its tools placed and moved by curves"
            self.notes.refuse(block.place, f"*{block.name}", "places or drives tools, or another analysis", remedy)
            return
        if block.name.startswith(_PHYSICS):
            self.notes.refuse(block.place, f"*{block.name}", "heat, or contacts and motions that are switched")
            return
        if block.name.startswith(_NUMERICS):
            self.notes.drop(
                block.place, f"*{block.name}", "controls numerics or output: the program's own take its place"
            )
            return
        self.notes.refuse(block.place, f"*{block.name}", "carries physics that has no counterpart here")

    # --- parts -------------------------------------------------------------------------------------------------------

    def _part(self, block: Block) -> None:
        options = set(block.name.removeprefix("PART").split("_")[1:])
        more = 3 * ("INERTIA" in options) + ("CONTACT" in options) + ("PRINT" in options)
        if unknown := options - {"INERTIA", "CONTACT", "PRINT"}:
            self.notes.refuse(block.place, f"*{block.name}", f"a part of another kind: {', '.join(sorted(unknown))}")
            return
        rows = block.rows()
        leave_rows(block, rows[len(rows) - len(rows) % (2 + more) :], "a row that belongs to no part", self.notes)
        for i in range(0, len(rows) - 1, 2 + more):
            title = rows[i].decode("latin-1").strip()
            number, section, material, state, *_ = (int(value) for value in block.numbers(rows[i + 1]))
            leave_fields(block, rows[i + 1], "pid secid mid eosid -hgid -grav -adpopt -tmid", self.notes)
            leave_rows(block, rows[i + 2 : i + 2 + more], "a row of an option", self.notes)
            self._refuse_second(block, "part", number, self.deck.parts)
            self.deck.parts[number] = PartCard(title or f"part {number}", section, material, block.place)
            if state:
                self.notes.refuse(block.place, f"*{block.name}", f"an equation of state in part {number}")

    def _section(self, block: Block) -> None:
        rows = block.rows()
        if block.name not in ("SECTION_SHELL", "SECTION_SHELL_TITLE"):
            self.notes.refuse(block.place, f"*{block.name}", "a section of another kind", "give it by *SECTION_SHELL")
            return
        step = 3 if block.name.endswith("_TITLE") else 2
        leave_rows(block, rows[len(rows) - len(rows) % step :], "a row that belongs to no section", self.notes)
        for i in range(step - 2, len(rows) - 1, step):
            number, form, _, n_points, _, _, by_layer, _ = block.numbers(rows[i])
            if by_layer:
                self.notes.refuse(block.place, f"*{block.name}", "layers with angles of their own (ICOMP = 1)")
                return
            leave_fields(block, rows[i], "secid -elform -shrf nip -propt -qr icomp -setyp", self.notes)
            leave_fields(block, rows[i + 1], "t1 t2 t3 t4 nloc -marea -idof -edgset", self.notes)
            *sides, offset = block.numbers(rows[i + 1])[:5]
            thickness = sides[0]
            if any(side and abs(side - thickness) > 1e-9 * thickness for side in sides[1:]):
                self.notes.refuse(block.place, f"*{block.name}", "a thickness that differs from corner to corner")
            is_full = int(form) in _FULL
            self._refuse_second(block, "section", int(number), self.deck.sections)
            self.deck.sections[int(number)] = SectionCard(
                thickness, int(n_points) or 2, is_full, block.place, f"*{block.name}", offset=0.5 * offset
            )

    def _material(self, block: Block) -> None:
        name = block.name.removeprefix("MAT_").removesuffix("_TITLE")
        found = read_material(block, name, block.name.endswith("_TITLE"), self.notes)
        if found is not None:
            self._refuse_second(block, "material", found[0], self.deck.materials)
            self.deck.materials[found[0]] = found[1]
            if found[1].is_rigid:
                self.notes.see(block.place, f"*{block.name}", "makes its parts rigid")

    def _refuse_second(self, block: Block, what: str, number: int, known: Mapping[int, object]) -> None:
        if number in known:
            text = f"a second {what} {number}"
            self.notes.refuse(block.place, f"*{block.name}", text, "give each its own number, or take one out")

    def _curve(self, block: Block) -> None:
        if block.name not in ("DEFINE_CURVE", "DEFINE_CURVE_TITLE"):
            self.notes.refuse(block.place, f"*{block.name}", "a curve of another kind", "give it by *DEFINE_CURVE")
            return
        rows = block.rows()[block.name.endswith("_TITLE") :]
        number, _, x_scale, y_scale, x_offset, y_offset, *_ = block.numbers(rows[0])
        leave_fields(block, rows[0], "lcid !sidr sfa sfo offa offo -dattyp -lcint", self.notes)
        self._refuse_second(block, "curve", int(number), self.deck.curves)
        points = read_table([row for row in rows[1:] if row.strip()], (20, 20), block.parameters)
        scale, offset = (x_scale or 1.0, y_scale or 1.0), (x_offset, y_offset)
        self.deck.curves[int(number)] = (points + np.array(offset)) * np.array(scale)
        self.deck.curve_lines[int(number)] = (block.place, f"*{block.name}")

    # --- what tools do -----------------------------------------------------------------------------------------------

    def _motion(self, block: Block) -> None:
        if "_LOCAL" in block.name:
            remedy = "give it along x, y or z by *BOUNDARY_PRESCRIBED_MOTION_RIGID"
            self.notes.refuse(block.place, f"*{block.name}", "a motion along the axes of the body", remedy)
            return
        rows = block.rows()
        if block.name.endswith("_ID"):
            rows = rows[1::2]
        kinds = {_VELOCITY: "velocity", _ACCELERATION: "acceleration", _DISPLACEMENT: "displacement"}
        for row in rows:
            part, freedom, kind, curve, scale, _, death, birth = block.numbers(row)
            leave_fields(block, row, "pid dof vad lcid sf -vid death birth", self.notes)
            axis = {1: 0, 2: 1, 3: 2, 5: 3, 6: 4, 7: 5}.get(int(freedom))
            if axis is None or int(kind) not in kinds:
                text = "a motion along a vector, of a node, or in a frame of its own"
                self.notes.refuse(block.place, f"*{block.name}", text, "give it along x, y or z (DOF 1, 2, 3)")
                continue
            self.deck.motions.append(
                Motion(
                    int(part),
                    axis,
                    kinds[int(kind)],  # type: ignore[arg-type]
                    int(curve),
                    scale or 1.0,
                    birth,
                    death or _FOREVER,
                    block.place,
                    f"*{block.name}",
                )
            )

    def _push(self, block: Block) -> None:
        for row in block.rows():
            part, freedom, curve, scale, frame, *_ = block.numbers(row)
            leave_fields(block, row, "pid dof lcid sf cid -m1 -m2 -m3", self.notes)
            if frame:
                self.notes.refuse(block.place, f"*{block.name}", f"a force in a frame of its own (CID = {frame:g})")
                continue
            if int(freedom) not in (1, 2, 3):
                self.notes.refuse(
                    block.place, f"*{block.name}", "a force that follows, or a moment", "take DOF 1, 2 or 3"
                )
                continue
            self.deck.pushes.append(
                Push(int(part), int(freedom) - 1, int(curve), scale or 1.0, block.place, f"*{block.name}")
            )

    def _contact(self, block: Block) -> None:
        found = read_contact(block, self.notes)
        if found is not None:
            self._contacts.append(found)

    # --- what holds --------------------------------------------------------------------------------------------------

    def _support(self, block: Block) -> None:
        if not block.name.startswith(("BOUNDARY_SPC_SET", "BOUNDARY_SPC_NODE")) or "BIRTH" in block.name:
            self.notes.refuse(block.place, f"*{block.name}", "a support of another kind", "take *BOUNDARY_SPC_SET")
            return
        rows = block.rows()
        for row in rows[1::2] if block.name.endswith("_ID") else rows:
            number, frame, *fixed = block.numbers(row)
            leave_fields(block, row, "nsid cid dofx dofy dofz dofrx dofry dofrz", self.notes)
            if frame:
                self.notes.refuse(block.place, f"*{block.name}", "a support in a frame of its own")
                continue
            held = tuple(bool(each) for each in fixed[:6])
            if "_NODE" in block.name:
                nodes = np.array([int(number)], dtype=np.intp)
                self.deck.held.append(Held(nodes, held, block.place, f"*{block.name}"))
            else:
                self._set_supports.append((block, int(number), held))

    def _node_set(self, block: Block) -> None:
        number, values = self._read_set(block)
        if "ADD" in block.name.split("_"):
            values = [node for each in values for node in self.deck.node_sets.get(each, ())]
        self.deck.node_sets[number] = np.array(values, dtype=np.intp)

    def _part_set(self, block: Block) -> None:
        number, values = self._read_set(block)
        if "ADD" in block.name.split("_"):
            values = [part for each in values for part in self.deck.part_sets.get(each, ())]
        self.deck.part_sets[number] = tuple(values)

    def _read_set(self, block: Block) -> tuple[int, list[int]]:
        options = set(block.name.split("_")[2:])
        if unknown := options - {"LIST", "TITLE", "GENERATE", "ADD"}:
            remedy = f"list its members by *{'_'.join(block.name.split('_')[:2])}_LIST"
            raise self.notes.fail(block.place, f"*{block.name}: a set by {', '.join(sorted(unknown))}", remedy)
        rows = block.rows()[block.name.endswith("_TITLE") :]
        number = int(block.numbers(rows[0])[0])
        leave_fields(block, rows[0], "sid -da1 -da2 -da3 -da4 -solver", self.notes)
        values = [int(value) for row in rows[1:] for value in block.numbers(row) if value]
        known: Mapping[int, object] = self.deck.node_sets if "SET_NODE" in block.name else self.deck.part_sets
        self._refuse_second(block, "set", number, known)
        if "GENERATE" in block.name:
            pairs = zip(values[::2], values[1::2], strict=True)
            values = [label for first, last in pairs for label in range(first, last + 1)]
        return number, values

    def _end(self, block: Block) -> None:
        rows = block.rows()
        self.deck.end = block.numbers(rows[0])[0]
        leave_fields(block, rows[0], "endtim -endcyc -dtmin -endeng -endmas -nosol", self.notes)
        leave_rows(block, rows[1:], "a further row", self.notes)
        self.deck.end_place = block.place
        self.notes.see(block.place, f"*{block.name}", f"the last stage ends at {self.deck.end:g}")

    def _adaptive(self, block: Block) -> None:
        rows = block.rows()
        self.deck.levels = max(0, int(block.numbers(rows[0])[3]) - 1)
        leave_fields(block, rows[0], "-adpfreq -adptol -adpopt maxlvl -tbirth -tdeath -lcadp -ioflag", self.notes)
        leave_rows(block, rows[1:], "a further row", self.notes)
        self.notes.change(block.place, f"*{block.name}", "shells are split where tools bend them (blank.refine)")

    def _title(self, block: Block) -> None:
        self.deck.title = " ".join(row.decode("latin-1").strip() for row in block.rows()).strip()

    def _springback(self, block: Block) -> None:
        self.deck.springs_back = True
        self.notes.change(block.place, f"*{block.name}", "the part is released in the same run ([springback])")

    def _initial(self, block: Block) -> None:
        if block.name not in ("INITIAL_STRESS_SHELL", "INITIAL_STRAIN_SHELL") or block.is_long:
            what = block.name.removeprefix("INITIAL_").lower().replace("_", " ")
            remedy = "write it by *INITIAL_STRESS_SHELL and *INITIAL_STRAIN_SHELL in the standard form, as a dynain"
            self.notes.refuse(
                block.place, f"*{block.name}", f"a state of the formed sheet that is not read ({what})", remedy
            )
            return
        rows = [row.decode("latin-1") for row in block.rows() if row.strip()]
        if block.name == "INITIAL_STRAIN_SHELL":
            self.deck.strains |= read_strains(rows)
            return
        self.deck.layers |= read_layers(rows)
        if any(int(row[30:40].strip() or 0) + int(row[40:50].strip() or 0) for row in rows[:1]):
            text = "history variables beyond the plastic strain (back stresses, damage) are left out"
            self.notes.change(block.place, f"*{block.name}", text)

    def _finish(self) -> None:
        deck, notes = self.deck, self.notes
        self._mesh.finish()
        for part in deck.parts.values():
            if part.section not in deck.sections:
                text = f"a part of section {part.section}, which is missing"
                notes.refuse(part.place, part.keyword, text, "give it by *SECTION_SHELL")
        for card in self._contacts:
            one, other = card.sides
            parts = (self._parts_of(card.block, one), self._parts_of(card.block, other))
            thickness = ((one.thickness, one.scale), (other.thickness, other.scale)) if card.is_thick else None
            keyword = f"*{card.block.name}"
            deck.contacts.append(Contact(parts, card.friction, card.block.place, keyword, thickness))
        for block, number, held in self._set_supports:
            nodes = deck.node_sets.get(number)
            if nodes is None:
                raise notes.fail(block.place, f"*{block.name}: there is no set of nodes {number}", "check its number")
            deck.held.append(Held(nodes, held, block.place, f"*{block.name}"))

    def _parts_of(self, block: Block, side: SideCard) -> tuple[int, ...]:
        """Return the parts of a side of a contact: a set of parts (2), or a part (3)."""
        used = self.deck.shells.part if self.deck.shells is not None else ()
        if side.kind == 3 and (side.number in self.deck.parts or side.number in used):
            return (side.number,)
        if side.kind == 2 and side.number in self.deck.part_sets:
            return self.deck.part_sets[side.number]
        if side.kind in (2, 3):
            what = "part" if side.kind == 3 else "set of parts"
            self.notes.refuse(block.place, f"*{block.name}", f"there is no {what} {side.number}", "check its number")
            return ()
        remedy = "give parts or sets of parts (SSTYP, MSTYP = 3 or 2)"
        self.notes.refuse(block.place, f"*{block.name}", "sides that are segments or nodes", remedy)
        return ()


_HANDLERS: dict[str, Callable[[DynaDeck, Block], None]] = {
    "NODE": lambda deck, block: deck._mesh.take_nodes(block),
    "ELEMENT_SHELL": lambda deck, block: deck._mesh.take_shells(block),
    "PART": DynaDeck._part,
    "SECTION_SHELL": DynaDeck._section,
    "MAT": DynaDeck._material,
    "DEFINE_CURVE": DynaDeck._curve,
    "BOUNDARY_PRESCRIBED_MOTION_RIGID": DynaDeck._motion,
    "LOAD_RIGID_BODY": DynaDeck._push,
    "CONTACT": DynaDeck._contact,
    "BOUNDARY_SPC": DynaDeck._support,
    "SET_NODE": DynaDeck._node_set,
    "SET_PART": DynaDeck._part_set,
    "CONTROL_TERMINATION": DynaDeck._end,
    "CONTROL_ADAPTIVE": DynaDeck._adaptive,
    "TITLE": DynaDeck._title,
    "INTERFACE_SPRINGBACK": DynaDeck._springback,
    "INITIAL": DynaDeck._initial,
}
"""Handlers by the beginning of a keyword, up to an underscore."""
_SEEN: dict[str, tuple[Fate, str]] = {
    "PART": ("dropped", "no part of shells"),
    "SECTION_SHELL": ("dropped", "of rigid tools, whose thickness does not count, or of no part"),
    "MAT": ("dropped", "belongs to no sheet that is imported"),
    "DEFINE_CURVE": ("dropped", "nothing that is imported refers to it"),
    "BOUNDARY_PRESCRIBED_MOTION_RIGID": ("dropped", "moves no tool that is imported"),
    "LOAD_RIGID_BODY": ("dropped", "pushes no tool that is imported"),
    "CONTACT": ("dropped", "adds no tool: it joins none with the sheet, or one that has a contact above"),
    "BOUNDARY_SPC": ("dropped", "holds nothing"),
    "SET_NODE": ("kept", "a set, for keywords that name it"),
    "SET_PART": ("kept", "a set, for keywords that name it"),
    "TITLE": ("kept", "the case's title"),
    "INITIAL": ("kept", "stresses or strains that the sheet begins with (blank.dynain)"),
}
"""What becomes of a block of which nothing else is noted."""
