# SPDX-License-Identifier: Apache-2.0
"""Folds and straightened places of sheets made by hand: waves, a curved wall, bending that was undone."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.fields.surface_defects import (
    FOLD,
    SIDE,
    STRAIGHTENED,
    count_folds,
    find_straightened,
    surface_fields,
)
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
    np.testing.assert_array_equal(ratio[57:], strip(nodes, bent)[FOLD].reshape(80, 6)[57:])


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


def sheet_of(middle: FloatArray, bending: FloatArray) -> dict[str, FloatArray]:
    """A sheet of thickness T with these strains of its middle and of bending (n, 6)."""
    plastic = {f"equivalent_plastic_strain_{place}": np.zeros(len(middle)) for place in ("bottom", "middle", "top")}
    return {"strain_middle": middle, "strain_top": middle + bending, "strain_bottom": middle - bending,
            "thickness": np.full(len(middle), T), **plastic}  # fmt: skip


def in_plane(angle: FloatArray, radial: FloatArray | float, hoop: FloatArray | float) -> FloatArray:
    """Strains along the radius and round it at angles (n,), as xx, yy, zz, xy, yz, xz (n, 6)."""
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    return np.column_stack([
        radial * c * c + hoop * s * s, radial * s * s + hoop * c * c, zero, (radial - hoop) * s * c, zero, zero
    ])  # fmt: skip


def annulus(part: float, size: float, *, cut: bool = False) -> tuple[FloatArray, CellBlock]:
    """Points and cells of a flange from 20 to 40 mm radius, over an angle from 0 on; cut: of triangles."""
    rings, spokes = round(20.0 / size) + 1, round(30.0 * part / size) + 1
    r, a = np.meshgrid(np.linspace(20.0, 40.0, rings), np.linspace(0.0, part, spokes), indexing="ij")
    if part > 6.0:
        spokes, r, a = spokes - 1, r[:, :-1], a[:, :-1]
    i, j = (k.ravel() for k in np.meshgrid(np.arange(rings - 1), np.arange(round(30.0 * part / size)), indexing="ij"))
    there = (j + 1) % spokes if part > 6.0 else j + 1
    cells = np.column_stack([spokes * i + j, spokes * (i + 1) + j, spokes * (i + 1) + there, spokes * i + there])
    if cut:
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    points = np.column_stack([(r * np.cos(a)).ravel(), (r * np.sin(a)).ravel(), np.zeros(r.size)])
    points[np.abs(points) < 1e-12] = 0.0
    return points, CellBlock("shell3_mitc" if cut else "shell4_mitc", cells.astype(np.int32), 0, Section(T, 5))


def wavy(points: FloatArray, block: CellBlock, waves: int, amplitude: float) -> dict[str, FloatArray]:
    """Compressed by 5 % round the axis and bent there in waves, with a crest at y = 0."""
    x, y, _ = points[block.connectivity].mean(axis=1).T
    angle = np.arctan2(y, x)
    bent = in_plane(angle, 0.01, amplitude * np.cos(waves * angle))
    return sheet_of(in_plane(angle, 0.03, -0.05), bent)


PARTS = {"quarter": (0.5 * np.pi, (True, True)), "half": (np.pi, (False, True)), "whole": (2 * np.pi, (False, False))}


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("waves", [4, 8, 12])
def test_a_flange_has_as_many_folds_as_waves_whatever_part_is_modelled(waves: int, cut: bool) -> None:
    """Their amplitude is that of the wave round the flange, 5 %; lines straight on would leave the flange."""
    found = {}
    for name, (part, symmetry) in PARTS.items():
        points, block = annulus(part, 0.5, cut=cut)
        fields = surface_fields(wavy(points, block, waves, 0.04), [block], points, None, symmetry)
        found[name] = fields[FOLD]
        assert count_folds(fields[SIDE], [block], points, symmetry) == waves, name
    inner = np.hypot(*points[block.connectivity].mean(axis=1)[:, :2].T) < 24.0
    if waves > 4:  # of four a line of 16 mm sees less than a wave at the rim
        np.testing.assert_allclose(found["whole"][inner], 0.8, rtol=0.05)
    # a place halfway between two shells belongs to either
    assert found["quarter"].max() == pytest.approx(found["whole"].max(), rel=2e-3)


def test_one_dent_is_one_fold_and_none_is_none() -> None:
    points, block = annulus(0.5 * np.pi, 1.0)
    sheet = wavy(points, block, 8, 0.04)
    x, y, _ = points[block.connectivity].mean(axis=1).T
    far = np.abs(np.arctan2(y, x) - 0.25 * np.pi) > np.pi / 7
    for name in ("strain_top", "strain_bottom"):
        sheet[name][far] = sheet["strain_middle"][far]
    side = surface_fields(sheet, [block], points, None)[SIDE]
    assert count_folds(side, [block], points) == 1
    assert count_folds(np.zeros(len(side)), [block], points) == 0


def test_ripples_lower_than_a_twentieth_of_the_thickness_are_no_folds() -> None:
    """Of the length of three shells, as coarse shells make them on a round tool: 0.02 of the thickness at most."""
    points, block = annulus(0.5 * np.pi, 1.0)
    rippled = wavy(points, block, 60, 0.015)
    assert surface_fields(rippled, [block], points, None, (True, True))[FOLD].max() == 0.0


@pytest.mark.parametrize("seed", range(12))
def test_smooth_parts_have_no_folds(seed: int) -> None:
    """Domes and cups whose section bends over punch and die, strips bent likewise, of coarse and fine shells.

    All are compressed, round the axis or along the section.
    """
    random = np.random.default_rng(seed)
    size, cut = random.uniform(0.5, 3.0), bool(seed % 2)
    points, block = annulus(0.5 * np.pi, size, cut=cut)
    x, y, _ = points[block.connectivity].mean(axis=1).T
    over_punch, over_die = 0.5 * T / random.uniform(3.0, 15.0, 2)
    middle, width = random.uniform(25.0, 35.0), random.uniform(1.0, 4.0)
    round_axis = seed % 3 > 0
    at = np.hypot(x, y) if round_axis else x + 20.0
    section = np.where(at < middle, over_die, -over_punch) * (np.abs(at - middle) < width)
    compressed = -random.uniform(0.003, 0.2)
    if round_axis:
        angle = np.arctan2(y, x)
        sheet = sheet_of(in_plane(angle, 0.02, compressed), in_plane(angle, section, -0.5 * T / at))
    else:
        flat = np.zeros(len(x))
        sheet = sheet_of(in_plane(flat, compressed, 0.01), in_plane(flat, section, 0.0))
    assert surface_fields(sheet, [block], points, None, (round_axis, round_axis))[FOLD].max() == 0.0


@pytest.mark.parametrize("far", [0.0, np.inf, np.nan])
def test_waves_of_cells_in_one_place_or_nowhere(far: float) -> None:
    """The second cell lies where the first lies, or has been lost: it is no neighbour then."""
    centre = np.array([[1.0, 2.0, 3.0], [1.0 + far, 2.0, 3.0]])
    bending, along = np.zeros((2, 6)), np.tile([1.0, 0.0, 0.0], (2, 1))
    bending[:, 0] = 0.1, -0.2
    one = np.ones(1)
    found = _core.find_sheet_waves(
        centre, bending, along, np.zeros(1, dtype=np.int32), 0.5 * one, one, one, n_places=4, least_height=0.0
    )
    assert [float(values[0]) for values in found] == [0.0, 0.1]


def test_threads_do_not_change_a_bit() -> None:
    points, block = annulus(0.5 * np.pi, 1.0)
    before, found = _core.max_threads(), []
    try:
        for threads in (1, 3):
            _core.set_threads(threads)
            found.append(surface_fields(wavy(points, block, 8, 0.04), [block], points, None)[FOLD])
    finally:
        _core.set_threads(before)
    np.testing.assert_array_equal(*found)
