# SPDX-License-Identifier: Apache-2.0
"""Drawbeads of a case: lines with round corners, cut into points on what is modelled; when they hold."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, describe
from presswork.case.stamping.bead import Bead
from presswork.case.stamping.beads import cut_line
from presswork.model import Model
from presswork.process.stamping_tools import tabulate_force, tabulate_share
from tests.unit.case.round_cup import CUP

SQUARE = [[-30, -30], [30, -30], [30, 30], [-30, 30]]


def length_of(line: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def build(beads: list[dict[str, Any]], **changes: Any) -> Any:
    return build_model(StampingCase.model_validate({**copy.deepcopy(CUP), "beads": beads, **changes}))


def test_corners_are_rounded_and_a_square_may_become_a_circle() -> None:
    """Lengths: open, closed, with corners of 10 mm, and with corners as large as they fit."""
    for keys, length in (
        ({}, 180.0),
        ({"closed": True}, 240.0),
        ({"closed": True, "radius": 10}, 160 + 20 * np.pi),
        ({"radius": 10}, 180 - 40 + 10 * np.pi),
        ({"closed": True, "radius": 30}, 60 * np.pi),
    ):
        assert length_of(Bead(points=SQUARE, force=1, **keys).polyline()) == pytest.approx(length, rel=1e-4)
    circle = Bead(points=SQUARE, force=1, closed=True, radius=30).polyline()
    np.testing.assert_allclose(np.linalg.norm(circle, axis=1), 30, rtol=1e-9)
    met = Bead(points=[*SQUARE, SQUARE[0]], force=1, radius=10).polyline()
    assert length_of(met) == pytest.approx(160 + 20 * np.pi, rel=1e-4)


def test_a_line_is_cut_at_symmetry_planes() -> None:
    line = Bead(points=[[-20, -10], [30, 15]], force=1).polyline()
    whole = cut_line(line, 0.7, [False, False])
    half = cut_line(line, 0.7, [True, False])
    assert whole[2].sum() == pytest.approx(length_of(line), rel=1e-12)
    assert half[2].sum() == pytest.approx(0.6 * length_of(line), rel=1e-12)
    assert half[0][:, 0].min() > 0
    assert whole[2].max() <= 0.7
    np.testing.assert_allclose(whole[1] @ (line[1] - line[0]), 0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(whole[1], axis=1), 1, rtol=1e-12)
    assert len(cut_line(line, 0.7, [True, True])[0]) == len(half[0]), "it passes through the origin"
    assert cut_line(-line, 0.7, [True, True])[2].sum() == pytest.approx(0.4 * length_of(line), rel=1e-12)
    assert len(cut_line(line - np.array([40, 0]), 0.7, [True, False])[0]) == 0


def test_a_quarter_has_a_quarter_of_the_line() -> None:
    circle = {"points": [[-40, -40], [40, -40], [40, 40], [-40, 40]], "closed": True, "radius": 40, "force": "80 N/mm"}
    model = build([circle])
    assert model.beads[0].length.sum() == pytest.approx(20 * np.pi, rel=1e-3)
    assert model.beads[0].force == 80
    assert "bead_1: 251.3 mm, 80 N/mm, in draw" in describe(model)


@pytest.mark.parametrize("width", [3.0, 6.0, 7.0])
def test_a_line_beyond_a_narrow_strip_is_as_long_as_the_strip_is_wide(width: float) -> None:
    """Lines of pieces that do not end at the edge, and one that leaves the strip aslant, at 45 degrees."""
    blank = {**CUP["blank"], "shape": "rectangle", "size": [200, width], "element_size": [2, width], "symmetry": ["x"]}
    del blank["diameter"]
    beads = [{"points": points, "force": 60} for points in ([[40, -9], [40, 8]], [[31, -9], [48, 8]])]
    model = build(beads, blank=blank)
    for bead, length in zip(model.beads, (width, np.sqrt(2.0) * width), strict=True):
        assert bead.length.sum() == pytest.approx(length, rel=0.01)
    assert model.beads[0].place[:, 1].min() > -width / 2
    assert model.beads[0].length @ model.beads[0].place[:, 1] == pytest.approx(0.0, abs=0.01 * width**2)


def closed_in(model: Model, bead: int = 0) -> list[str]:
    """The stages in which a bead holds with all of its force."""
    name = model.beads[bead].name
    return [stage.name for stage in model.stages if stage.bead_share[name].tolist() == [[0.0, 1.0]]]


def test_a_bead_holds_while_strokes_keep_the_holder_closed() -> None:
    """Not while it is let down, nor when it is lifted; a die that rises with its holder keeps it closed."""
    stages = [
        {"name": "close", "tools": {"holder": {"stroke": 2}}},
        {"name": "draw", "tools": {"punch": {"stroke": 20}}},
        {"name": "lift", "tools": {"die": {"stroke": 3}, "holder": {"stroke": -3}}},
        {"name": "open", "tools": {"holder": {"stroke": -9}}},
    ]
    bead = {"points": [[35, 0], [35, 20]], "force": 10}
    holder = {**CUP["tools"]["holder"], "position": [0, 0, 2.4]}
    tools = {**CUP["tools"], "holder": holder}
    model = build([bead, {**bead, "stages": ["close"]}], stages=stages, tools=tools)
    assert closed_in(model) == ["draw", "lift"]
    assert closed_in(model, 1) == ["close"]
    times, share = tabulate_share(model, model.beads[0])
    ends = np.cumsum([stage.duration for stage in model.stages])
    np.testing.assert_allclose(np.interp(ends, times, share), [0, 1, 1, 0])
    assert closed_in(build([bead])) == ["draw"], "a pushed holder is closed"


def test_what_closes_a_bead_does_not_press_the_sheet() -> None:
    bead = {"points": [[35, 0], [35, 20]], "force": 10, "closing_force": 50}
    model = build([bead])
    assert tabulate_force(model, "holder")[1][-1] == pytest.approx(10e3 - 4 * 20 * 50)


@pytest.mark.parametrize(("bead", "fragments"), [
    ({"points": [[1, 2]]}, ["beads.0.points", "2"]),
    ({"force": -1}, ["beads.0.force", ">= 0"]),
    ({"force": "80 N"}, ["beads.0.force", "force per length"]),
    ({"radius": 5}, ["beads.0.radius", "no corner"]),
    ({"closed": True}, ["beads.0.points", "three points"]),
    ({"points": [[35, 0], [35, 0]]}, ["beads.0.points", "coincides"]),
    ({"points": [[35, 0], [35, 20], [30, 25]], "radius": 60}, ["beads.0.radius", "too large", "at most"]),
    ({"points": [[60, 0], [60, 20]]}, ["beads.0.points", "no part of the line lies over the blank", "x 60 to 60"]),
    ({"points": [[-35, 1], [-35, 20]]}, ["beads.0.points", "no part", "at x >= 0 and y >= 0"]),
    ({"stages": ["drav"]}, ["beads.0.stages", "no such stage", "did you mean `draw`"]),
    ({"stages": []}, ["beads.0.stages"]),
    ({"closing_force": 200}, ["stages.0.tools.holder.force", "10000 N does not close the beads, which take 1.6e+04 N"]),
    ({"forse": 1}, ["beads.0.forse", "unknown key", "force"]),
])  # fmt: skip
def test_bad_beads_are_named(bead, fragments) -> None:
    with pytest.raises(CaseError) as error:
        build([{"points": [[35, 0], [35, 20]], "force": 10, **bead}])
    for fragment in fragments:
        assert fragment in str(error.value)


def test_a_closing_force_needs_a_pushed_holder() -> None:
    stages = [{"name": "draw", "tools": {"punch": {"stroke": 20}}}]
    with pytest.raises(CaseError, match=r"beads.0.closing_force = 5.*no holder is pushed"):
        build([{"points": [[35, 0], [35, 20]], "force": 10, "closing_force": 5}], stages=stages)


def test_a_line_partly_beside_the_blank_is_said(caplog) -> None:
    model = build([{"points": [[35, 0], [35, 90]], "force": 10}])
    assert 35.0 < model.beads[0].length.sum() < 36.5
    assert "mm of the line lie beside the blank" in caplog.text
