# SPDX-License-Identifier: Apache-2.0
"""Means over a neighbourhood: those of a ball in closed form, on any mesh; what ripples with the mesh is no crack.

With the weights (1 - (d/R)^2)^2 the mean of the square of one coordinate over a ball of radius R is R^2/9, over a disc
R^2/8: ratios of integrals of polynomials.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from presswork.mesh.make.blanks import assign_section, mesh_rectangular_blank
from presswork.mesh.make.box import mesh_box
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import Damage, Section, Support
from presswork.observe.contract import Evolved
from presswork.observe.damage import DamagePeaks, find_peaks
from presswork.observe.neighbourhood import FormedBlock

RADIUS, FALL = 2.0, 0.02
"""Of the neighbourhood, and of the damage by the square of the distance from where it is largest."""


def make_model(mesh, analysis="plane_strain", *, planes=(), critical=0.9, length=RADIUS):
    """What a model has that find_peaks looks at; planes: axes that a support of the set `left` or `bottom` holds."""
    names, dimension = ("left", "bottom", "back"), mesh.points.shape[1]
    supports = [Support(names[axis], tuple(i == axis for i in range(dimension))) for axis in planes]
    material = SimpleNamespace(damage=Damage("cockcroft_latham", {}, critical, length))
    return SimpleNamespace(mesh=mesh, analysis=analysis, lasting_supports=supports, materials=[material])


def mesh_plane(size, *, low=(0.0, 0.0), cells=(24, 24)):
    lines = (np.linspace(a, a + b, n + 1) for a, b, n in zip(low, size, cells, strict=True))
    return mesh_rectangle(*lines, element="quad4_fbar")


def measure(model, mesh, centre, length=RADIUS):
    """Return the largest mean of a damage of 1 at a place that falls by the square of the distance from there."""
    middles = mesh.points[mesh.blocks[0].connectivity].mean(axis=1)
    damage = 1.0 - FALL * ((middles - centre) ** 2).sum(axis=1)
    return FormedBlock(model, mesh, mesh.points, 0).find_largest_mean(damage[:, None], length)[0]


@pytest.mark.parametrize("cells", [21, 31, 41])
def test_a_long_body_and_rings_far_from_the_axis_have_the_mean_of_a_ball(cells):
    """Of the squares of two of three coordinates: 2 R^2 / 9."""
    mesh = mesh_plane((8.0, 8.0), low=(100.0, 0.0), cells=(cells, cells))
    for analysis in ("plane_strain", "axisymmetric"):
        mean = measure(make_model(mesh, analysis), mesh, [104.0, 4.0])
        assert 1.0 - mean == pytest.approx(FALL * 2.0 * RADIUS**2 / 9.0, rel=0.03), analysis


@pytest.mark.parametrize("cells", [20, 30, 40])
def test_on_the_axis_the_neighbourhood_is_a_ball(cells):
    """Of the squares of all coordinates: R^2 / 3; counted in the half plane without 2 pi r they would be R^2 / 4.

    The middle of the innermost cell is half a cell off the axis, which adds its square.
    """
    mesh = mesh_plane((4.0, 8.0), cells=(cells // 2, cells + 1))
    mean = measure(make_model(mesh, "axisymmetric"), mesh, [0.0, 4.0])
    assert 1.0 - mean == pytest.approx(FALL * (RADIUS**2 / 3.0 + (4.0 / cells) ** 2), rel=0.03)


def test_in_space_the_neighbourhood_is_a_ball_and_goes_on_beyond_symmetry_planes():
    lines = [np.linspace(-3.0, 3.0, 21)] * 3
    whole, eighth = mesh_box(*lines, element="hex8_fbar"), mesh_box(*(x[10:] for x in lines), element="hex8_fbar")
    expected = FALL * (RADIUS**2 / 3.0 + 3.0 * 0.15**2)
    assert 1.0 - measure(make_model(whole), whole, np.zeros(3)) == pytest.approx(expected, rel=0.03)
    of_eighth = measure(make_model(eighth, planes=(0, 1, 2)), eighth, np.zeros(3))
    assert of_eighth == pytest.approx(measure(make_model(whole), whole, np.zeros(3)), rel=1e-9)


def test_in_a_sheet_the_neighbourhood_is_a_disc_of_one_layer():
    """Of the squares of both coordinates over a disc: R^2 / 4; middles of cells are half a cell off the centre."""
    blank = mesh_rectangular_blank((8.0, 8.0), 0.4, (False, False))
    mesh = assign_section(blank, {"quad4": "shell4_mitc"}, Section(1.0, points=2), 0)
    middles = mesh.points[mesh.blocks[0].connectivity].mean(axis=1)
    fall = 1.0 - FALL * (middles[:, :2] ** 2).sum(axis=1)
    damage = np.column_stack([0.5 * fall, fall])
    mean = FormedBlock(make_model(mesh), mesh, mesh.points, 0).find_largest_mean(damage, RADIUS)[0]
    assert 1.0 - mean == pytest.approx(FALL * (RADIUS**2 / 4.0 + 2.0 * 0.2**2), rel=0.03)


@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"])
@pytest.mark.parametrize("length", [None, RADIUS])
def test_a_ripple_of_the_mesh_is_no_crack_and_its_mean_beyond_the_limit_is(analysis, length):
    """Damage of 0.218 on the axis that ripples from cell to cell by 0.034, as in a steady extrusion."""
    mesh = mesh_plane((4.0, 30.0), cells=(8, 60))
    rows = np.rint(mesh.points[mesh.blocks[0].connectivity].mean(axis=1)[:, 1] / 0.5 - 0.5).astype(int)
    draw = np.random.default_rng(3)
    steady = (rows > 6) & (rows < 52)
    ripple = np.where(steady, 0.034 * np.where(rows % 2, -1.0, 1.0) + 0.002 * draw.normal(size=len(rows)), 0.0)
    for critical, cracks in ((0.235, False), (0.21, True)):
        model = make_model(mesh, analysis, critical=critical, length=length)
        evolved = {"damage_cockcroft_latham": [np.tile((0.218 + ripple)[:, None], 4)]}
        (peak,) = find_peaks(model, mesh, mesh.points, evolved, {"damage_cockcroft_latham": [critical]}, [None])
        assert peak.value > 0.25
        assert peak.mean.value == pytest.approx(0.218, abs=0.009)
        assert peak.mean.is_beyond == cracks
        assert peak.mean.length == (RADIUS if length else pytest.approx(2.0 * 0.5))


@pytest.mark.parametrize(("own", "radius"), [(None, 1.5), (1.0, 1.0)])
def test_the_length_of_the_material_goes_before_that_of_the_body(own, radius):
    mesh = mesh_plane((8.0, 8.0))
    model, evolved = make_model(mesh, length=own), {"damage_cockcroft_latham": [np.ones((24 * 24, 4))]}
    (peak,) = find_peaks(model, mesh, mesh.points, evolved, {"damage_cockcroft_latham": [0.9]}, [1.5])
    assert peak.mean.length == radius


def test_neighbours_are_those_of_the_undeformed_material():
    """Drawn out to four times its length a bar has the means of the material that it had."""
    mesh = mesh_plane((8.0, 8.0))
    model, middles = make_model(mesh), mesh.points[mesh.blocks[0].connectivity].mean(axis=1)
    damage = (1.0 - FALL * ((middles - 4.0) ** 2).sum(axis=1))[:, None]
    at_first, drawn = (
        FormedBlock(model, mesh, mesh.points * stretch, 0).find_largest_mean(damage, RADIUS)
        for stretch in ([1.0, 1.0], [0.25, 4.0])
    )
    assert drawn[0] == pytest.approx(at_first[0], rel=1e-9)
    assert drawn[1:] == at_first[1:]


def test_peaks_of_an_instant_are_found_once():
    mesh = mesh_plane((4.0, 4.0))
    model, calls = make_model(mesh), []

    def evolved():
        calls.append(1)
        return Evolved({"damage_oyane": [np.ones((len(mesh.blocks[0].connectivity), 4))]}, {"damage_oyane": [None]})

    peaks = DamagePeaks(model)
    vars(peaks)["_lengths"] = [None]
    for number, epoch in ((0, 1), (0, 1), (0, 2), (1, 2)):
        run = SimpleNamespace(
            number=number, epoch=epoch, model=model, mesh=mesh, evolved=evolved, positions=lambda: mesh.points
        )
        peaks.find(run)
    assert len(calls) == 3


def test_another_body_does_not_count():
    mesh = mesh_plane((8.0, 4.0), cells=(16, 8))
    cells = mesh.blocks[0].connectivity
    left = mesh.points[cells].mean(axis=1)[:, 0] < 4.0
    two = replace(mesh, blocks=tuple(replace(mesh.blocks[0], connectivity=cells[own]) for own in (left, ~left)))
    evolved = {"damage_oyane": [np.full((left.sum(), 4), 0.8), np.full(((~left).sum(), 4), 0.2)]}
    (peak,) = find_peaks(make_model(two), two, two.points, evolved, {"damage_oyane": [None, None]}, [None, None])
    assert peak.mean.value == pytest.approx(0.8)
