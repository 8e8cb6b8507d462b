# SPDX-License-Identifier: Apache-2.0
"""A deck of Abaqus, read: parts and instances, shells, rigid bodies, materials, steps and contact of a forming job."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from presswork.deck.abaqus.assembly import POINTS, Assembly, PartMesh
from presswork.deck.abaqus.contacts import Contacts
from presswork.deck.abaqus.materials import MaterialReader, read_orientation
from presswork.deck.abaqus.parameters import check_parameters
from presswork.deck.abaqus.sections import read_section
from presswork.deck.abaqus.steps import Steps
from presswork.deck.contents import Deck, PartCard, Shells
from presswork.deck.keyword_file import explain_unreadable
from presswork.deck.notes import DROPPED, KEPT, Fate, Notes
from presswork.keyword_file import Place
from presswork.mesh.files.abaqus_blocks import Block, DataError, read_blocks
from presswork.model import FloatArray, IndexArray

_SILENT = (
    "PREPRINT",
    "END PART",
    "END ASSEMBLY",
    "ASSEMBLY",
)
_NUMERICS = (
    "OUTPUT",
    "NODE OUTPUT",
    "ELEMENT OUTPUT",
    "CONTACT OUTPUT",
    "ENERGY OUTPUT",
    "INCREMENTATION OUTPUT",
    "RESTART",
    "MONITOR",
    "BULK VISCOSITY",
    "FIXED MASS SCALING",
    "VARIABLE MASS SCALING",
    "SECTION CONTROLS",
    "CONTROLS",
    "SOLUTION CONTROLS",
    "CONTACT CONTROLS",
    "FILE OUTPUT",
    "EL FILE",
    "NODE FILE",
    "EL PRINT",
    "NODE PRINT",
    "DIAGNOSTICS",
    "MASS",
    "ROTARY INERTIA",
    "TRANSVERSE SHEAR STIFFNESS",
)
"""What controls numerics and output."""
_CHORD = 1e-4
"""How far chords lie off the arcs of analytical surfaces, over the sheet's size."""


class AbaqusDeck:
    """Reads one deck; what is in it, and the notes on it."""

    def __init__(self, path: Path, notes: Notes) -> None:
        self.notes = notes
        self._path = path
        self._assembly = Assembly()
        self._part = ""
        self._titles: dict[str, str] = {}
        self._materials = MaterialReader(notes)
        self._steps = Steps(notes)
        self._title = ""
        self._sections: list[tuple[str, Block]] = []
        self._axes: dict[tuple[str, str], FloatArray | None] = {}
        """Axis 1 that shells project, by part and name."""
        self._rigid: list[tuple[str, Block]] = []
        self._contacts = Contacts(notes)
        self._node_place: Place | None = None
        self._node_blocks: list[tuple[Block, PartMesh, FloatArray]] = []

    def read(self) -> Deck:
        """Read it all. Raises CaseError."""
        with explain_unreadable():
            for block in read_blocks(self._path):
                try:
                    self._take(block)
                except (DataError, IndexError, ValueError, KeyError) as error:
                    raise self._explain(block.place, block.name, error) from error
        return self._finish()

    def _explain(self, place: Place, name: str, error: Exception) -> Exception:
        if isinstance(error, KeyError):
            return self.notes.fail(place, f"*{name}: there is no {error.args[0]}", "check its name")
        text = "the rows below it are cut short" if isinstance(error, IndexError) else str(error)
        return self.notes.fail(place, f"*{name}: {text}", "check the rows below it")

    def _take(self, block: Block) -> None:
        if block.name in _SEEN:
            fate, text = _SEEN[block.name]
            self.notes.see(block.place, f"*{block.name}", text, fate)
        check_parameters(block, self.notes)
        handler = _HANDLERS.get(block.name)
        if handler is not None:
            handler(self, block)
        elif block.name in ("NSET", "ELSET") and "INSTANCE" in block.parameters:
            self._assembly.add_set(block)
        elif self._mesh().take(block):
            self._see_mesh(block)
        elif self._materials.take(block) or self._steps.take(block) or self._contacts.take(block):
            return
        elif block.name in _NUMERICS:
            self.notes.drop(block.place, f"*{block.name}", "controls numerics or output: presswork has its own")
        elif block.name in _SILENT:
            self.notes.see(block.place, f"*{block.name}", f"structure of the deck {block.name_of('NAME')}".strip())
        else:
            self.notes.refuse(block.place, f"*{block.name}", "carries physics that has no counterpart here")

    def _see_mesh(self, block: Block) -> None:
        """Note what became of nodes, elements, sets and surfaces."""
        text, kind, fate = "a set or surface, for keywords that name it", block.name_of("TYPE"), KEPT
        if block.name == "SYSTEM":
            text = "the system of the nodes below it"
        elif block.name == "SURFACE":
            text = f"a surface, for contacts that name it: {'; '.join(', '.join(row) for row in block.rows()[:3])}"
        elif block.name == "NODE":
            text = f"{len(self._mesh().nodes[-1])} nodes"
            self._node_place = self._node_place or block.place
            self._node_blocks.append((block, self._mesh(), self._mesh().nodes[-1][:, 0]))
            if block.widest() > 4:
                self.notes.leave(block.place, "*NODE", "fields after the coordinates (normals)")
        elif block.name == "ELEMENT" and kind in POINTS:
            text, fate = "masses of points: tools move by the stages", DROPPED
        elif block.name == "ELEMENT" and kind in self._mesh().others:
            text, fate = f"elements {kind}, which are not read", DROPPED
        elif block.name == "ELEMENT":
            text = f"{len(self._mesh().shells[-1])} shells {kind}"
        self.notes.see(block.place, f"*{block.name}", text, fate)

    def _mesh(self) -> PartMesh:
        return self._assembly.parts[self._part] if self._part else self._assembly.loose

    # --- keywords ----------------------------------------------------------------------------------------------------

    def _include(self, block: Block) -> None:
        self.notes.see(block.place, "*INCLUDE", "lines of the file are listed by its name")

    def _parameter(self, block: Block) -> None:
        fault = "*PARAMETER: parameters are expressions, which are not evaluated"
        raise self.notes.fail(block.place, fault, "write their values into the deck")

    def _heading(self, block: Block) -> None:
        self._title = " ".join(word for row in block.rows() for word in row if word)

    def _begin_part(self, block: Block) -> None:
        self._part = block.name_of("NAME")
        if self._part in self._assembly.parts:
            raise DataError(f"a second part {self._part}")
        self._assembly.parts[self._part] = PartMesh()

    def _end_part(self, block: Block) -> None:
        self._part = ""

    def _instance(self, block: Block) -> None:
        name, part = block.name_of("NAME"), block.name_of("PART")
        if self._assembly.add(name, part, block.rows()):
            self._part = name
            self._titles[name] = part

    def _section(self, block: Block) -> None:
        if "COMPOSITE" in block.parameters:
            self.notes.refuse(block.place, f"*{block.name}", "a sheet of several layers")
            return
        self._sections.append((self._part, block))

    def _orientation(self, block: Block) -> None:
        axis = read_orientation(block, self.notes)
        self._axes[self._part, block.name_of("NAME")] = axis
        if axis is not None:
            self.notes.keep(block.place, "*ORIENTATION", "the rolling direction, if the material has one")

    def _rigid_body(self, block: Block) -> None:
        self._rigid.append((self._part, block))

    # --- the whole ---------------------------------------------------------------------------------------------------

    def _draw_surfaces(self) -> None:
        """Make shells of the analytical surfaces of rigid bodies, past the sheet and with its size."""
        labels, points = self._assembly.all_nodes()
        used = np.isin(labels, self._assembly.all_shells()[:, 1:])
        sheet = points[used]
        if not len(sheet):
            return
        tolerance = _CHORD * float(np.linalg.norm(np.ptp(sheet, axis=0)))
        for number, (owner, block) in enumerate(self._rigid, start=2):
            name = block.name_of("ANALYTICAL SURFACE")
            if not name:
                continue
            mesh = self._assembly.parts[owner] if owner else self._assembly.loose
            if name not in mesh.drawn:
                raise self.notes.fail(block.place, f"*RIGID BODY: there is no surface {name}", "check its name")
            if mesh.drawn[name].kind == "SEGMENTS":
                fault = "a profile in the plane (TYPE=SEGMENTS), where shells in space are read"
                self.notes.refuse(block.place, "*RIGID BODY", fault, "give TYPE=CYLINDER or REVOLUTION")
                continue
            own = next(i for i in self._assembly.instances.values() if i.mesh is mesh)
            try:
                mesh.draw(name, number, (sheet - own.shift) @ own.turn, tolerance)
            except (DataError, ValueError) as error:
                raise self._explain(block.place, block.name, error) from error
            text = f"{name}, an analytical surface, is a mesh whose chords lie within {tolerance:.3g} of its arcs"
            self.notes.change(block.place, "*RIGID BODY", text)

    def _finish(self) -> Deck:
        try:
            self._assembly.all_nodes()
        except ValueError as error:
            raise self.notes.fail(None, "no *NODE in it", "give the whole deck, with its files") from error
        self._check_meshes()
        self._draw_surfaces()
        labels, points = self._assembly.all_nodes()
        order = np.argsort(labels)
        labels, points = labels[order], points[order]
        shells = self._assembly.all_shells()
        deck = Deck(title=self._title, node_place=self._node_place, labels=np.arange(1, len(labels) + 1), points=points)
        deck.materials, numbers = self._materials.finish()
        nodes = np.searchsorted(labels, shells[:, 1:]) + 1
        is_known = np.asarray(np.isin(shells[:, 1:], labels)).all(axis=1)
        part = np.zeros(len(shells), dtype=np.intp)
        self._number_sheets(deck, shells[:, 0], part, numbers)
        bodies = self._number_tools(deck, shells[:, 0], part)
        if not np.asarray(is_known)[part > 0].all():
            raise self.notes.fail(None, "shells of nodes that the deck does not have", "the deck is cut short")
        own = part > 0
        deck.shells = Shells(part[own], nodes[own], np.full(int(own.sum()), np.nan))
        self._contacts.finish(deck, self._assembly, shells[:, 0], part, self._steps.is_explicit)
        self._steps.finish(deck, self._assembly, bodies, labels)
        return deck

    def _check_meshes(self) -> None:
        """Note nodes of no shell and members of sets that are not there. Raises CaseError for labels given twice."""
        for block, mesh, labels in self._node_blocks:
            if not np.isin(labels, mesh.used_nodes()).any():
                text = (
                    f"{len(labels)} nodes of no shell: reference points of tools, which move by the stages, or unused"
                )
                self.notes.see(block.place, "*NODE", text, "dropped")
        for mesh in (self._assembly.loose, *self._assembly.parts.values()):
            fault = mesh.find_double()
            if fault:
                raise self.notes.fail(self._node_place, fault, "give each its own number in its part")
        for block, listed, known in self._assembly.list_sets():
            missing = sorted(set(listed) - known)
            if missing:
                text = f"labels that are not there: {', '.join(map(str, missing[:5]))}"
                self.notes.leave(block.place, f"*{block.name}", text)

    def _number_sheets(self, deck: Deck, cells: IndexArray, part: IndexArray, numbers: dict[str, int]) -> None:
        """Give each section, in each instance of its part, a number of a part of the deck."""
        for owner, block in self._sections:
            try:
                own = self._assembly.sets_in_instances(owner, block.name_of("ELSET"))
                material = numbers[block.name_of("MATERIAL")]
                section = read_section(block, self.notes)
            except (DataError, IndexError, KeyError) as error:
                raise self._explain(block.place, block.name, error) from error
            if deck.materials[material].yield_function:
                rolling = self._find_rolling(owner, block)
                deck.materials[material] = replace(deck.materials[material], rolling=rolling)
            for labels in own.values():
                number = len(deck.parts) + 1
                part[np.isin(cells, labels)] = number
                title = owner or block.name_of("ELSET")
                deck.parts[number] = PartCard(title.lower(), number, material, block.place, f"*{block.name}")
                deck.sections[number] = section

    def _find_rolling(self, owner: str, block: Block) -> tuple[float, float, float]:
        """Return what shells of a section project as their axis 1, in the assembly."""
        name = block.name_of("ORIENTATION")
        if not name:
            return (1.0, 0.0, 0.0)
        if (owner, name) not in self._axes and ("", name) not in self._axes:
            raise self._explain(block.place, block.name, KeyError(f"orientation {name}"))
        own = self._axes.get((owner, name))
        if own is None:
            own = self._axes.get(("", name))
        elif owner:
            mesh = self._assembly.parts[owner]
            own = next(i.turn for i in self._assembly.instances.values() if i.mesh is mesh) @ own
        x, y, z = (float(each) for each in (own if own is not None else (1.0, 0.0, 0.0)))
        return (x, y, z)

    def _number_tools(self, deck: Deck, cells: IndexArray, part: IndexArray) -> dict[int, list[int]]:
        """Give rigid bodies numbers of parts; return the labels of their reference nodes by number."""
        rigid = self._materials.rigid
        deck.materials[rigid] = self._materials.make_rigid(self._rigid[0][1].place if self._rigid else Place("", 0))
        bodies: dict[int, list[int]] = {}
        number = max(deck.parts, default=0)  # parts that become rigid leave gaps
        for owner, block in self._rigid:
            try:
                found = self._list_bodies(owner, block)
            except KeyError as error:
                raise self._explain(block.place, block.name, error) from error
            for title, own, reference in found:
                number += 1
                bodies[number] = reference
                is_own = np.isin(cells, own)
                replaced = {int(each) for each in np.unique(part[is_own]) if each}
                part[is_own] = number
                card = PartCard(title.lower(), 0, rigid, block.place, f"*{block.name}")
                for each in replaced - {int(left) for left in np.unique(part)}:
                    card = replace(card, section=deck.parts.pop(each).section)
                deck.parts[number] = card
        return bodies

    def _list_bodies(self, owner: str, block: Block) -> list[tuple[str, list[int], list[int]]]:
        """Return title, cells and reference nodes of a rigid body, in each instance of its part. Raises KeyError."""
        name = block.name_of("ELSET") or block.name_of("ANALYTICAL SURFACE")
        reference, found = block.name_of("REF NODE"), self._assembly.sets_in_instances(owner, name)
        if not owner:
            return [(name.rpartition(".")[2], found[""], self._assembly.nodes_of(reference))]
        bodies = []
        for instance, own in found.items():
            title = self._titles.get(owner, owner) if len(found) == 1 else instance
            bodies.append((title, own, self._assembly.nodes_of(f"{instance}.{reference}")))
        return bodies


_HANDLERS: dict[str, Callable[[AbaqusDeck, Block], None]] = {
    "INCLUDE": AbaqusDeck._include,
    "PARAMETER": AbaqusDeck._parameter,
    "HEADING": AbaqusDeck._heading,
    "PART": AbaqusDeck._begin_part,
    "END PART": AbaqusDeck._end_part,
    "INSTANCE": AbaqusDeck._instance,
    "END INSTANCE": AbaqusDeck._end_part,
    "SHELL SECTION": AbaqusDeck._section,
    "SHELL GENERAL SECTION": AbaqusDeck._section,
    "ORIENTATION": AbaqusDeck._orientation,
    "RIGID BODY": AbaqusDeck._rigid_body,
}
_SEEN: dict[str, tuple[Fate, str]] = {
    "HEADING": ("kept", "the case's title"),
    "PART": ("kept", "nodes and shells of a part"),
    "END PART": ("kept", "structure of the deck"),
    "INSTANCE": ("kept", "where a part lies"),
    "END INSTANCE": ("kept", "structure of the deck"),
    "NSET": ("kept", "a set, for keywords that name it"),
    "ELSET": ("kept", "a set, for keywords that name it"),
    "SHELL SECTION": ("dropped", "of rigid bodies, or of no shells"),
    "SHELL GENERAL SECTION": ("dropped", "of rigid bodies, or of no shells"),
    "RIGID BODY": ("dropped", "of no shells that are left"),
    "SURFACE INTERACTION": ("kept", "friction, for contacts that name it"),
    "FRICTION": ("kept", "a coefficient, for contacts that name it"),
    "CONTACT PAIR": ("dropped", "adds no tool: it joins none with the sheet, or one that has a contact above"),
    "CONTACT PROPERTY ASSIGNMENT": ("dropped", "adds no tool"),
}
"""What becomes of a block of which nothing else is noted."""
