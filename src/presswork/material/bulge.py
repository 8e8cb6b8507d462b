# SPDX-License-Identifier: Apache-2.0
"""Measured hydraulic bulge tests: from a file of pressure and height to a biaxial flow curve.

Columns: `pressure`, and `height` of the pole [mm]. Optional, and better than what replaces them: `radius` of curvature
at the pole [mm]; `thickness` there [mm], or the true strains `strain_1` along and `strain_2` across the rolling
direction. The history of a run with a pressure on a sheet is read, too.

A sheet of thickness t under the pressure p, with the radius of curvature rho at its pole, carries (ISO 16808)

    sigma = p rho / (2 t),       plastic strain through the thickness = ln(t0 / t) - 2 nu sigma / E.

Where the radius is not measured it is that of a sphere through the pole that leaves the die's edge along its tangent,
rho = ((a + R)^2 + h^2 - 2 h R) / (2 h), a: radius of the opening, R: radius of its edge. Where neither thickness nor
strains are measured, t = t0 / (1 + h^2 / a^2)^2 (Hill 1950), which thins the pole too little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.material.measured_file import MeasuredFile, read_measured_file
from presswork.material.quantities import find_unit, read_title
from presswork.material.tensile import TensileTest
from presswork.model import FloatArray

NAMES = {
    "pressure": ("pressure", "p", "druck", "pression", "pressione", "presion"),
    "height": ("height", "h", "dome height", "hohe", "höhe", "hauteur", "altezza", "altura"),
    "radius": ("radius", "rho", "r", "radius of curvature", "krummungsradius"),
    "thickness": ("thickness", "t", "dicke", "epaisseur", "spessore", "espesor"),
    "strain_1": ("strain_1", "strain 1", "e1", "eps1", "epsilon 1", "major strain"),
    "strain_2": ("strain_2", "strain 2", "e2", "eps2", "epsilon 2", "minor strain"),
}
"""Names of columns, in small letters; of a run the last part of `pressure.NAME.p` and so on."""
TOO_STRONG = 0.02
"""Stress over Young's modulus that no sheet bears."""
FEWEST = 5
"""Points of a test."""
ITERATIONS = 5
"""Number of corrections of stress and elastic strain; each is a thousandth of the one before."""
FIRST_STRAIN = 0.02
"""Strain of the pole from which r of balanced biaxial tension is found."""


@dataclass(frozen=True)
class BulgeSizes:
    """Sizes of sheet and die [mm]; None where they are not given."""

    thickness: float | None = None
    opening: float | None = None
    """Diameter of the die's opening."""
    edge_radius: float | None = None


@dataclass(frozen=True)
class BulgeTest:
    """One bulge test; shapes (n,)."""

    stress: FloatArray
    """Balanced biaxial true stress [MPa]."""
    plastic_strain: FloatArray
    """Through the thickness, positive as it thins."""
    biaxial_r: float | None
    """Plastic strain across over that along the rolling direction; None: not measured."""
    notes: tuple[str, ...]
    """What was not measured, and by which formula it was found."""

    def as_tension(self, young: float) -> TensileTest:
        """Return stress and plastic strain as a test in tension has them, for fits of flow curves."""
        return TensileTest(0.0, self.plastic_strain + self.stress / young, self.stress, None)


def find_bulge_head(file: MeasuredFile) -> int | None:
    """Return which line names columns of pressure and height; None: the file has no bulge test."""
    for i, line in enumerate(file.lines):
        if {"pressure", "height"} <= {_find_name(cell) for cell in line.cells}:
            return i
    return None


def is_bulge_test(path: Path) -> bool:
    """Return whether a file holds a bulge test. Raises CaseError."""
    return find_bulge_head(read_measured_file(path)) is not None


def read_bulge(path: Path, sizes: BulgeSizes, young: float, poisson: float) -> BulgeTest:
    """Read a bulge test up to its largest pole strain. Raises CaseError with every fault."""
    columns = _read_columns(path)
    missing = []
    if sizes.thickness is None:
        missing.append(Problem("--thickness", "the thickness of the sheet is not known", "give it in mm"))
    if "radius" not in columns and (sizes.opening is None or sizes.edge_radius is None):
        remedy = "add the column radius [mm], or give --opening and --die-radius"
        missing.append(Problem("radius", "neither the radius of curvature nor the die is known", remedy))
    formed = "thickness" in columns or {"strain_1", "strain_2"} <= set(columns)
    if not formed and sizes.opening is None:
        remedy = "add the column thickness [mm], the columns strain_1 and strain_2, or give --opening"
        missing.append(Problem("thickness", "neither the thickness of the pole nor the die is known", remedy))
    if missing or sizes.thickness is None:
        raise CaseError(missing, path)
    pressure, height = columns["pressure"], columns["height"]
    opening, edge = 0.5 * (sizes.opening or math.nan), sizes.edge_radius or 0.0
    used = (pressure > 0.0) & (height > 0.0)
    notes = []
    if "radius" in columns:
        radius = columns["radius"]
        used &= radius > 0.0
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            radius = ((opening + edge) ** 2 + height**2 - 2.0 * height * edge) / (2.0 * height)
        notes.append("the radius of curvature is that of a sphere through the pole, which is too large")
    if "thickness" in columns:
        strain = np.log(sizes.thickness / np.maximum(columns["thickness"], 1e-300))
    elif formed:
        strain = columns["strain_1"] + columns["strain_2"]
    else:
        strain = 2.0 * np.log1p((height / opening) ** 2)
        notes.append("the thickness of the pole is Hill's estimate by the height, which is too large")
    _check_sizes(path, columns, sizes.thickness, strain, formed=formed)
    end = int(np.argmax(np.where(used, strain, -np.inf))) + 1
    used[end:] = False
    if used.sum() < FEWEST or strain[used].max() <= 0.0:
        text = f"points with pressure, height and thinning of the pole: {int(used.sum())}"
        raise CaseError([Problem("", text, f"give at least {FEWEST}, true strains and heights in mm")], path)
    thin, thinned = (pressure * radius)[used] / (2.0 * sizes.thickness), strain[used]
    stress = thin * np.exp(thinned)
    if formed and "thickness" not in columns:  # the sum of strains in the sheet holds its elastic growth of volume
        for _ in range(ITERATIONS):
            thinned = strain[used] - 2.0 * (1.0 - 2.0 * poisson) * stress / young
            stress = thin * np.exp(thinned)
    plastic = np.maximum.accumulate(thinned - 2.0 * poisson * stress / young)
    keep = np.concatenate([[True], np.diff(plastic) > 0.0])
    r = None
    if formed and "thickness" not in columns:
        r = _find_biaxial_r(columns["strain_1"][used], columns["strain_2"][used])
    if stress.max() > TOO_STRONG * young:
        text = f"a stress of {stress.max():.4g} MPa at the pole, {stress.max() / young:.2g} of Young's modulus"
        remedy = "check the units of the columns: plain numbers are MPa and mm, 1 bar is 0.1 MPa"
        raise CaseError([Problem("pressure", text, remedy)], path)
    return BulgeTest(stress[keep], plastic[keep], r, tuple(notes))


def _find_biaxial_r(along: FloatArray, across: FloatArray) -> float | None:
    """Return the slope of strains across over those along, through the origin; None below FIRST_STRAIN."""
    used = along + across > FIRST_STRAIN
    if not used.any():
        return None
    return float((along[used] @ across[used]) / (along[used] @ along[used]))


def _check_sizes(
    path: Path, columns: dict[str, FloatArray], thickness: float, strain: FloatArray, *, formed: bool
) -> None:
    """Refuse thicknesses and strains that no sheet has. Raises CaseError."""
    if "thickness" in columns and not 0.5 < columns["thickness"][0] / thickness < 1.05:
        text = f"the pole begins with {columns['thickness'][0]:g} mm, the sheet has {thickness:g} mm"
        raise CaseError([Problem("--thickness", text, "give the thickness of the sheet before the test in mm")], path)
    if formed and strain.max() > 3.0:
        text = f"strains of the pole up to {strain.max():g}"
        raise CaseError([Problem("strain_1", text, "give true strains, not per cent")], path)


def _find_name(cell: str) -> str:
    """Return the quantity that a column's title names; empty for any other."""
    bare = read_title(cell)[0].strip().lower()
    if bare.startswith("pressure.") and bare.count(".") >= 2:
        bare = bare.rpartition(".")[2]
    return next((key for key, names in NAMES.items() if bare in names), "")


def _read_columns(path: Path) -> dict[str, FloatArray]:
    """Return the columns by name, in MPa and mm. Raises CaseError."""
    file = read_measured_file(path)
    top = find_bulge_head(file)
    if top is None:
        raise CaseError([Problem("", "no columns pressure and height", "name them so in the head line")], path)
    below = file.lines[top + 1 :]
    units = below[0].cells if below and all(find_unit(cell) for cell in below[0].cells if cell) else ()
    found: dict[str, tuple[int, float]] = {}
    problems = []
    for i, cell in enumerate(file.lines[top].cells):
        name = _find_name(cell)
        if name in found:
            problems.append(Problem(cell, f"a second column of {name}", "keep one of them"))
        elif name:
            found[name] = i, read_title(cell, units[i] if i < len(units) else "")[1]
    rows = []
    for line in (line for line in below[1 if units else 0 :] if not line.comment):
        cells = [line.cells[i] if i < len(line.cells) else "" for i, _ in found.values()]
        values = [file.number(cell) for cell in cells]
        for name, cell, value in zip(found, cells, values, strict=True):
            if value is None and len(problems) < FEWEST:
                problems.append(Problem(f"line {line.number}, {name}", "expected a number", "mend the line", cell))
        rows.append([math.nan if value is None else value for value in values])
    if not rows:
        problems.append(Problem("", "no points", "give a line for each point"))
    if problems:
        raise CaseError(problems, path)
    return {name: factor * column for (name, (_, factor)), column in zip(found.items(), np.array(rows).T, strict=True)}
