# SPDX-License-Identifier: Apache-2.0
"""A material of a deck in the words of a case, in mm, s, t, N, MPa."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.deck.contents import Deck, Hardening, MaterialCard
from presswork.deck.notes import Notes
from presswork.deck.units import Units
from presswork.model import FloatArray

_BEYOND = 0.1
"""Plastic strain from the last row to one of the same stress, whose slope goes on."""
_STRESSES = {"K", "yield_stress", "saturation_stress", "modulus"}


def describe_material(card: MaterialCard, deck: Deck, units: Units, notes: Notes) -> dict[str, Any]:
    """Return the keys of a material; notes what its curve was made of. Raises CaseError for a missing curve."""
    found: dict[str, Any] = {
        "young": card.young * units.stress,
        "poisson": card.poisson,
    }
    if card.density:
        found["density"] = card.density * units.density
    assert card.hardening is not None
    found["hardening"] = _describe_hardening(card, card.hardening, deck, units, notes)
    if card.yield_function is not None:
        found["yield_function"] = card.yield_function
    if card.cowper_symonds is not None:
        c, p = card.cowper_symonds
        found["rate"] = {"law": "cowper_symonds", "D": c / units.time, "q": p}
    if card.johnson_cook is not None:
        c, rate = card.johnson_cook
        found["rate"] = {"law": "johnson_cook", "C": c, "reference_rate": rate / units.time}
    if card.young_decrease is not None:
        saturated, decrease = card.young_decrease
        found["young_decrease"] = {"saturated": saturated * units.stress, "rate": decrease}
    laws = [str(found["hardening"]["law"]), *([str(card.yield_function["law"])] if card.yield_function else [])]
    notes.keep(card.place, card.keyword, f"the sheet's material: {', '.join(laws)}")
    return found


def _describe_hardening(
    card: MaterialCard, hardening: Hardening, deck: Deck, units: Units, notes: Notes
) -> dict[str, Any]:
    if hardening.law != "table":
        return {"law": hardening.law} | {
            key: value * units.stress if key in _STRESSES else value for key, value in hardening.parameters.items()
        }
    if hardening.curve:
        curve = deck.curves.get(hardening.curve)
        if curve is None or not len(curve):
            remedy = "add it (*DEFINE_CURVE, /FUNCT); tables of several rates are not read"
            raise notes.fail(card.place, f"{card.keyword}: there is no curve {hardening.curve} with points", remedy)
        keep_curve(deck, hardening.curve, card.keyword, notes)
        points = curve.copy()
    else:
        points = np.array(list(hardening.parameters.values())).reshape(-1, 2)
    if not len(points):
        raise notes.fail(
            card.place, f"{card.keyword}: no flow stress: it names no curve", "name one, or give its points"
        )
    points[:, 1] *= units.stress * hardening.curve_scale
    points = _clean(points, card, notes)
    if hardening.ends_flat and len(points) > 1 and points[-1, 1] > points[-2, 1]:
        notes.keep(card.place, card.keyword, f"beyond a plastic strain of {points[-1, 0]:g} the last stress holds")
        points = np.vstack([points, points[-1] + [_BEYOND, 0.0]])
    return {"law": "table", "points": points.tolist()}


def keep_curve(deck: Deck, number: int, keyword: str, notes: Notes) -> None:
    """Note that a curve is taken by a keyword."""
    line = deck.curve_lines.get(number)
    if line is not None:
        place, own = line
        notes.see(place, own, f"the curve of {keyword}")


def _clean(points: FloatArray, card: MaterialCard, notes: Notes) -> FloatArray:
    """Return rows that begin at zero strain, whose strain increases and whose stress does not fall."""
    points = points[np.argsort(points[:, 0], kind="stable")]
    points = points[np.concatenate([np.diff(points[:, 0]) > 0, [True]])]
    points = points[points[:, 0] >= 0.0]
    if points[0, 0] > 0.0:
        notes.change(
            card.place, card.keyword, f"the curve begins at strain {points[0, 0]:g}: its first stress holds from 0"
        )
        points = np.vstack([[0.0, points[0, 1]], points])
    if (np.diff(points[:, 1]) < 0).any():
        notes.change(card.place, card.keyword, "the curve falls: from there on its largest stress holds")
        points[:, 1] = np.maximum.accumulate(points[:, 1])
    return points
