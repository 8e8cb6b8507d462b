# SPDX-License-Identifier: Apache-2.0
"""The case of a stamping from a deck: its blank, tools and stages."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.deck.actions import describe_stages
from presswork.deck.blank_and_tools import BlankAndTools, Surface
from presswork.deck.contents import Deck
from presswork.deck.formed import read_past
from presswork.deck.material import describe_material
from presswork.deck.notes import Notes
from presswork.deck.titles import is_holder
from presswork.deck.units import Units
from presswork.model import FormedSheet


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
        "stages": describe_stages(reader, names, kinds),
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
        elif number in pushed or is_holder(part.title):
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
            notes.change(part.place, part.keyword, "shells of a formed sheet are not split")
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
    if abs(direction[2]) > 1e-9 * np.abs(direction).max():
        text = f"the part of its axis normal to the sheet, {direction[2]:g} of ({direction[0]:g}, {direction[1]:g})"
        notes.leave(reader.material.place, reader.material.keyword, text)
    return round(float(np.degrees(np.arctan2(direction[1], direction[0]))), 6) % 180.0
