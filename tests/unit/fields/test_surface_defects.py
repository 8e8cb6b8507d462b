# SPDX-License-Identifier: Apache-2.0
"""Folds and straightened places of sheets made by hand: waves, a curved wall, bending that was undone."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.fields.surface_defects import FOLD, STRAIGHTENED, find_straightened, surface_fields
from presswork.model import CellBlock, FloatArray, Section

T, WAVE = 0.8, 16.0
"""Thickness and wave length [mm]."""


def strip(
    height: FloatArray,
    bent: FloatArray,
    *,
    along: float = -0.05,
    across: float = 0.04,
    force: FloatArray | None = None,
) -> dict[str, FloatArray]:
    """Return fold ratio and straightened strain of a strip of 80 x 6 shells of 1 mm along x.

    height (81,): of the nodes by x [mm]; bent (80,): bending strain along x; force (567, 3): of tools on the nodes.
    """
    x, y = np.meshgrid(np.arange(81.0), np.arange(7.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.repeat(height, 7)])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(80), np.arange(6), indexing="ij"))
    first = 7 * i + j
    cells = np.column_stack([first, first + 7, first + 8, first + 1]).astype(np.int32)
    block = CellBlock("shell4_mitc", cells, 0, Section(T, 5))
    middle = np.zeros((480, 6))
    middle[:, 0], middle[:, 1] = along, across
    bending = np.zeros((480, 6))
    bending[:, 0] = bent[i]
    plastic = np.full(480, 0.05)
    face = plastic + 2.0 / np.sqrt(3.0) * np.abs(bent[i])
    sheet = {"strain_middle": middle, "strain_top": middle + bending, "strain_bottom": middle - bending,
             "thickness": np.full(480, T), "equivalent_plastic_strain_middle": plastic,
             "equivalent_plastic_strain_top": face, "equivalent_plastic_strain_bottom": face}  # fmt: skip
    return surface_fields(sheet, [block], points, force)


def wave(height: float) -> tuple[FloatArray, FloatArray, float]:
    """Return heights of nodes, bending strains of cells, and their amplitude: t/2 (2 pi/wave)^2 height."""
    k = 2.0 * np.pi / WAVE
    amplitude = 0.5 * T * k * k * height
    middles = np.arange(80) + 0.5
    return height * np.sin(k * np.arange(81)), -amplitude * np.sin(k * middles), amplitude


@pytest.mark.parametrize("height", [0.1, 0.4])
def test_the_fold_ratio_of_a_wave_is_its_bending_over_the_compression(height: float) -> None:
    nodes, bent, amplitude = wave(height)
    ratio = strip(nodes, bent)[FOLD].reshape(80, 6)
    np.testing.assert_allclose(ratio[15:65], amplitude / 0.05, rtol=0.05)  # two ends lack a neighbour


def test_a_wave_in_tension_is_no_fold() -> None:
    nodes, bent, _ = wave(0.4)
    assert strip(nodes, bent, along=0.05)[FOLD].max() == 0.0


def test_a_wall_that_is_bent_to_one_side_is_no_fold() -> None:
    """A round wall of radius 60 mm, compressed along its round."""
    x = np.arange(81.0) - 40.0
    assert strip(-(x**2) / 120.0, np.full(80, 0.5 * T / 60.0))[FOLD].max() == 0.0


def test_the_section_of_a_low_wall_is_no_fold() -> None:
    """Bent over the punch to one side and over the die to the other, hardly strained in its middle."""
    nodes, bent, _ = wave(0.4)
    assert strip(nodes, bent, along=-0.001, across=0.0017)[FOLD].max() == 0.0


def test_shells_that_a_tool_touches_have_no_fold() -> None:
    nodes, bent, _ = wave(0.4)
    force = np.zeros((567, 3))
    force[: 7 * 40, 2] = 5.0
    ratio = strip(nodes, bent, force=force)[FOLD].reshape(80, 6)
    assert ratio[:40].max() == 0.0
    np.testing.assert_array_equal(ratio[40:], strip(nodes, bent)[FOLD].reshape(80, 6)[40:])


def test_straightened_is_what_the_faces_have_more_than_their_bending() -> None:
    """Bent by 0.1 and half undone: the faces have 2/sqrt(3) (0.1 + 0.05), the shape has 0.05."""
    flat = np.zeros(81)
    bent = strip(flat, np.full(80, 0.05), across=0.0)[STRAIGHTENED]
    np.testing.assert_allclose(bent, 0.0, atol=1e-15)
    sheet = {f"strain_{place}": np.zeros((1, 6)) for place in ("bottom", "middle", "top")}
    sheet["strain_top"][0, 0], sheet["strain_bottom"][0, 0] = 0.05, -0.05
    plastic = {"bottom": 0.2 + 0.15 * 2 / 3**0.5, "middle": 0.2, "top": 0.2 + 0.15 * 2 / 3**0.5}
    sheet |= {f"equivalent_plastic_strain_{place}": np.array([p]) for place, p in plastic.items()}
    assert find_straightened(sheet)[0] == pytest.approx(0.1 * 2 / 3**0.5)


@pytest.mark.parametrize("thickness", [0.0, 2.0, 30.0])  # of the box that holds the cells, beside 30 mm
@pytest.mark.parametrize("threads", [1, 3])
def test_bending_along_lines_is_that_of_the_nearest_cells(thickness: float, threads: int) -> None:
    """Beside a search of all cells, by NumPy."""
    random = np.random.default_rng(3)
    centre = random.random((500, 3)) * (30.0, 30.0, thickness)
    bending, own = random.standard_normal((500, 6)), np.arange(0, 500, 7, dtype=np.int32)
    along = random.standard_normal((len(own), 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    way = np.tile(np.concatenate([np.arange(1.0, 9.0), -np.arange(1.0, 9.0)]), (len(own), 1))
    within = random.uniform(0.2, 4.0, way.shape)
    before = _core.max_threads()
    _core.set_threads(threads)
    try:
        up, down = _core.find_bending_along(centre, bending, own, along, way, within)
    finally:
        _core.set_threads(before)

    place = centre[own, None] + way[..., None] * along[:, None]
    away = np.linalg.norm(place[:, :, None] - centre, axis=3)
    near = away.argmin(axis=2)
    outer = np.einsum("ci,cj->cij", along, along)
    share = outer[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]] * (1, 1, 1, 2, 2, 2)
    bent = np.where(away.min(axis=2) <= within, np.einsum("cs,cps->cp", share, bending[near]), 0.0)
    bent = np.column_stack([bent, np.einsum("cs,cs->c", share, bending[own])])
    assert 0.1 < (bent == 0.0).mean() < 0.9  # places with and without a cell
    np.testing.assert_allclose(up, np.maximum(bent.max(axis=1), 0.0), atol=1e-14)
    np.testing.assert_allclose(down, np.maximum(-bent.min(axis=1), 0.0), atol=1e-14)


@pytest.mark.parametrize("far", [0.0, np.inf, np.nan])
def test_bending_along_lines_of_cells_in_one_place_or_nowhere(far: float) -> None:
    """The second cell lies where the first lies, or has been lost: it is no neighbour then."""
    centre = np.array([[1.0, 2.0, 3.0], [1.0 + far, 2.0, 3.0]])
    bending = np.zeros((2, 6))
    bending[:, 0] = 0.1, -0.2
    lines = (np.zeros(1, dtype=np.int32), np.array([[1.0, 0.0, 0.0]]), np.array([[0.5]]), np.array([[1.0]]))
    up, down = _core.find_bending_along(centre, bending, *lines)
    assert (up, down) == (0.1, 0.0)  # of two as near, the one of the lower number
