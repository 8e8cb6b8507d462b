# SPDX-License-Identifier: Apache-2.0
"""Equivalent plastic strain at fracture by laws of triaxiality and Lode angle, against formulas evaluated apart.

tests/data/fracture_strains.csv has four laws (two of them with several metals) in eleven states of stress, to 1e-6.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from presswork import _core

NAMES = {"MMC": "modified_mohr_coulomb", "HC": "hosford_coulomb", "JC": "johnson_cook"}
JOHNSON_COOK = {"d4": 0.0, "d5": 0.0, "reference_rate": 1.0, "reference": 20.0, "melting": 1500.0}
DIGITS = 5e-7
"""The table has six decimals."""


def read_table() -> list[tuple[str, dict[str, float], np.ndarray, float]]:
    """Return criterion, parameters, principal stresses (3,) and fracture strain of every row."""
    rows = []
    text = (Path(__file__).parents[1] / "data" / "fracture_strains.csv").read_text("utf-8")
    for row in csv.DictReader(line for line in text.splitlines() if not line.startswith("#")):
        words = row["parameters"].split()
        first = next(i for i, word in enumerate(words) if word in ("A", "a", "D1"))
        given = dict(zip(words[first::2], map(float, words[first + 1 :: 2]), strict=True))
        if row["law"] == "JC":
            given = {name.lower(): value for name, value in given.items()} | JOHNSON_COOK
        stress = np.array([float(row[f"s{i}"]) for i in (1, 2, 3)])
        rows.append((NAMES[row["law"]], given, stress, float(row["fracture_strain"])))
    return rows


def find_fracture_strain(criterion: str, given: dict[str, float], stress: np.ndarray) -> np.ndarray:
    """Return fracture strains (n,) by the damage of a small plastic strain under stresses (n, 3 | 4 | 6)."""
    kernel = _core.Damage(_core.DamageCriterion[criterion], given)
    n, strain = len(stress), 1e-3
    found = kernel.advance(np.zeros(n), stress, stress, np.zeros(n), np.full(n, strain), dt=1.0)
    return strain / np.maximum(found, 1e-300)


@pytest.mark.parametrize("components", [4, 6])
def test_fracture_strains_are_those_of_the_table(components: int) -> None:
    rows = read_table()
    assert len(rows) == 66
    for criterion, given, principal, exact in rows:
        stress = np.zeros((1, components))
        stress[0, :3] = 400.0 * principal
        assert find_fracture_strain(criterion, given, stress)[0] == pytest.approx(exact, abs=DIGITS, rel=1e-7)


def test_fracture_strains_of_sheets_are_those_of_the_table() -> None:
    """In plane stress, whichever of the principal stresses is none."""
    seen = 0
    for criterion, given, principal, exact in read_table():
        if 0.0 not in principal:
            continue
        in_plane = np.delete(principal, np.flatnonzero(principal == 0.0)[0])
        mean, half = 0.5 * in_plane.sum(), 0.5 * (in_plane[0] - in_plane[1])
        turned = [mean + half * np.cos(0.7), mean - half * np.cos(0.7), half * np.sin(0.7)]
        found = find_fracture_strain(criterion, given, 400.0 * np.array([turned]))[0]
        assert found == pytest.approx(exact, abs=DIGITS, rel=1e-7)
        seen += 1
    assert seen == 48


def test_a_turned_stress_has_the_same_fracture_strain() -> None:
    random = np.random.default_rng(3)
    turns = np.linalg.qr(random.standard_normal((50, 3, 3)))[0]
    for criterion, given, principal, exact in read_table():
        turned = 250.0 * np.einsum("nij,j,nkj->nik", turns, principal, turns)
        stress = turned.reshape(-1, 9)[:, [0, 4, 8, 1, 5, 2]]
        np.testing.assert_allclose(find_fracture_strain(criterion, given, stress), exact, rtol=1e-6, atol=DIGITS)


def test_the_parabola_of_bai_and_wierzbicki_passes_through_its_three_curves() -> None:
    """Axisymmetric tension, shear and plane strain, axisymmetric compression; between them by the Lode angle."""
    given = {"d1": 0.6, "d2": 1.7, "d3": 0.3, "d4": 0.2, "d5": 0.8, "d6": 1.1}
    angle = np.linspace(0.0, np.pi / 3, 13)
    deviator = 2 / 3 * np.cos(angle[:, None] - np.array([0.0, 2.0, -2.0]) * np.pi / 3)
    for x in (-0.3, 0.0, 0.6):
        stress = np.zeros((len(angle), 6))
        stress[:, :3] = 300.0 * (deviator + x)
        e = [given[f"d{k}"] * np.exp(-given[f"d{k + 1}"] * x) for k in (1, 3, 5)]
        y = 1.0 - 6.0 * angle / np.pi
        exact = 0.5 * (e[0] + e[2] - 2 * e[1]) * y**2 + 0.5 * (e[0] - e[2]) * y + e[1]
        np.testing.assert_allclose(find_fracture_strain("bai_wierzbicki", given, stress), exact, rtol=2e-7)
        np.testing.assert_allclose(exact[[0, 6, 12]], [e[0], e[1], e[2]], rtol=1e-12)


def test_no_damage_grows_where_pressure_holds_the_metal_together() -> None:
    stress = np.array([[-900.0, -900.0, -1200.0, 0.0]])
    mohr = {"A": 740.0, "n": 0.15, "c1": 0.3, "c2": 338.6, "c3": 1.0}
    for criterion, given in (
        ("modified_mohr_coulomb", mohr),
        ("hosford_coulomb", {"a": 1.7, "b": 0.7, "c": 0.3, "n": 0.1}),
    ):
        kernel = _core.Damage(_core.DamageCriterion[criterion], given)
        found = kernel.advance(np.zeros(1), stress, stress, np.zeros(1), np.ones(1), dt=1.0)
        assert 0.0 <= found[0] < 1e-6
