# SPDX-License-Identifier: Apache-2.0
"""Parts drawn at random for validation: their faces are sound, their tools offsets, their radii those asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.api import load
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.triangles import double_areas, find_rims
from presswork.model import Triangulation
from validation.stamped_cases import draw_tools, write_case, write_onestep
from validation.stamped_parts import KINDS, draw_face, draw_part, draw_section

SAGITTA = 0.03
"""Of the chords of radii up to 10 mm, which offsets in facets are off by [mm]."""
EACH_KIND = range(len(KINDS), 2 * len(KINDS))


def _curve(seed: int, binder_radius: float):
    return replace(draw_part(seed), binder_radius=binder_radius)


@pytest.mark.parametrize("seed", EACH_KIND)
def test_faces_are_wound_alike_with_one_rim_and_no_overhang(seed):
    part = draw_part(seed)
    for face in (draw_face(part, 0.0), *draw_tools(part, 40.0).values()):
        edges = np.concatenate([face.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        assert len(np.unique(edges, axis=0)) == len(edges)  # no edge goes the same way twice: wound alike, no overlap
        assert double_areas(face.points, face.triangles)[:, 2].min() > -1e-9
    assert len(find_rims(*_arrays(draw_face(part, 0.0)))) == 1


@pytest.mark.parametrize("binder_radius", [0.0, 800.0])
@pytest.mark.parametrize("seed", EACH_KIND)
def test_punch_and_die_leave_thickness_and_clearance(seed, binder_radius):
    part = _curve(seed, binder_radius)
    tools = draw_tools(part, 40.0)
    die = make_surface(Triangulation(*_arrays(tools["die"]), is_closed=False))
    section = draw_section(part)
    inner = part.half[0] + section.s[section.wall_end]
    near = tools["punch"].points
    near = near[(near[:, 2] < part.depth) & (np.abs(near[:, 1]) < 0.6 * part.half[1]) & (np.abs(near[:, 0]) < inner)]
    gap = die.nearest(np.ascontiguousarray(near))[0]
    assert np.abs(gap - part.thickness - part.clearance).max() < SAGITTA


@pytest.mark.parametrize("seed", EACH_KIND)
def test_radii_and_depth_are_those_asked_for(seed):
    part = draw_part(seed)
    section = draw_section(part)
    line = np.stack([section.s, section.z], axis=1)
    die = line - 0.5 * part.thickness * section.normal
    punch = line + (0.5 * part.thickness + part.clearance) * section.normal
    first_arc = int(np.argmax(np.isclose(section.normal[:, 1], np.sin(part.draft)))) + 1
    assert _fit_radius(die[section.wall_end : section.flange_start + 1]) == pytest.approx(part.die_radius)
    assert _fit_radius(punch[:first_arc]) == pytest.approx(part.punch_radius)
    assert section.z[0] == pytest.approx(-part.depth)
    assert section.z[-1] == pytest.approx(0.0, abs=1e-9)
    assert section.s[-1] - section.s[section.flange_start] == pytest.approx(part.flange)


def test_a_part_carries_its_cases(tmp_path):
    part = draw_part(13)
    model = load(write_case(part, tmp_path))
    assert {tool.kind for tool in model.tools} == {"punch", "die", "holder"}
    assert len(load(write_onestep(part, tmp_path)).triangles) > 100


def _arrays(face):
    return face.points, face.triangles


def _fit_radius(points):
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), (points**2).sum(axis=1))
    return float(np.sqrt(c + 0.25 * (a**2 + b**2)))
