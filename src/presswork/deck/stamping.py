# SPDX-License-Identifier: Apache-2.0
"""The case of a stamping that says what a deck says: its blank, tools and stages."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.deck.contents import Deck, MaterialCard, Motion, PartCard, Push
from presswork.deck.formed import has_past, read_past
from presswork.deck.material import describe_material, keep_curve
from presswork.deck.notes import Notes
from presswork.deck.place import Seat, find_normal, find_planes, seat
from presswork.deck.stages import find_breaks, find_way, sample_times
from presswork.deck.units import Units
from presswork.model import FloatArray, FormedSheet, IndexArray

_HOLDER = re.compile(r"hold|bind|pad|ring|clamp", re.IGNORECASE)
_PUNCH = re.compile(r"punch|stamp|post", re.IGNORECASE)
_STEADY = 0.01
"""Part by which a force may change in a stage and yet be one number."""
_ROWS = 9
"""Of a force that changes with the stroke."""


@dataclass(frozen=True)
class Surface:
    """Triangles and quadrilaterals of a part, in the frame of the case."""

    points: FloatArray
    """(n, 3) [mm]."""
    cells: IndexArray
    """(m, 4); a triangle has its last node twice."""


@dataclass(frozen=True)
class ImportedStamping:
    """A case and the meshes that it names by file."""

    case: dict[str, Any]
    meshes: dict[str, Surface]
    formed: FormedSheet | None = None
    """The sheet, where it has a past: it is blank.dynain."""


class _Reader:
    """Finds its way from parts to blank, tools and stages."""

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
        self.sheet_points, self.sheet_index = self._points_of(self.blank)
        self.has_past = has_past(deck, self.blank)
        self.seat, self.symmetry = self._find_seat()
        self.times, self.ways = self._find_ways()

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
        return self.deck.points[self.row_of[labels]] * self.units.length, index

    @property
    def angle(self) -> FloatArray:
        """Of the material from the first side of each shell of the blank (n,) [rad]."""
        own = self.shells.part == self.blank
        return np.zeros(int(own.sum())) if self.shells.angle is None else np.radians(self.shells.angle[own])

    def surface(self, part: int) -> Surface:
        """Return the shells of a part in the frame of the case."""
        points, index = self._points_of(part)
        return Surface(self.seat.place(points), index[self.shells.nodes[self.shells.part == part]])

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
                self.notes.refuse(held.place, held.keyword, "supports of the blank that are no symmetry plane")
            else:
                self.notes.drop(held.place, held.keyword, "holds nodes of rigid tools, which move as stages say")
        self.notes.check()
        upwards = self._comes_from_above(normal)
        placed, symmetry = seat(points, normal, upwards, {axis: at for axis, (at, _) in planes.items()})
        return placed, symmetry

    def _comes_from_above(self, normal: int) -> bool:
        """Say whether the punch comes from the side of the positive normal: named so, or pushed, or with most tools."""
        level = float(self.sheet_points[:, normal].mean())
        side = {number: float(np.sign(self._points_of(number)[0][:, normal].mean() - level)) for number in self.tools}
        named = [number for number, part in self.tools.items() if _PUNCH.search(part.title)]
        if len(named) == 1:
            return side[named[0]] > 0
        total = sum(side.values())
        if total == 0:
            moved = {motion.part for motion in self.deck.motions if motion.axis == normal}
            total = sum(side[number] for number in self.tools if number in moved)
        return total >= 0

    # --- what tools do -----------------------------------------------------------------------------------------------

    def _find_ways(self) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Return times [s] and the tools' displacements along z of the case [mm] by part."""
        end = self._find_end()
        own = [m for m in self.deck.motions if m.part in self.tools]
        times = sample_times(end, [self._curve(m) for m in own])
        found: dict[int, FloatArray] = {}
        for motion in own:
            way = find_way(motion.kind, self._curve(motion), motion.scale, motion.begin, motion.end, times)
            way = way * self.units.length * self.seat.turn[2, motion.axis]
            found[motion.part] = found.get(motion.part, 0.0) + way
        return times * self.units.time, found

    def _find_end(self) -> float:
        if self.deck.end is not None and self.deck.end > 0.0:
            return self.deck.end
        raise self.notes.fail(None, "the deck does not say when it ends", "add *CONTROL_TERMINATION or /RUN")

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


def make_stamping(deck: Deck, units: Units, notes: Notes) -> ImportedStamping:
    """Return the case of a stamping. Raises CaseError where the deck is none."""
    if deck.shells is None:
        raise notes.fail(None, "no shells in it", "give a deck of sheet forming")
    reader = _Reader(deck, units, notes)
    names, kinds = _name_tools(reader)
    meshes = {} if reader.has_past else {"blank.vtk": reader.surface(reader.blank)}
    tools: dict[str, Any] = {}
    for number, name in names.items():
        meshes[f"{name}.stl"] = reader.surface(number)
        part = deck.parts[number]
        tools[name] = {
            "kind": kinds[number],
            "shape": "file",
            "path": f"{name}.stl",
            "position": [0.0, 0.0, 0.0],
            "mu": _find_friction(reader, number),
        }
        notes.keep(part.place, part.keyword, f"part {number} ({part.title}) is the tool {name}, a {kinds[number]}")
    material = describe_material(reader.material, deck, units, notes)
    blank, formed = _describe_blank(reader)
    if text := reader.seat.describe():
        part = deck.parts[reader.blank]
        notes.change(deck.node_place or part.place, f"{part.keyword[0]}NODE", text)
    case: dict[str, Any] = {
        "title": deck.title or notes.source.stem,
        "analysis": "stamping",
        "blank": blank,
        "materials": {"sheet": material},
        "tools": tools,
        "stages": _describe_stages(reader, names, kinds),
    }
    if deck.sections[deck.parts[reader.blank].section].is_full:
        case["explicit"] = {"element": "shell4_mitc_plus"}
    if deck.springs_back:
        case["springback"] = {}
    return ImportedStamping(case, meshes, formed)


def _name_tools(reader: _Reader) -> tuple[dict[int, str], dict[int, str]]:
    """Return names and kinds of the tools by part."""
    pushed = {push.part for push in reader.deck.pushes}
    ways = reader.ways
    kinds: dict[int, str] = {}
    above = {n: float(reader.surface(n).points[:, 2].mean()) > 0.0 for n in reader.tools}
    for number, part in reader.tools.items():
        if not above[number]:
            kinds[number] = "die"
        elif number in pushed or _HOLDER.search(part.title):
            kinds[number] = "holder"
        else:
            kinds[number] = "punch"
    punches = [number for number, kind in kinds.items() if kind == "punch"]
    if len(punches) > 1:  # those that go less far hold
        longest = max(punches, key=lambda n: float(np.ptp(ways[n])) if n in ways else 0.0)
        kinds |= {number: "holder" for number in punches if number != longest}
    names: dict[int, str] = {}
    for number, kind in kinds.items():
        name = re.sub(r"[^a-z0-9]+", "_", reader.tools[number].title.lower()).strip("_")
        if not name or name[0].isdigit() or name.startswith("part_"):
            name = kind
        names[number] = name if name not in names.values() else f"{name}_{number}"
    return names, kinds


def _find_friction(reader: _Reader, tool: int) -> float:
    for contact in reader.deck.contacts:
        sides = contact.parts
        if any(reader.blank in own and tool in other for own, other in (sides, sides[::-1])):
            static, dynamic = contact.friction
            if dynamic and dynamic != static:
                text = f"one coefficient of friction: FS = {static:g}; FD = {dynamic:g} is left out"
                reader.notes.change(contact.place, contact.keyword, text)
            else:
                reader.notes.keep(contact.place, contact.keyword, f"mu = {static:g}")
            return static
    return 0.0


def _describe_blank(reader: _Reader) -> tuple[dict[str, Any], FormedSheet | None]:
    deck, notes = reader.deck, reader.notes
    part = deck.parts[reader.blank]
    section = deck.sections.get(part.section)
    if section is None:
        raise notes.fail(
            part.place,
            f"the blank's section {part.section} is missing",
            "add it (*SECTION_SHELL, *SHELL SECTION, /PROP)",
        )
    own = reader.shells.thickness[reader.shells.part == reader.blank]
    thickness = section.thickness
    if np.isfinite(own).any():
        thickness = section.thickness if reader.has_past else float(np.nanmean(own))
    blank: dict[str, Any] = {
        "shape": "file",
        "path": "blank.vtk",
        "thickness": thickness * reader.units.length,
        "material": "sheet",
        "points": max(2, section.n_points),
        "symmetry": list(reader.symmetry),
    }
    notes.keep(part.place, part.keyword, f"part {reader.blank} ({part.title}) is the blank")
    notes.keep(section.place, section.keyword, f"{blank['thickness']:g} mm, {blank['points']} points through it")
    if not reader.symmetry:
        del blank["symmetry"]
    if reader.has_past:
        surface = reader.surface(reader.blank)
        sheet, rule = read_past(deck, reader.blank, surface.points, surface.cells, reader.seat, reader.units, notes)
        blank |= {"path": "blank.dynain", "points": len(sheet.heights), "rule": rule}
        if deck.levels:
            notes.change(part.place, part.keyword, "shells of a sheet with a past are not split")
        return blank, sheet
    if deck.levels:
        blank["refine"] = {"levels": min(4, deck.levels)}
    if reader.material.rolling is not None:
        angle = _find_rolling(reader)
        if angle:
            blank["rolling_direction"] = angle
    return blank, None


def _find_rolling(reader: _Reader) -> float:
    """Return the angle of the rolling direction from x of the case [degree]."""
    rolling, notes = reader.material.rolling, reader.notes
    if rolling == "cell":
        sheet = reader.surface(reader.blank)
        sides = sheet.points[sheet.cells[:, 1]] - sheet.points[sheet.cells[:, 0]]
        across = sheet.points[sheet.cells[:, 2]] - sheet.points[sheet.cells[:, 0]]
        turn = reader.angle * np.sign(np.cross(sides, across)[:, 2])
        double = 2.0 * (np.arctan2(sides[:, 1], sides[:, 0]) + turn)
        mean = np.exp(1j * double).mean()
        if abs(mean) < 0.999:
            text = "axes of the material along the first side of each cell, which point in many directions"
            notes.refuse(reader.material.place, reader.material.keyword, text, "give AOPT = 2 and a direction")
            notes.check()
        return round(float(np.degrees(0.5 * np.angle(mean))), 3) % 180.0
    direction = reader.seat.turn @ np.array(rolling, dtype=float)
    return round(float(np.degrees(np.arctan2(direction[1], direction[0]))), 6) % 180.0


def _describe_stages(reader: _Reader, names: dict[int, str], kinds: dict[int, str]) -> list[dict[str, Any]]:
    """Return the stages: strokes and forces between the times at which tools start, stop or turn back."""
    times, ways = reader.times, reader.ways
    notes, pushes = reader.notes, {push.part: push for push in reader.deck.pushes if push.part in reader.tools}
    breaks = find_breaks(times, list(ways.values()), [reader.units.time * each for each in reader.deck.breaks])
    stages = []
    for number, (begin, end) in enumerate(itertools.pairwise(breaks), start=1):
        tools: dict[str, Any] = {}
        inside = (times >= begin - 1e-12) & (times <= end + 1e-12)
        for part, way in ways.items():
            gone = float(way[inside][-1] - way[inside][0])
            sense = 1.0 if kinds[part] == "die" else -1.0
            if part not in pushes and abs(gone) > 1e-6:
                tools[names[part]] = {"stroke": round(sense * gone, 6)}
        longest = max((w for p, w in ways.items() if p not in pushes), key=np.ptp, default=np.zeros(len(times)))
        for part, push in pushes.items():
            sense = 1.0 if kinds[part] == "die" else -1.0
            force = sense * reader.force(push, times[inside])
            tools[names[part]] = {"force": _describe_force(force, np.abs(longest[inside] - longest[inside][0]))}
        stages.append({"name": f"stage_{number}", "tools": tools, "duration": float(end - begin)})
    for motion in reader.deck.motions:
        if motion.part in names:
            text = f"{names[motion.part]}: strokes of the stages; within each it starts and stops smoothly"
            notes.change(motion.place, motion.keyword, text)
    for push in pushes.values():
        whole = f", of the whole part ({2 ** len(reader.symmetry)} times the deck's)" if reader.symmetry else ""
        notes.keep(push.place, push.keyword, f"{names[push.part]}: force{whole}")
    return stages


def _describe_force(force: FloatArray, stroke: FloatArray) -> float | list[list[float]]:
    """Return one force, or rows of the punch's stroke in the stage and the force."""
    settled = force[len(force) // 10 :]
    last = float(settled[-1])
    if np.abs(settled - last).max() <= _STEADY * max(abs(last), 1e-9) or np.ptp(stroke) <= 0.0:
        return round(last, 6)
    order = np.unique(stroke, return_index=True)[1]
    at = np.linspace(0.0, stroke.max(), _ROWS)
    return [
        [round(float(s), 6), round(float(f), 6)]
        for s, f in zip(at, np.interp(at, stroke[order], force[order]), strict=True)
    ]
