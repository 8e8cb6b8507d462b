# SPDX-License-Identifier: Apache-2.0
"""Materials of Abaqus: elastic, plastic by a table, Hill's ratios, rates by a power law."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from presswork.deck.abaqus.parameters import leave_columns
from presswork.deck.contents import Hardening, MaterialCard
from presswork.deck.notes import Notes
from presswork.keyword_file import Place
from presswork.mesh.files.abaqus_blocks import Block, DataError
from presswork.model import FloatArray

_KEYWORDS = ("MATERIAL", "DENSITY", "ELASTIC", "PLASTIC", "POTENTIAL", "RATE DEPENDENT", "DAMPING")


_TAKEN = {
    "DENSITY": (1, 1),
    "ELASTIC": (1, 2),
    "PLASTIC": (0, 2),
    "POTENTIAL": (1, 4),
    "RATE DEPENDENT": (1, 2),
}
"""Rows and columns that are read; 0: all."""


@dataclass
class _Material:
    place: Place
    density: float = 0.0
    young: float = 0.0
    poisson: float = 0.0
    points: np.ndarray | None = None
    ratios: np.ndarray | None = None
    rate: tuple[float, float] | None = None
    options: list[str] = field(default_factory=list)


class MaterialReader:
    """Gathers the materials of a deck."""

    def __init__(self, notes: Notes) -> None:
        self._notes = notes
        self._found: dict[str, _Material] = {}
        self._now: _Material | None = None

    @property
    def rigid(self) -> int:
        """Number of the material of rigid bodies."""
        return len(self._found) + 1

    def take(self, block: Block) -> bool:
        """Take a keyword of a material; return whether it was one."""
        if block.name not in _KEYWORDS:
            return False
        if block.name == "MATERIAL":
            if block.name_of("NAME") in self._found:
                raise DataError(f"a second material {block.name_of('NAME')}")
            self._now = self._found.setdefault(block.name_of("NAME"), _Material(block.place))
            self._notes.see(block.place, "*MATERIAL", "belongs to no sheet that is imported", "dropped")
        elif self._now is not None:
            self._notes.belong(block.place, f"*{block.name}", self._now.place)
            self._take(block, self._now)
        else:
            self._notes.see(block.place, f"*{block.name}", "of no material", "dropped")
        return True

    def _take(self, block: Block, material: _Material) -> None:
        rows = block.table(6)
        n_rows, n_columns = _TAKEN.get(block.name, (0, 0))
        if n_rows and len(rows) > n_rows:
            text = f"{len(rows)} rows of data, of several temperatures or fields"
            self._notes.refuse(block.place, f"*{block.name}", text, "give the values of one temperature")
        if n_columns:
            leave_columns(block, n_columns, "temperature, fields and further columns", self._notes)
        match block.name:
            case "DENSITY":
                material.density = float(rows[0, 0])
            case "ELASTIC":
                if block.name_of("TYPE") not in ("", "ISOTROPIC"):
                    self._notes.refuse(block.place, "*ELASTIC", "elasticity that depends on direction")
                material.young, material.poisson = float(rows[0, 0]), float(rows[0, 1])
            case "PLASTIC":
                self._take_plastic(block, rows, material)
            case "POTENTIAL":
                material.ratios = rows[0]
            case "RATE DEPENDENT":
                if block.name_of("TYPE") not in ("", "POWER LAW"):
                    self._notes.refuse(block.place, "*RATE DEPENDENT", "rates by another law", "give TYPE=POWER LAW")
                material.rate = (float(rows[0, 0]), float(rows[0, 1]))
            case _:
                self._notes.drop(block.place, f"*{block.name}", "controls numerics: presswork has its own")

    def _take_plastic(self, block: Block, rows: np.ndarray, material: _Material) -> None:
        if block.name_of("HARDENING") not in ("", "ISOTROPIC") or "RATE" in block.parameters:
            self._notes.refuse(block.place, "*PLASTIC", "hardening of another kind, or tables of several rates")
            return
        if len(np.unique(rows[:, 2])) > 1:
            self._notes.refuse(block.place, "*PLASTIC", "a flow stress that depends on temperature")
        if not len(rows):
            raise DataError("the rows below it are cut short")
        material.points = rows[:, [1, 0]]

    def make_rigid(self, place: Place) -> MaterialCard:
        """Return the material of rigid bodies."""
        return MaterialCard("*RIGID BODY", 0.0, 0.0, 0.0, place, is_rigid=True)

    def finish(self) -> tuple[dict[int, MaterialCard], dict[str, int]]:
        """Return the materials by number, and the numbers by name."""
        cards, numbers = {}, {}
        for number, (name, material) in enumerate(self._found.items(), start=1):
            numbers[name] = number
            points = material.points if material.points is not None else np.array([[0.0, 1e12]])
            if material.ratios is not None:  # the table is the reference stress, R11 times it that along 1
                points = points * [1.0, material.ratios[0]]
            table = {f"{i}": float(value) for i, value in enumerate(points.ravel())}
            hardening = Hardening("table", table, ends_flat=True)
            cards[number] = MaterialCard(
                "*MATERIAL",
                material.density,
                material.young,
                material.poisson,
                material.place,
                hardening=hardening,
                yield_function=None if material.ratios is None else hill_of_ratios(material.ratios),
                cowper_symonds=material.rate,
            )
        return cards, numbers


def read_orientation(block: Block, notes: Notes) -> FloatArray | None:
    """Return the direction (3,) that shells project as their axis 1; None where it is refused, which is noted.

    The first row has points a and b of the axes: 1 along a, 3 along a x b. The second turns them about one of them by
    an angle [degree]; shells project the one that follows it. Raises DataError.
    """
    if block.name_of("SYSTEM") not in ("", "RECTANGULAR") or block.name_of("DEFINITION") not in ("", "COORDINATES"):
        remedy = "give SYSTEM=RECTANGULAR, DEFINITION=COORDINATES"
        notes.refuse(block.place, "*ORIENTATION", "axes of the material that differ from place to place", remedy)
        return None
    rows = block.table(9)
    origin = rows[0, 6:9]
    first, third = rows[0, :3] - origin, np.cross(rows[0, :3] - origin, rows[0, 3:6] - origin)
    if not third.any():
        raise DataError("the two points lie on one line with the origin")
    axes = np.array([first, np.cross(third, first), third])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    about, angle = (int(rows[1, 0]) or 1, np.radians(rows[1, 1])) if len(rows) > 1 else (1, 0.0)
    projected, other = axes[about % 3], axes[(about + 1) % 3]
    return np.asarray(np.cos(angle) * projected + np.sin(angle) * other)


def hill_of_ratios(ratios: np.ndarray) -> dict[str, object]:
    """Return Hill's yield function of the ratios R11, R22, R33, R12 of yield stresses."""
    r11, r22, r33, r12 = ratios[:4]
    f = 0.5 * (r22**-2 + r33**-2 - r11**-2)
    g = 0.5 * (r33**-2 + r11**-2 - r22**-2)
    h = 0.5 * (r11**-2 + r22**-2 - r33**-2)
    n = 1.5 * r12**-2
    values = {"r00": h / g, "r45": n / (f + g) - 0.5, "r90": h / f}
    return {"law": "hill1948"} | {name: float(value) for name, value in values.items()}
