# SPDX-License-Identifier: Apache-2.0
"""Blank, tools and their motions among the parts of a deck, in the frame of a case."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from presswork.deck.contents import Contact, Deck, MaterialCard, Motion, PartCard, Push
from presswork.deck.formed import has_past
from presswork.deck.material import keep_curve
from presswork.deck.notes import Notes
from presswork.deck.place import Seat, find_normal, find_planes, seat
from presswork.deck.stages import find_displacement, sample_times
from presswork.deck.thick_tools import move_to_face
from presswork.deck.titles import is_punch
from presswork.deck.units import Units
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, IndexArray

_STEPWISE = "*BOUNDARY"
"""The keyword of Abaqus, whose motions follow each other step by step."""


@dataclass(frozen=True)
class Surface:
    """Triangles and quadrilaterals of a part, in the frame of the case."""

    points: FloatArray
    """(n, 3) [mm]."""
    cells: IndexArray
    """(m, 4); a triangle has its last node twice."""


class BlankAndTools:
    """The blank of a deck and the tools that touch it."""

    def __init__(self, deck: Deck, units: Units, notes: Notes) -> None:
        self.deck, self.units, self.notes = deck, units, notes
        assert deck.shells is not None
        self.shells = deck.shells
        largest = int(deck.labels.max())
        self.row_of = np.full(largest + 1, -1, dtype=np.intp)
        self.row_of[deck.labels] = np.arange(len(deck.labels))
        self._check_nodes()
        self.blank, self.material = self._find_blank()
        self.tools = self._find_tools()
        self.offset = np.zeros(3)
        self.offset = self._find_offset()
        self.sheet_points, self.sheet_index = self._points_of(self.blank)
        self.has_past = has_past(deck, self.blank)
        self._surfaces: dict[int, Surface] = {}
        self.seat, self.symmetry = self._find_seat()
        self.times, self.displacements = self._find_displacements()

    def _check_nodes(self) -> None:
        nodes = self.shells.nodes
        known = (nodes > 0) & (nodes < len(self.row_of))
        if not known.all() or (self.row_of[nodes] < 0).any():
            raise self.notes.fail(
                None, "shells of nodes that the deck does not have", "the deck is cut short, or a file is missing"
            )

    # --- parts -------------------------------------------------------------------------------------------------------

    def _find_blank(self) -> tuple[int, MaterialCard]:
        deck, used = self.deck, set(np.unique(self.shells.part).tolist())
        sheets = []
        for number, part in deck.parts.items():
            material = deck.materials.get(part.material)
            if number not in used:
                self.notes.drop(part.place, part.keyword, f"part {number} ({part.title}) has no shells")
            elif material is None:
                remedy = "give its material in the deck, or leave the part out"
                raise self.notes.fail(
                    part.place, f"part {number} ({part.title}) has no material {part.material}", remedy
                )
            elif not material.is_rigid:
                sheets.append((number, material))
        if len(sheets) != 1:
            names = ", ".join(f"{n} ({deck.parts[n].title})" for n, _ in sheets) or "none"
            fault = f"expected one part of shells that deforms, the blank; found: {names}"
            raise self.notes.fail(None, fault, "make tools rigid (*MAT_RIGID, *RIGID BODY, /RBODY), and give one sheet")
        return sheets[0]

    def _find_tools(self) -> dict[int, PartCard]:
        """Return the rigid parts that touch the blank."""
        touched: dict[int, PartCard] = {}
        for contact in self.deck.contacts:
            for own, other in (contact.parts, contact.parts[::-1]):
                if self.blank in own:
                    touched |= {n: self.deck.parts[n] for n in other if n in self.deck.parts and n != self.blank}
        used = set(np.unique(self.shells.part).tolist())
        touched = {number: part for number, part in touched.items() if number in used}
        if not touched:
            raise self.notes.fail(None, "no rigid part touches the blank", "give a contact between blank and tools")
        for number in used - set(touched) - {self.blank}:
            if number not in self.deck.parts:
                text = f"shells of part {number}, which the deck does not have"
                raise self.notes.fail(None, text, "the deck is cut short, or a file is missing")
            part = self.deck.parts[number]
            self.notes.drop(part.place, part.keyword, f"part {number} ({part.title}) touches nothing")
        return touched

    def _points_of(self, part: int) -> tuple[FloatArray, IndexArray]:
        """Return the points of a part (n, 3) [mm], and each label's number among them."""
        labels = np.unique(self.shells.nodes[self.shells.part == part])
        index = np.full(len(self.row_of), -1, dtype=np.intp)
        index[labels] = np.arange(len(labels))
        points = self.deck.points[self.row_of[labels]] * self.units.length
        return points + self.offset if part == self.blank else points, index

    def _find_offset(self) -> FloatArray:
        """Return how far the blank's middle lies from its nodes (3,) [mm]: half its thickness, if a section has it."""
        section = self.deck.sections.get(self.deck.parts[self.blank].section)
        if section is None or not section.offset:
            return np.zeros(3)
        points, index = self._points_of(self.blank)
        own = self.shells.part == self.blank
        a, b, c, d = (points[index[self.shells.nodes[own, i]]] for i in range(4))
        normals = np.cross(c - a, d - b)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        mean = normals.mean(axis=0)
        thickness = self.shells.thickness[own]
        is_even = not np.isfinite(thickness).any() or np.ptp(thickness) < 1e-9 * thickness.max()
        if np.linalg.norm(mean) < 1.0 - 1e-6 or not is_even:
            text = f"nodes off the middle by {section.offset:g} of the thickness, in shells of different sides"
            remedy = "turn the shells alike, or lay the nodes into the middle of a flat sheet of one thickness"
            self.notes.refuse(section.place, section.keyword, text, remedy)
            return np.zeros(3)
        own_thickness = float(thickness[0]) if np.isfinite(thickness).any() else section.thickness
        offset = np.asarray(-section.offset * own_thickness * self.units.length * mean)
        text = "offset: the sheet's middle lies ({:.6g}, {:.6g}, {:.6g}) mm from its nodes".format(*offset)
        self.notes.keep(section.place, section.keyword, text)
        return offset

    @property
    def angle(self) -> FloatArray:
        """Return the angle of the material from the first side of each shell of the blank (n,) [rad]."""
        own = self.shells.part == self.blank
        return np.zeros(int(own.sum())) if self.shells.angle is None else np.radians(self.shells.angle[own])

    def surface(self, part: int) -> Surface:
        """Return the shells of a part in the frame of the case; those of a tool lie where it touches."""
        if part not in self._surfaces:
            points, index = self._points_of(part)
            found = Surface(self.seat.place(points), index[self.shells.nodes[self.shells.part == part]])
            self._surfaces[part] = found if part == self.blank else self._touching(part, found)
        return self._surfaces[part]

    def _touching(self, part: int, mesh: Surface) -> Surface:
        """Return a tool's mesh, moved to its face where its shells touch with their thickness."""
        distance, contact = self._half_thickness(part)
        if not distance or contact is None:
            return mesh
        card = self.deck.parts[part]
        try:
            points = move_to_face(mesh.points, mesh.cells, distance, bool(mesh.points[:, 2].mean() < 0.0))
        except MeshError as error:
            text = f"part {part} ({card.title}) touches with half the thickness of its shells, {distance:.4g} mm"
            remedy = f"{error.remedy}, or take a contact in which its mesh is its face (*CONTACT_FORMING)"
            self.notes.refuse(contact.place, contact.keyword, f"{text}: {error.fault}", remedy)
            return mesh
        text = (
            f"part {part} ({card.title}): its face lies half its shells' thickness from their mesh, {distance:.4g} mm"
        )
        self.notes.change(contact.place, contact.keyword, text)
        return Surface(points, mesh.cells)

    def _half_thickness(self, part: int) -> tuple[float, Contact | None]:
        """Return half the thickness [mm] with which a tool touches the sheet, and the contact that sets it."""
        for contact in self.deck.contacts:
            for side, other in ((0, 1), (1, 0)):
                if part not in contact.parts[side] or self.blank not in contact.parts[other]:
                    continue
                if contact.thickness is None:
                    return 0.0, None
                given, scale = contact.thickness[other]
                if given or scale != 1.0:
                    text = f"thickness {given:g} (0: its own) by {scale:g} of the sheet in this contact"
                    self.notes.leave(contact.place, contact.keyword, text)
                given, scale = contact.thickness[side]
                section = self.deck.sections.get(self.deck.parts[part].section)
                own = self.shells.thickness[self.shells.part == part]
                thickness = given or (section.thickness if section else 0.0)
                if not given and np.isfinite(own).all():
                    thickness = float(own.mean())
                return 0.5 * thickness * scale * self.units.length, contact
        return 0.0, None

    # --- the frame ---------------------------------------------------------------------------------------------------

    def _find_seat(self) -> tuple[Seat, tuple[str, ...]]:
        points = self.sheet_points
        driven: list[Motion | Push] = [*self.deck.motions, *self.deck.pushes]
        normal = find_normal(points)
        axes = {each.axis for each in driven if each.part in self.tools}
        if self.has_past and len(axes) == 1:
            normal = axes.pop() % 3
        if normal is None:
            fault = "the blank is not flat, or not normal to x, y or z"
            raise self.notes.fail(self.deck.parts[self.blank].place, fault, "form the part from its flat blank")
        for other in driven:
            if other.part in self.tools and other.axis != normal:
                axis = "xyz"[other.axis] if other.axis < 3 else f"a turn about {'xyz'[other.axis - 3]}"
                fault = f"part {other.part} is driven along {axis}, the press works along {'xyz'[normal]}"
                self.notes.refuse(other.place, other.keyword, fault, "tools of a stamping move normal to the blank")
        self.notes.check()
        self._normal = normal
        planes = find_planes(points, self.sheet_index, self.deck.held, normal)
        taken = [held for _, own in planes.values() for held in own]
        for held in taken:
            self.notes.change(held.place, held.keyword, "a symmetry plane of the blank (blank.symmetry)")
        for held in self.deck.held:
            is_of_blank = (self.sheet_index[held.nodes[held.nodes < len(self.sheet_index)]] >= 0).any()
            if held in taken:
                continue
            if is_of_blank:
                self.notes.refuse(held.place, held.keyword, "supports of the blank that are not a symmetry plane")
            else:
                self.notes.drop(held.place, held.keyword, "holds nodes of rigid tools, which move by the stages")
        self.notes.check()
        upwards = self._comes_from_above(normal)
        placed, symmetry = seat(points, normal, upwards, {axis: at for axis, (at, _) in planes.items()})
        return placed, symmetry

    def _comes_from_above(self, normal: int) -> bool:
        """Return whether the punch comes from the side of the positive normal: by name, by force, or as most tools."""
        level = float(self.sheet_points[:, normal].mean())
        side = {number: float(np.sign(self._points_of(number)[0][:, normal].mean() - level)) for number in self.tools}
        named = [number for number, part in self.tools.items() if is_punch(part.title)]
        if len(named) == 1:
            return side[named[0]] > 0
        total = sum(side.values())
        if total == 0:
            moved = {motion.part for motion in self.deck.motions if motion.axis == normal}
            total = sum(side[number] for number in self.tools if number in moved)
        return total >= 0

    # --- what tools do -----------------------------------------------------------------------------------------------

    def _find_displacements(self) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Return times [s] and the tools' displacements along z of the case [mm] by part."""
        end = self._find_end()
        own = [m for m in self.deck.motions if m.part in self.tools]
        times = sample_times(end, [self._curve(m) for m in own])
        self._check_times(own, end)
        found: dict[int, FloatArray] = {}
        for motion in own:
            displacement = find_displacement(
                motion.kind, self._curve(motion), motion.scale, motion.begin, motion.end, times
            )
            start = motion.scale * float(np.interp(times[0] - motion.begin, *self._curve(motion).T))
            if motion.kind == "displacement" and start:
                text = f"displacements begin at {start:g}: the displacement from there is taken"
                self.notes.change(motion.place, motion.keyword, text)
            displacement = displacement * self.units.length * self.seat.turn[2, motion.axis]
            found[motion.part] = found.get(motion.part, 0.0) + displacement
        return times * self.units.time, found

    def _check_times(self, motions: list[Motion], end: float) -> None:
        """Note curves that end too early, and refuse two motions of a tool along one axis at a time."""
        driven: list[Motion | Push] = [*motions, *(each for each in self.deck.pushes if each.part in self.tools)]
        for each in driven:
            last = float(self._curve(each)[-1, 0]) + (each.begin if isinstance(each, Motion) else 0.0)
            needed = min(end, each.end) if isinstance(each, Motion) else end
            if last < needed * (1.0 - 1e-6):
                text = f"its curve ends at {last:g}, before {needed:g}: its last value holds on"
                self.notes.change(each.place, each.keyword, text)
        for one, other in itertools.combinations(motions, 2):
            is_same = one.part == other.part and one.axis == other.axis and one.keyword != _STEPWISE
            if is_same and max(one.begin, other.begin) < min(one.end, other.end):
                text = f"a second motion of part {one.part} at the same time"
                remedy = "give one, or times of birth and death that do not overlap"
                self.notes.refuse(other.place, other.keyword, text, remedy)
        self.notes.check()

    def _find_end(self) -> float:
        if self.deck.end is not None and self.deck.end > 0.0:
            return self.deck.end
        raise self.notes.fail(None, "the deck has no end time", "add *CONTROL_TERMINATION or /RUN")

    def _curve(self, of: Motion | Push) -> FloatArray:
        curve = self.deck.curves.get(of.curve)
        if curve is None or len(curve) < 2:
            raise self.notes.fail(
                of.place, f"{of.keyword}: there is no curve {of.curve} of two points", "add *DEFINE_CURVE or /FUNCT"
            )
        keep_curve(self.deck, of.curve, of.keyword, self.notes)
        return curve

    def force(self, push: Push, times: FloatArray) -> FloatArray:
        """Return what a tool pushes with on the whole part at times [s] (n,) [N]; along -z it is positive."""
        curve = self._curve(push)
        values = push.scale * np.interp(times / self.units.time, curve[:, 0], curve[:, 1])
        whole = 2 ** len(self.symmetry)
        return np.asarray(values * self.units.force * whole * self.seat.turn[2, push.axis])
