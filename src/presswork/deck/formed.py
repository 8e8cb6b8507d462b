# SPDX-License-Identifier: Apache-2.0
"""A sheet with a past: the thickness of each shell, and its stresses and strains, in the frame of the case."""

from __future__ import annotations

from typing import Literal

import numpy as np

from presswork.deck.contents import Deck, PartCard, SectionCard
from presswork.deck.notes import Notes
from presswork.deck.place import Seat
from presswork.deck.units import Units
from presswork.mesh.files.dynain import first_sides
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import FloatArray, FormedSheet, IndexArray, Section

_FROM = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Where a tensor has xx, yy, zz, xy, yz, zx."""
_TO = (np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0]))
_ALIKE = 1e-6
"""How much the thickness of shells may differ in one blank, over the thickness."""
_RULES: tuple[Literal["gauss", "lobatto"], ...] = ("gauss", "lobatto")


def has_past(deck: Deck, part: int) -> bool:
    """Return whether the shells of a part have stresses, strains, or unequal thickness."""
    assert deck.shells is not None
    own = deck.shells.part == part
    thickness = deck.shells.thickness[own]
    known = np.isfinite(thickness)
    differs = known.any() and (not known.all() or np.ptp(thickness) > _ALIKE * float(thickness.mean()))
    labels = set(deck.shells.labels[own].tolist()) if deck.shells.labels is not None else set()
    return bool(differs or labels & (deck.layers.keys() | deck.strains.keys()))


def read_past(
    deck: Deck, number: int, placed: FloatArray, cells: IndexArray, seat: Seat, units: Units, notes: Notes
) -> tuple[FormedSheet, str]:
    """Return the sheet, and the rule of integration through its thickness.

    placed: its points in the frame of the case (n, 3) [mm]; cells: into them, in the deck's order (m, 4). Raises
    CaseError where its layers are those of no rule.
    """
    assert deck.shells is not None
    assert deck.shells.labels is not None
    part = deck.parts[number]
    section = deck.sections[part.section]
    own = np.flatnonzero(deck.shells.part == number)
    is_triangle = cells[:, 2] == cells[:, 3]
    order = np.argsort(is_triangle, kind="stable")  # quadrilaterals first
    own, cells = own[order], cells[order]
    labels = deck.shells.labels[own]
    heights, rule, layers = _read_layers(deck, labels, section, part, notes)
    stress = _turn(layers[:, :, 1:7] * units.stress, seat.turn)
    found = [deck.strains.get(int(label)) for label in labels]
    strain = None
    if any(each is not None for each in found):
        strain = _turn(np.array([np.zeros(6) if each is None else each for each in found])[:, None], seat.turn)[:, 0]
    thickness = deck.shells.thickness[own]
    thickness = np.where(np.isfinite(thickness), thickness, section.thickness) * units.length
    axis = _axis(deck, number, own, placed, cells, seat)
    text = f"{len(own)} shells of {thickness.min():.4g} to {thickness.max():.4g} mm"
    if deck.layers:
        text += f", stresses in {len(heights)} layers up to {np.abs(stress).max():.4g} MPa"
    notes.keep(part.place, part.keyword, f"a formed sheet (blank.dynain): {text}")
    sheet = FormedSheet(placed, cells.astype(np.int32), thickness, axis, heights, stress, layers[:, :, 7], strain)
    return sheet, rule


def _read_layers(
    deck: Deck, labels: IndexArray, section: SectionCard, part: PartCard, notes: Notes
) -> tuple[FloatArray, str, FloatArray]:
    """Return heights (k,), their rule, and height, six stresses and plastic strain (n, k, 8); zero without any."""
    found = [deck.layers.get(int(label)) for label in labels]
    known = [each for each in found if each is not None]
    if not known:
        heights, rule = thickness_rule(Section(1.0, max(2, section.n_points), "gauss"))[0], "gauss"
        return heights, rule, np.zeros((len(labels), len(heights), 8))
    heights = known[0][:, 0]
    if any(each.shape != known[0].shape or np.abs(each[:, 0] - heights).max() > 1e-3 for each in known):
        raise notes.fail(
            part.place, "shells of the sheet have stresses in different layers", "write as many for each, at one place"
        )
    for rule in _RULES:
        own = thickness_rule(Section(1.0, len(heights), rule))[0] if len(heights) > 1 else np.array([np.inf])
        if np.abs(own - heights).max() < 1e-3:
            rest = np.zeros((len(own), 8))
            return own, rule, np.array([rest if each is None else each for each in found])
    text = f"stresses at {', '.join(f'{each:.4g}' for each in heights)} of half the thickness"
    raise notes.fail(part.place, f"{text}: the points of no rule", "write those of Gauss's or Lobatto's rule")


def _axis(deck: Deck, number: int, own: IndexArray, placed: FloatArray, cells: IndexArray, seat: Seat) -> FloatArray:
    """Return x of the material in each shell (n, 3): the rolling direction, or the first side turned by its angle."""
    assert deck.shells is not None
    side, normal = first_sides(placed, cells.astype(np.int32))
    rolling = deck.materials[deck.parts[number].material].rolling
    if isinstance(rolling, tuple):
        along = seat.turn @ np.array(rolling, dtype=float)
        axis = along - (normal @ along)[:, None] * normal
        return np.asarray(axis / np.linalg.norm(axis, axis=1, keepdims=True))
    angle = np.zeros(len(own)) if deck.shells.angle is None else np.radians(deck.shells.angle[own])
    return np.asarray(np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(normal, side))


def _turn(values: FloatArray, turn: FloatArray) -> FloatArray:
    """Return symmetric tensors (n, k, 6) in the frame of the case."""
    return np.asarray(np.einsum("ip,nkpq,jq->nkij", turn, values[..., _FROM], turn)[..., _TO[0], _TO[1]])
