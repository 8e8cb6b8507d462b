# SPDX-License-Identifier: Apache-2.0
"""Measured tensile tests: from files to true stress against plastic strain up to the uniform elongation.

`specimens.py` lists what a file may hold. Specimens of the same angle become one test, their mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.material.specimen_facts import Sizes
from presswork.material.specimens import Specimen, read_specimens
from presswork.model import FloatArray

STIFF = 0.9
"""Part of Young's modulus below which the slope of a crosshead's path shows the machine's own give."""
ODD_SLOPE = 1.5
"""Factor between an extensometer's slope and Young's modulus from which on a note reports it."""
RISE = (0.1, 0.3)
"""Parts of the highest stress between which the first rise is elastic."""


@dataclass(frozen=True)
class TensileTest:
    """One direction's test, true values, up to the uniform elongation; shapes (n,)."""

    angle: float
    """Degrees from the rolling direction."""
    strain: FloatArray
    """True strain along the specimen."""
    stress: FloatArray
    """True stress [MPa]."""
    width_strain: FloatArray | None
    """True strain across, if it was measured."""

    def plastic_strain(self, young: float) -> FloatArray:
        """Return the plastic strain along the specimen."""
        return self.strain - self.stress / young


@dataclass(frozen=True)
class TensileTests:
    """What files of tensile tests gave."""

    tests: tuple[TensileTest, ...]
    """One a direction."""
    notes: tuple[str, ...]
    """What was read, and how, a line a specimen."""


def read_tensile(paths: Path | Sequence[Path], sizes: Sizes | None = None, young: float | None = None) -> TensileTests:
    """Read tensile tests of one or several files by direction.

    sizes: of the specimens, which replace those of the files; young: Young's modulus [MPa], with which the give of a
    machine is taken off the paths of its crosshead. Raises CaseError with every fault.
    """
    files = [paths] if isinstance(paths, Path) else list(paths)
    specimens = [(path, one) for path in files for one in read_specimens(path, sizes or Sizes())]
    problems: list[Problem] = []
    notes: list[str] = []
    tests = []
    for path, one in specimens:
        test, note = _make_test(one, young)
        tests.append(test)
        notes.append(f"{path.name}, {one.how}{note}")
        _check(test, one, problems)
    if problems:
        raise CaseError(list(dict.fromkeys(problems)), files[0] if len(files) == 1 else "tensile tests")
    angles = sorted({test.angle for test in tests})
    merged = [_average([test for test in tests if test.angle == angle], notes) for angle in angles]
    return TensileTests(tuple(merged), tuple(dict.fromkeys(notes)))


def _make_test(one: Specimen, young: float | None) -> tuple[TensileTest, str]:
    """Sort a specimen's points by strain, make them true and cut them at the highest force; return a note, too."""
    order = np.argsort(one.strain, kind="stable")
    strain, stress = one.strain[order], one.stress[order]
    width = None if one.width_strain is None else one.width_strain[order]
    true_strain = strain if one.true_strain else np.log1p(strain)
    force = stress * np.exp(-true_strain) if one.true_stress else stress
    last = int(np.argmax(force)) + 1
    note = ""
    if young is not None and not one.true_strain:
        strain, note = _take_off_compliance(strain, force, last, young, one.of_machine)
        true_strain = np.log1p(strain)
    if width is not None and not one.true_strain:
        width = np.log1p(width)
    true_stress = force * np.exp(true_strain)
    across = None if width is None else width[:last]
    return TensileTest(one.angle, true_strain[:last], true_stress[:last], across), note


def _take_off_compliance(
    strain: FloatArray, force: FloatArray, last: int, young: float, of_machine: bool
) -> tuple[FloatArray, str]:
    """Return engineering strains [-] without the give of the machine, by the slope of the first rise, and a note.

    strain, force over the first area [MPa]: sorted (n,); last: points up to the highest force.
    """
    top = float(force[:last].max())
    first = int(np.argmax(force[:last] > RISE[1] * top))
    rise = np.flatnonzero(force[:first] >= RISE[0] * top)
    if len(rise) < 3:
        return strain, ""
    slope, start = np.polyfit(strain[rise], force[rise], 1)
    if of_machine and 0.0 < slope < STIFF * young:
        compliance = force / slope - force / young - start / slope
        return strain - compliance, f"; the machine's give is taken off (slope {slope:.0f} MPa)"
    if slope <= 0.0 or not young / ODD_SLOPE < slope < ODD_SLOPE * young:
        return strain, f"; note: it rises with {slope:.0f} MPa, not with Young's modulus; check units and sizes"
    return strain, ""


def _average(tests: Sequence[TensileTest], notes: list[str]) -> TensileTest:
    """Return the mean of specimens of one angle up to where the first of them ends, at the strains of that one."""
    if len(tests) == 1:
        return tests[0]
    shortest = min(tests, key=lambda test: float(test.strain[-1]))
    strain = shortest.strain
    stresses = np.array([np.interp(strain, test.strain, test.stress) for test in tests])
    widths = [np.interp(strain, t.strain, t.width_strain) for t in tests if t.width_strain is not None]
    late = stresses[:, strain > 0.5 * strain[-1]]
    apart = float((np.ptp(late, axis=0) / late.mean(0)).max())
    notes.append(
        f"{len(tests)} specimens at {shortest.angle:g} degrees, whose mean is taken; their stresses differ by up to "
        f"{100 * apart:.1f} %"
    )
    mean_width = np.mean(widths, axis=0) if widths else None
    return replace(shortest, stress=stresses.mean(0), width_strain=mean_width)


def _check(test: TensileTest, one: Specimen, problems: list[Problem]) -> None:
    """Note what makes a test useless."""
    where = f"the test at {test.angle:g} degrees"
    strain, stress = float(one.strain.max()), float(one.stress.max())
    if len(test.strain) < 5:
        problems.append(Problem(where, f"{len(test.strain)} points up to the highest force", "give at least five"))
    elif strain > 2.0:
        remedy = "per cent go into a column ..._percent or [%]; millimetres into one named displacement [mm]"
        if stress > 3000.0:
            remedy += f"; stresses to {stress:g} MPa look like newtons: name them force [N]"
        problems.append(Problem(where, f"strain to {strain:g}", remedy))
    elif stress < 10.0:
        text = f"the highest stress is {stress:g} MPa, that of no metal"
        problems.append(Problem(where, text, "give stresses in MPa, forces in N or kN with their unit"))
