# SPDX-License-Identifier: Apache-2.0
"""Measured tension and compression in turn: from files to true stress and strain by branches between reversals.

`specimens.py` lists what a file may hold. A branch ends where the strain turns by more than TURN of its whole range, so
that noise and holds make no branches. Points are taken at equal lengths of the curve, with strain and stress over their
ranges: a steep elastic rise counts as much as a long flat part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.material.specimen_facts import Sizes
from presswork.material.specimens import Specimen, read_specimens
from presswork.model import FloatArray

TURN = 0.05
"""Part of the range of strains by which the strain goes back where a branch ends."""
BOTH_SIGNS = 0.1
"""Part of the largest stress which the stress of the other sign reaches where a test goes from tension to compression,
or back."""
POINTS = 80
"""Points of a branch that a fit compares."""
FEWEST = 8
"""Points of a branch in the file."""
LARGEST_STRAIN = 1.0
"""True strain beyond which strains are in per cent."""


@dataclass(frozen=True)
class Branch:
    """One branch, at equal lengths of its curve; shapes (n,)."""

    strain: FloatArray
    """True."""
    stress: FloatArray
    """True [MPa]."""
    end: float
    """True strain at which it turns, or ends."""

    @property
    def path(self) -> FloatArray:
        """Return the part of the branch's strain that each point has behind it (n,)."""
        length = np.abs(self.strain - self.strain[0])
        return np.asarray(length / max(float(length.max()), 1e-300))


@dataclass(frozen=True)
class CyclicTest:
    """A test with reversals."""

    branches: tuple[Branch, ...]
    slopes: tuple[float, ...]
    """Slope of stress over strain where each branch begins [MPa]: the elastic one."""
    how: str
    """What was read, in one line."""


def is_cyclic(path: Path) -> bool:
    """Return whether a file holds a test that goes from tension to compression, or back; False for what is unread."""
    try:
        specimens = read_specimens(path, Sizes(thickness=1.0, width=1.0, gauge_length=1.0))
    except CaseError:
        return False
    return len(specimens) == 1 and _has_both_signs(specimens[0]) and len(find_turns(specimens[0].strain)) > 2


def _has_both_signs(one: Specimen) -> bool:
    low, high = float(one.stress.min()), float(one.stress.max())
    return min(-low, high) > BOTH_SIGNS * max(-low, high)


def find_turns(strain: FloatArray) -> list[int]:
    """Return the indices of the first point, of every reversal, and of the last extreme of strains (n,)."""
    least = TURN * float(np.ptp(strain))
    turns, extreme, sense = [0], 0, 0
    for i, value in enumerate(strain):
        if sense == 0:
            if abs(value - strain[0]) > least:
                sense, extreme = (1 if value > strain[0] else -1), i
        elif sense * (value - strain[extreme]) > 0.0:
            extreme = i
        elif sense * (strain[extreme] - value) > least:
            turns.append(extreme)
            sense, extreme = -sense, i
    return [*turns, extreme] if extreme > turns[-1] else turns


def read_cyclic(path: Path, sizes: Sizes | None = None) -> CyclicTest:
    """Read a test with reversals. Raises CaseError with every fault."""
    specimens = read_specimens(path, sizes or Sizes())
    if len(specimens) > 1:
        raise CaseError([Problem("", f"{len(specimens)} specimens", "give a file for each test with reversals")], path)
    (one,) = specimens
    strain = one.strain if one.true_strain else np.log1p(one.strain)
    stress = one.stress if one.true_stress else one.stress * np.exp(strain)
    turns = find_turns(strain)
    problems = []
    if float(np.abs(strain).max()) > LARGEST_STRAIN:
        remedy = "per cent go into a column ..._percent or [%]"
        problems.append(Problem("", f"strain to {float(np.abs(strain).max()):g}", remedy))
    if len(turns) < 3:
        problems.append(Problem("", "the strain does not turn", "a test in one direction is a tensile test"))
    for i, (first, last) in enumerate(pairwise(turns), 1):
        if last - first + 1 < FEWEST:
            text = f"{last - first + 1} points"
            problems.append(Problem(f"branch {i}", text, f"give {FEWEST} at least between two reversals"))
    if problems:
        raise CaseError(problems, path)
    parts = [(strain[first : last + 1], stress[first : last + 1]) for first, last in pairwise(turns)]
    ranges = float(np.ptp(strain)), float(np.ptp(stress))
    branches = tuple(_resample(*part, ranges) for part in parts)
    return CyclicTest(branches, tuple(_find_slope(*part) for part in parts), one.how)


def _resample(strain: FloatArray, stress: FloatArray, ranges: tuple[float, float]) -> Branch:
    """Return a branch at equal lengths of its curve, strains in order; ranges: of strain and stress of the test."""
    sense = 1.0 if strain[-1] > strain[0] else -1.0
    order = np.argsort(sense * strain, kind="stable")
    e, s = strain[order], stress[order]
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(e) / ranges[0], np.diff(s) / ranges[1]))])
    at = np.linspace(0.0, length[-1], POINTS + 1)
    return Branch(np.interp(at, length, e), np.interp(at, length, s), float(strain[-1]))


def _find_slope(strain: FloatArray, stress: FloatArray) -> float:
    """Return the slope of the first third of a branch's change of stress [MPa]; nan for too few points."""
    change = np.abs(stress - stress[0])
    last = int(np.argmax(change > 0.3 * change.max()))
    first = int(np.argmax(change > 0.05 * change.max()))
    if last - first < 2 or float(np.ptp(strain[first : last + 1])) <= 0.0:
        return float("nan")
    return float(np.polyfit(strain[first : last + 1], stress[first : last + 1], 1)[0])


def count_points(branches: Sequence[Branch]) -> int:
    """Return the number of points of branches."""
    return sum(len(branch.strain) for branch in branches)
