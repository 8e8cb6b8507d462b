# SPDX-License-Identifier: Apache-2.0
"""The case of a stamping that says what a deck says: its blank, tools and stages."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.deck.blank_and_tools import BlankAndTools, Surface
from presswork.deck.contents import Deck
from presswork.deck.formed import read_past
from presswork.deck.material import describe_material
from presswork.deck.notes import Notes
from presswork.deck.stages import find_breaks
from presswork.deck.units import Units
from presswork.model import FloatArray, FormedSheet

_HOLDER = re.compile(r"hold|bind|pad|ring|clamp", re.IGNORECASE)
_STEADY = 0.01
"""Part by which a force may change in a stage and yet be one number."""
_ROWS = 9
"""Of a force that changes with the stroke."""


@dataclass(frozen=True)
class ImportedStamping:
    """A case and the meshes that it names by file."""

    case: dict[str, Any]
    meshes: dict[str, Surface]
    formed: FormedSheet | None = None
    """The sheet, where it has a past: it is blank.dynain."""


def make_stamping(deck: Deck, units: Units, notes: Notes) -> ImportedStamping:
    """Return the case of a stamping. Raises CaseError where the deck is none."""
    if deck.shells is None:
        raise notes.fail(None, "no shells in it", "give a deck of sheet forming")
    reader = BlankAndTools(deck, units, notes)
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


def _name_tools(reader: BlankAndTools) -> tuple[dict[int, str], dict[int, str]]:
    """Return names and kinds of the tools by part."""
    pushed = {push.part for push in reader.deck.pushes}
    displacements = reader.displacements
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
        longest = max(punches, key=lambda n: float(np.ptp(displacements[n])) if n in displacements else 0.0)
        kinds |= {number: "holder" for number in punches if number != longest}
    names: dict[int, str] = {}
    for number, kind in kinds.items():
        name = re.sub(r"[^a-z0-9]+", "_", reader.tools[number].title.lower()).strip("_")
        if not name or name[0].isdigit() or name.startswith("part_"):
            name = kind
        names[number] = name if name not in names.values() else f"{name}_{number}"
    return names, kinds


def _find_friction(reader: BlankAndTools, tool: int) -> float:
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


def _describe_blank(reader: BlankAndTools) -> tuple[dict[str, Any], FormedSheet | None]:
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


def _find_rolling(reader: BlankAndTools) -> float:
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


def _describe_stages(reader: BlankAndTools, names: dict[int, str], kinds: dict[int, str]) -> list[dict[str, Any]]:
    """Return the stages: strokes and forces between the times at which tools start, stop or turn back."""
    times, displacements = reader.times, reader.displacements
    notes, pushes = reader.notes, {push.part: push for push in reader.deck.pushes if push.part in reader.tools}
    breaks = find_breaks(times, list(displacements.values()), [reader.units.time * each for each in reader.deck.breaks])
    stages = []
    for number, (begin, end) in enumerate(itertools.pairwise(breaks), start=1):
        tools: dict[str, Any] = {}
        inside = (times >= begin - 1e-12) & (times <= end + 1e-12)
        for part, displacement in displacements.items():
            gone = float(displacement[inside][-1] - displacement[inside][0])
            sense = 1.0 if kinds[part] == "die" else -1.0
            if part not in pushes and abs(gone) > 1e-6:
                tools[names[part]] = {"stroke": round(sense * gone, 6)}
        longest = max(
            (w for p, w in displacements.items() if p not in pushes), key=np.ptp, default=np.zeros(len(times))
        )
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
    last_tenth = force[len(force) // 10 :]
    last = float(last_tenth[-1])
    if np.abs(last_tenth - last).max() <= _STEADY * max(abs(last), 1e-9) or np.ptp(stroke) <= 0.0:
        return round(last, 6)
    order = np.unique(stroke, return_index=True)[1]
    at = np.linspace(0.0, stroke.max(), _ROWS)
    return [
        [round(float(s), 6), round(float(f), 6)]
        for s, f in zip(at, np.interp(at, stroke[order], force[order]), strict=True)
    ]
