# SPDX-License-Identifier: Apache-2.0
"""Drawbeads in whole runs: a cup draws in less, both procedures alike; the same bits resumed and with two threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.case import StampingCase, build_model
from presswork.explicit.shells import ExplicitShells
from presswork.law.elastic_plastic import make_sheet_law
from presswork.post.section import measure_draw_in
from presswork.view.plots.outline_plot import plot_outline
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_stamping

TOOL = {"shape": "rectangular", "mu": 0.1}
CUP: dict[str, Any] = {
    "title": "shallow square cup with beads",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [80, 80], "thickness": 0.8, "element_size": 5, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                            "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
    "tools": {
        "punch": {"kind": "punch", "size": [40, 40], "corner_radius": 10, "edge_radius": 6, **TOOL},
        "die": {"kind": "die", "size": [43, 43], "corner_radius": 11.5, "edge_radius": 6, **TOOL},
        "holder": {"kind": "holder", "size": [43, 43], "corner_radius": 11.5, "edge_radius": 1, **TOOL},
    },
    "beads": [{"points": [[-30, -30], [30, -30], [30, 30], [-30, 30]], "closed": True, "radius": 15, "force": 60}],
    "stages": [{"name": "draw", "tools": {"punch": {"stroke": 5}, "holder": {"force": 8000}}}],
    "output": {"rows": 40, "steps": 2, "checkpoint_every": 5},
    "implicit": {"max_increment": 0.05},
}  # fmt: skip
STRIP: dict[str, Any] = {
    **CUP,
    "blank": {"shape": "rectangle", "size": [60, 10], "thickness": 0.8, "element_size": 2.5, "material": "steel"},
    "tools": {},
    "boundary": {"flat": {"set": "all", "fix": ["y", "z"]}},
    "beads": [{"points": [[-10, -5], [-5, 5]], "force": 50}, {"points": [[5, -5], [5, 5]], "force": 20}],
    "stages": [{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 1}]}],
}  # fmt: skip


def test_a_cup_with_a_bead_draws_in_less_by_both_procedures_alike(tmp_path) -> None:
    """The bead holds all round in the end: 60 N/mm times its length. Draw-in within 0.02 mm, punch force 2 %."""
    free = run_stamping(CUP, tmp_path / "free", beads=[])
    explicit = run_stamping(CUP, tmp_path / "explicit")
    implicit = run_stamping(CUP, tmp_path / "implicit", procedure="implicit")
    length = 4 * 30 + 2 * np.pi * 15
    for result in (explicit, implicit):
        assert result.history["bead_1.force"][-1] == pytest.approx(60 * length, rel=1e-3)
    (bead,) = [line for line in plot_outline(implicit).axes[0].lines if line.get_label() == "bead"]
    x, y = bead.get_data()  # of the whole part
    assert [x.min(), x.max(), y.min(), y.max()] == pytest.approx([-30, 30, -30, 30], abs=0.01)
    for angle in (0.0, np.pi / 4):
        without, *with_bead = (measure_draw_in(r, angle) for r in (free, explicit, implicit))
        assert with_bead[0] < 0.75 * without
        assert with_bead[0] == pytest.approx(with_bead[1], abs=0.02)
    assert explicit.history["punch.force"][-1] == pytest.approx(implicit.history["punch.force"][-1], rel=0.02)
    assert explicit.history["punch.force"][-1] > 1.3 * free.history["punch.force"][-1]
    assert explicit.field("thickness_strain").min() < 1.5 * free.field("thickness_strain").min()
    for result, column in ((explicit, "energy_error_percent"), (implicit, "energy_error_percent")):
        assert abs(result.history[column][-1]) < 0.5


@pytest.mark.parametrize("procedure", ["explicit", "implicit"])
def test_a_resumed_run_gives_the_same_bits(tmp_path, procedure) -> None:
    data = {**STRIP, "procedure": procedure}
    one = run_stamping(data, tmp_path / "one")
    assert one.history["bead_1.force"].max() == pytest.approx(50 * np.hypot(5, 10), rel=1e-9)
    run_in_two_parts(build_model(StampingCase.model_validate(data)), tmp_path / "parts", 12)
    assert_same_bits(tmp_path / "parts", one.folder)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_two_threads_give_the_same_bits(precision) -> None:
    """1200 shells: enough for a second thread to be woken."""
    bead = build_model(StampingCase.model_validate(STRIP)).beads[0]
    x, y = np.meshgrid(np.linspace(-30, 30, 61), np.linspace(-5, 5, 21), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (21 * np.arange(60)[:, None] + np.arange(20)).ravel()
    cells = np.column_stack([corner, corner + 21, corner + 22, corner + 1])
    law = make_sheet_law(build_model(StampingCase.model_validate(STRIP)).materials[0])
    dumps, before = [], _core.max_threads()
    for threads in (1, 2):
        _core.set_threads(threads)
        shells = ExplicitShells(points, cells, 0.8, law, 7.85e-9, precision=precision)
        shells.add_bead(bead)
        shells.velocity = np.tile([2000.0, 100.0, 0, 0, 0, 0], (len(points), 1))
        shells.advance(24)
        assert shells.bead_restraint("bead_1") > 0.5 * 50 * np.hypot(5, 10)
        assert abs(shells.energies().error_percent) < (1e-5 if precision == "double" else 1e-2)
        dumps.append(shells.dump())
    _core.set_threads(before)
    for name in dumps[0]:
        np.testing.assert_array_equal(dumps[0][name], dumps[1][name])


def test_what_closes_the_bead_is_taken_off_the_holder(tmp_path) -> None:
    """10 N/mm along 214 mm: 2.1 of the holder's 8 kN."""
    beads = [{**CUP["beads"][0], "closing_force": 10}]
    stages = [{"name": "draw", "tools": {"punch": {"stroke": 1.5}, "holder": {"force": 8000}}}]
    history = run_stamping(CUP, tmp_path / "out", beads=beads, stages=stages).history
    assert history["holder.force"][-1] == pytest.approx(8000 - 10 * (120 + 30 * np.pi), rel=0.02)


def test_a_holder_waits_for_its_stage_and_its_lift_opens_the_bead(tmp_path) -> None:
    """Pushed from the second stage on it must stand still in the first; the bead holds until the holder is lifted."""
    stages = [
        {"name": "touch", "velocity": 5000, "tools": {"punch": {"stroke": 1.5}}},
        {"name": "draw", "velocity": 5000, "tools": {"punch": {"stroke": 2.5}, "holder": {"force": 8000}}},
        {"name": "open", "velocity": 5000, "tools": {"holder": {"stroke": -2}}},
    ]
    history = run_stamping(CUP, tmp_path, stages=stages, output={"rows": 20, "steps": 1}).history
    touch, draw, opened = (history["stage"] == name for name in ("touch", "draw", "open"))
    assert (history["holder.stroke"][touch] == 0.0).all()
    assert history["punch.stroke"][touch][-1] == pytest.approx(1.5, rel=1e-9)
    held = history["holder.force"][draw]
    assert held[len(held) // 2 :].mean() == pytest.approx(8000, rel=0.02)
    (bead,) = (name for name in history if name.startswith("bead") and name.endswith(".force"))
    assert history[bead][draw][-1] > 0.5 * 60 * (4 * 30 + 2 * np.pi * 15)
    after_ramp = history[bead][opened][3:]  # the force leaves within the first tenth, two rows
    assert len(after_ramp) == 17
    assert (after_ramp == 0.0).all()
    assert history["holder.stroke"][-1] - history["holder.stroke"][draw][-1] == pytest.approx(-2, abs=1e-9)
