# SPDX-License-Identifier: Apache-2.0
"""The one-step solver against closed forms and an axisymmetric solution by other means."""

import meshio
import numpy as np
import pytest

from presswork.mesh.files.part_file import read_part, refine_edges
from presswork.mesh.make.remesh import POOR
from presswork.mesh.triangles import triangle_quality
from presswork.onestep import solve_one_step
from presswork.onestep.part import OneStepError
from tests.problems.one_step import (
    NO_QUADS,
    NO_TRIANGLES,
    cup_profile,
    fan,
    flow_stress,
    make_model,
    revolve,
    solve_of_revolution,
    steel,
)


def grid(nx: int, ny: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points of the unit square (n, 2) and quadrilaterals."""
    x, y = np.meshgrid(np.linspace(0, 1, nx + 1), np.linspace(0, 1, ny + 1), indexing="ij")
    index = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.stack([x.ravel(), y.ravel()], axis=1), quads.astype(np.int32)


def test_a_flat_part_is_its_own_blank():
    flat, quads = grid(7, 5)
    points = np.column_stack([60.0 * flat[:, 0] + 3.0, 40.0 * flat[:, 1] - 7.0, np.full(len(flat), 12.0)])
    result = solve_one_step(make_model(points, NO_TRIANGLES, quads, layers=3))
    assert np.abs(result.blank - points[:, :2]).max() < 1e-9
    assert np.abs(result.fields["thickness_strain"]).max() < 1e-10
    assert result.punch_force < 1e-3


def test_a_strip_bent_into_a_cylinder_unrolls():
    """A developable part: without strain in the membrane the blank is the strip, a chord for every arc."""
    flat, quads = grid(4, 24)
    angle, radius = np.pi * (flat[:, 1] - 0.5), 20.0
    points = np.column_stack([30.0 * flat[:, 0], radius * np.sin(angle), radius * np.cos(angle)])
    result = solve_one_step(make_model(points, NO_TRIANGLES, quads))
    chords = 24 * 2.0 * radius * np.sin(np.pi / 48)
    assert np.ptp(result.blank[:, 0]) == pytest.approx(30.0, abs=1e-8)
    assert np.ptp(result.blank[:, 1]) == pytest.approx(chords, abs=1e-8)
    assert result.fields["effective_stress"].max() < 1e-3


def test_a_cone_sector_unrolls():
    """Half a cone of 30 degrees to its axis: the blank is a ring sector of half the angle."""
    flat, quads = grid(12, 40)
    along, angle = 20.0 + 40.0 * flat[:, 0], np.pi * (flat[:, 1] - 0.5)
    r = along * 0.5
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), -along * np.sqrt(0.75)])
    result = solve_one_step(make_model(points, NO_TRIANGLES, quads[:, ::-1].copy()))
    ends = result.blank[np.isclose(flat[:, 1], 0.0)], result.blank[np.isclose(flat[:, 1], 1.0)]
    first, last = (end[-1] - end[0] for end in ends)
    turn = np.degrees(np.arccos(first @ last / np.linalg.norm(first) / np.linalg.norm(last)))
    assert np.linalg.norm(first) == pytest.approx(40.0, rel=1e-3)
    assert turn == pytest.approx(90.0, rel=2e-3)


def cap_profile(radius: float, opening: float, n: int) -> np.ndarray:
    angle = np.linspace(0.0, np.radians(opening), n + 1)
    return np.stack([radius * np.sin(angle), radius * (1.0 - np.cos(angle))], axis=1)


def cone_profile(half_angle: float, length: float, n: int) -> np.ndarray:
    along = np.linspace(0.0, length, n + 1)
    return np.stack([along * np.sin(np.radians(half_angle)), along * np.cos(np.radians(half_angle))], axis=1)


@pytest.mark.parametrize(
    ("profile", "around", "tolerance"),
    [
        (cap_profile(50.0, 60.0, 20), 48, 2e-3),
        (cone_profile(50.0, 50.0, 20), 48, 2e-3),
        (cup_profile(25.0, 5.0, 18.0, 36.0, 1.8), 72, 2e-3),
    ],
    ids=["sphere", "cone", "cup"],
)
def test_parts_of_revolution_against_equilibrium_of_rings(profile, around, tolerance):
    points, quads = revolve(profile, around)
    result = solve_one_step(make_model(points, fan(around), quads))
    radii = np.linalg.norm(result.blank - result.blank[0], axis=1)[1:].reshape(-1, around)
    assert np.ptp(radii, axis=1).max() < 1e-4 * radii.max()
    fine = np.stack([np.interp(np.linspace(0, 1, 6 * (len(profile) - 1) + 1), np.linspace(0, 1, len(profile)), c)
                     for c in profile.T], axis=1)  # fmt: skip
    expected = solve_of_revolution(fine, flow_stress)[::6][1:]
    assert radii.mean(axis=1) == pytest.approx(expected, abs=tolerance * expected[-1])


def test_a_cups_blank_against_constant_area():
    """Constant area with the mid-surface, D^2 = 4 A / pi; strains shift it by little: the textbook rule for cups."""
    profile = cup_profile(25.0, 5.0, 15.0, 32.0, 2.5)
    points, quads = revolve(profile, 48)
    result = solve_one_step(make_model(points, fan(48), quads))
    r, z = profile.T
    area = np.pi * ((r[1:] + r[:-1]) * np.hypot(np.diff(r), np.diff(z))).sum()
    diameter = 2.0 * np.linalg.norm(result.blank[-48:] - result.blank[0], axis=1).mean()
    assert diameter == pytest.approx(np.sqrt(4.0 * area / np.pi), rel=0.03)


@pytest.fixture(scope="module")
def cup():
    points, quads = revolve(cup_profile(25.0, 5.0, 18.0, 36.0, 2.5), 40)
    return points, fan(40), quads


HILL = (0.2826, 0.3584, 0.6416, 1.5, 1.5, 1.289)


def test_convergence_is_quadratic(cup):
    residuals = solve_one_step(make_model(*cup, material=steel(HILL), layers=3)).residuals
    last = [r for r in residuals if r < 0.05][-3:]
    assert last[1] < 2.0 * last[0] ** 1.5
    assert residuals[-1] < 1e-6


def test_place_and_numbers_do_not_matter(cup):
    points, triangles, quads = cup
    first = solve_one_step(make_model(points, triangles, quads, layers=3))
    c, s = np.cos(0.7), np.sin(0.7)
    turned = points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + [120.0, -40.0, 300.0]
    order = np.random.default_rng(1).permutation(len(points))
    number = np.argsort(order).astype(np.int32)
    other = solve_one_step(make_model(turned[order], number[triangles], number[quads], layers=3))
    for name in ("thickness_strain", "major_strain_middle"):
        assert other.fields[name] == pytest.approx(first.fields[name], abs=1e-6)
    back = (other.blank[number] - [120.0, -40.0]) @ np.array([[c, -s], [s, c]])
    assert back == pytest.approx(first.blank, abs=1e-4)


def test_a_quarter_gives_the_whole(cup):
    """Symmetry planes: the same blank, strains and whole force."""
    points, triangles, quads = cup
    whole = solve_one_step(make_model(points, triangles, quads, layers=3, holder_force=8e3, mu=0.1))
    centre = [points[c].mean(axis=1) for c in (triangles, quads)]
    kept = [cells[(m[:, 0] > 0) & (m[:, 1] > 0)] for cells, m in zip((triangles, quads), centre, strict=True)]
    used, flat = np.unique(np.concatenate([c.ravel() for c in kept]), return_inverse=True)
    split = 3 * len(kept[0])
    cells = flat[:split].reshape(-1, 3).astype(np.int32), flat[split:].reshape(-1, 4).astype(np.int32)
    quarter = solve_one_step(
        make_model(points[used], *cells, symmetry=(True, True), layers=3, holder_force=8e3, mu=0.1)
    )
    assert quarter.blank == pytest.approx(whole.blank[used], abs=2e-3)
    assert quarter.punch_force == pytest.approx(whole.punch_force, rel=2e-3)


def test_friction_raises_force_and_thins(cup):
    free = solve_one_step(make_model(*cup))
    held = solve_one_step(make_model(*cup, holder_force=2e4, mu=0.1))
    assert held.punch_force > free.punch_force + 2 * 0.1 * 2e4 * 0.9
    assert held.fields["thickness_strain"].min() < free.fields["thickness_strain"].min()
    assert np.ptp(held.blank, axis=0).max() < np.ptp(free.blank, axis=0).max()


def test_triangles_alone_give_the_same_blank(cup):
    points, triangles, quads = cup
    halves = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    mixed = solve_one_step(make_model(points, triangles, quads))
    plain = solve_one_step(make_model(points, np.concatenate([triangles, halves]), NO_QUADS))
    assert plain.blank == pytest.approx(mixed.blank, abs=0.05)


def cad_facets(around: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the cup of 25 mm as CAD programs write it: a triangle's corners on the faces' edges and fillets alone.

    The bottom is a fan from one point of its rim, wall and flange are one strip each: slivers of 1 to 30.
    """
    arc = np.linspace(-np.pi / 2, 0.0, 7)
    foot = np.stack([20.0 + 5.0 * np.cos(arc), 5.0 + 5.0 * np.sin(arc)], axis=1)
    shoulder = np.stack([30.0 - 5.0 * np.cos(arc + np.pi / 2), 13.0 + 5.0 * np.sin(arc + np.pi / 2)], axis=1)
    profile = np.concatenate([foot, shoulder, [[40.0, 18.0]]])
    angle = 2.0 * np.pi * np.arange(around) / around
    rings = profile[:, :1, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)[None]
    points = np.dstack([rings, np.broadcast_to(profile[:, 1:], rings.shape[:2])]).reshape(-1, 3)
    ring = np.arange(len(points)).reshape(-1, around)
    after = np.roll(ring, -1, axis=1)
    quads = np.stack([ring[:-1], ring[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    corner = np.arange(1, around - 1)
    bottom = np.stack([np.zeros_like(corner), corner, corner + 1], axis=1)
    return points, np.concatenate([bottom, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)]).astype(np.int32)


def test_slivers_of_cad_facets_give_the_cup_its_blank():
    points, triangles = refine_edges(*cad_facets(72), 5.0)
    corners = points[triangles]
    sides = (np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) ** 2).sum(axis=1)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    assert (4.0 * np.sqrt(3.0) * area / sides).min() < 0.1  # halving leaves slivers
    model = make_model(points, triangles, NO_QUADS)
    result = solve_one_step(model)
    rim = result.blank[model.rims[0]]
    radius = np.linalg.norm(rim - rim.mean(axis=0), axis=1)
    wanted = solve_of_revolution(cup_profile(25.0, 5.0, 18.0, 40.0, 0.25), flow_stress)[-1]
    assert radius == pytest.approx(np.full(len(radius), wanted), rel=4e-3)


@pytest.mark.parametrize("width", [0.0, 5e-4])
def test_cad_facets_read_from_a_file_give_the_blank_of_the_cup(width, tmp_path):
    """The same facets, bare or with a rim of slivers: read, halved, their slivers collapsed."""
    points, triangles = cad_facets(72)
    if width:
        rim, n = np.arange(len(points) - 72, len(points)), len(points)
        points = np.concatenate([points, points[rim] * [1.0 + width / 40.0, 1.0 + width / 40.0, 1.0]])
        after, out, beyond = np.roll(rim, -1), n + np.arange(72), n + np.roll(np.arange(72), -1)
        strip = np.concatenate([np.stack([rim, out, beyond], axis=1), np.stack([rim, beyond, after], axis=1)])
        triangles = np.concatenate([triangles, strip])
    meshio.Mesh(points, [("triangle", triangles)]).write(tmp_path / "cup.stl", binary=True)
    part, notes = read_part(tmp_path / "cup.stl", element_size=5.0)
    assert "collapsed" in notes[-1]
    assert triangle_quality(part.points, part.triangles).min() >= POOR
    result = solve_one_step(make_model(part.points, part.triangles, NO_QUADS))
    rim = result.blank[part.rims[0]]
    middle = 0.5 * (rim.min(axis=0) + rim.max(axis=0))
    wanted = solve_of_revolution(cup_profile(25.0, 5.0, 18.0, 40.0, 0.25), flow_stress)[-1]
    assert np.linalg.norm(rim - middle, axis=1) == pytest.approx(np.full(len(rim), wanted), rel=1e-3)


def test_a_part_too_deep_for_its_sheet_is_refused_where_it_tears():
    """A square cup of 50 mm, 60 mm deep."""
    points, quads = revolve(cup_profile(25.0, 5.0, 60.0, 45.0, 4.0), 48)
    angle = np.arctan2(points[:, 1], points[:, 0])
    square = (np.abs(np.cos(angle)) ** 8 + np.abs(np.sin(angle)) ** 8) ** -0.125
    points[:, :2] *= square[:, None]
    with pytest.raises(OneStepError, match=r"\d+ % thinner near \(.* too deep there"):
        solve_one_step(make_model(points, fan(48), quads, layers=3))
