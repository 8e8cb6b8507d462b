# SPDX-License-Identifier: Apache-2.0
"""Stamping cases by the implicit procedure: one key changed, the same results, pictures and checkpoints."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import CaseError, StampingCase, build_model
from presswork.geometry.swept_tool import triangulate
from presswork.model import Triangulation
from presswork.post.section import measure_draw_in
from presswork.recorder import StartError, run_model
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_stamping, run_to_end

STEEL = {"young": "206 GPa", "poisson": 0.3, "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}
STRIP: dict[str, Any] = {
    "title": "strip in tension",
    "analysis": "stamping",
    "procedure": "implicit",
    "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": STEEL},
    "boundary": {"flat": {"set": "all", "fix": ["z"]}},
    "stages": [{"name": "pull", "velocity": "0.5 m/s",
                "displacement": [{"set": "right", "component": "x", "value": 1}]}],
    "output": {"rows": 20, "steps": 2},
}  # fmt: skip
HOLDER_FORCE = 8000.0
CUP: dict[str, Any] = {
    "title": "shallow square cup",
    "analysis": "stamping",
    "procedure": "implicit",
    "blank": {"shape": "rectangle", "size": [80, 80], "thickness": 0.8, "element_size": 5, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": STEEL},
    "tools": {
        "punch": {"kind": "punch", "shape": "rectangular", "size": [40, 40], "corner_radius": 10, "edge_radius": 6,
                  "mu": 0.1},
        "die": {"kind": "die", "shape": "rectangular", "size": [43, 43], "corner_radius": 11.5, "edge_radius": 6,
                "mu": 0.1},
        "holder": {"kind": "holder", "shape": "rectangular", "size": [43, 43], "corner_radius": 11.5,
                   "edge_radius": 1, "mu": 0.1},
    },
    "stages": [{"name": "draw", "tools": {"punch": {"stroke": 6}, "holder": {"force": HOLDER_FORCE}}}],
    "draw_in": {"side": 0, "between": 30, "diagonal": 45},
    "output": {"rows": 40, "steps": 2, "checkpoint_every": 5},
    "implicit": {"max_increment": 0.05},
}  # fmt: skip


@pytest.fixture(scope="module")
def cup(tmp_path_factory) -> Result:
    return run_stamping(CUP, tmp_path_factory.mktemp("cup") / "out")


def test_a_strip_in_tension_follows_its_flow_curve(tmp_path) -> None:
    """Uniaxial tension of von Mises: stress = K (e0 + p)^n, width and thickness strain -p/2; fields as explicit's."""
    pulled = run_stamping(STRIP, tmp_path / "out")
    strain = np.log(11 / 10)
    stress = pulled.field("stress_middle_xx")
    p = strain - stress.mean() / 206e3
    np.testing.assert_allclose(stress, 565.32 * (0.007117 + p) ** 0.2589, rtol=1e-4)
    np.testing.assert_allclose(pulled.field("thickness_strain"), -p / 2 - 0.3 * stress / 206e3, rtol=2e-3)
    other = run_stamping(STRIP, tmp_path / "explicit", procedure="explicit")
    assert set(pulled.field_names) == set(other.field_names)
    np.testing.assert_allclose(pulled.field("eqps"), other.field("eqps"), rtol=2e-3)


@pytest.mark.parametrize("angle", [0, 90])
def test_the_rolling_direction_turns_the_material(tmp_path, angle) -> None:
    """Width over thickness strain of a strip is r0 along the rolling direction, and r90 across it."""
    sheet = {**STEEL, "yield_function": {"law": "hill1948", "r00": 1.8, "r45": 1.5, "r90": 2.3}}
    blank = {**STRIP["blank"], "rolling_direction": angle}
    pulled = run_stamping(STRIP, tmp_path / "out", materials={"steel": sheet}, blank=blank)
    elastic = 0.3 * pulled.field("stress_middle_xx") / 206e3
    r = (pulled.field("lamina_strain_middle_xx" if angle == 90 else "lamina_strain_middle_yy") + elastic) / (
        pulled.field("thickness_strain") + elastic
    )
    np.testing.assert_allclose(r, 1.8 if angle == 0 else 2.3, rtol=5e-3)


def test_the_holder_pushes_with_its_force_and_forces_balance(cup) -> None:
    """The force comes up within the stage's ramp, then it is held; what pushes down, the die carries."""
    history = cup.history
    formed = history["punch.stroke"] > 0.5
    np.testing.assert_allclose(history["holder.force"][formed], HOLDER_FORCE, rtol=1e-4)
    assert (np.diff(history["holder.force"]) > -1e-4 * HOLDER_FORCE).all()
    largest = history["die.force"].max()
    np.testing.assert_allclose(
        history["die.force"], history["punch.force"] + history["holder.force"], atol=1e-3 * largest
    )
    assert history["punch.stroke"][-1] == pytest.approx(6.0)
    assert -0.2 < history["holder.stroke"][-1] < 0.0  # the flange thickens and lifts it
    assert abs(history["energy_error_percent"][-1]) < 0.5
    assert cup.summary["warnings"] == []


def test_history_has_the_draw_in_that_sections_of_saved_steps_show(cup) -> None:
    for name, angle in CUP["draw_in"].items():
        column = cup.history[f"{name}.draw_in"]
        for step, time in enumerate(cup.times[1:], start=1):
            row = int(np.argmin(np.abs(cup.history["time"] - time)))
            assert column[row] == pytest.approx(measure_draw_in(cup, np.radians(angle), step), rel=1e-9)
    assert cup.history["side.draw_in"][-1] > cup.history["diagonal.draw_in"][-1] > 0.1


def test_draw_in_where_no_blank_lies_is_refused() -> None:
    with pytest.raises(CaseError, match=r"draw_in\.back = 100\.0: no edge of the blank lies in this direction"):
        build_model(StampingCase.model_validate({**CUP, "draw_in": {"back": 100}}))


def test_history_of_a_trimmed_part_keeps_what_forming_has_left_at_points_and_edges(tmp_path) -> None:
    trim = {"sides": {"shape": "rectangle", "size": [14, 6]}}
    stop = [{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 1}]}]
    case = {**STRIP, "stages": stop, "draw_in": {"end": 0}, "points": {"middle": [5, 2, 0]}, "trim": trim}
    history = run_stamping(case, tmp_path / "out").history
    assert list(history["stage"][-2:]) == ["pull", "trim"]
    for name in ("end.draw_in", "middle.x", "middle.thickness"):
        assert history[name][-1] == history[name][-2]
    assert history["end.draw_in"][-1] == pytest.approx(-1.0, abs=1e-9)


def test_one_key_changed_gives_the_same_cup(cup, tmp_path) -> None:
    """By explicit dynamics: draw-in within 0.1 mm, punch force 5 %, thickness strain 0.01."""
    other = run_stamping(CUP, tmp_path / "out", procedure="explicit")
    np.testing.assert_array_equal(cup.mesh.points, other.mesh.points)
    edge = np.argmax(cup.mesh.points[:, 0] - cup.mesh.points[:, 1])
    draw_in = [-r.field("displacement")[edge, 0] for r in (cup, other)]
    assert draw_in[0] > 0.4
    assert draw_in[0] == pytest.approx(draw_in[1], abs=0.1)
    assert cup.history["punch.force"][-1] == pytest.approx(other.history["punch.force"][-1], rel=0.05)
    np.testing.assert_allclose(cup.field("thickness_strain"), other.field("thickness_strain"), atol=0.01)


def test_tools_of_coarse_triangles_draw_the_same_cup(cup, tmp_path) -> None:
    """Chords 0.2 mm off the tools: draw-in within 0.01 mm, force 0.2 %, thickness strain 0.001, few more iterations."""
    model = build_model(StampingCase.model_validate(CUP))
    tools = [replace(t, shape=Triangulation(*triangulate(t.shape, 0.2), is_closed=False)) for t in model.tools]
    other = run_to_end(replace(model, tools=tuple(tools)), tmp_path / "out")
    edge = np.argmax(cup.mesh.points[:, 0] - cup.mesh.points[:, 1])
    draw_in = [-r.field("displacement")[edge, 0] for r in (cup, other)]
    assert draw_in[0] == pytest.approx(draw_in[1], abs=0.01)
    assert cup.history["punch.force"][-1] == pytest.approx(other.history["punch.force"][-1], rel=2e-3)
    np.testing.assert_allclose(cup.field("thickness_strain"), other.field("thickness_strain"), atol=1e-3)
    assert other.summary["iterations"] < 1.25 * cup.summary["iterations"]


def test_a_die_that_rises_draws_the_same_cup(cup, tmp_path) -> None:
    """What moves counts for nothing: forces and thickness of a punch that comes down, and the holder goes along."""
    lift = [{"name": "lift", "tools": {"die": {"stroke": 6}, "holder": {"force": HOLDER_FORCE}}}]
    lifted = run_stamping(CUP, tmp_path / "out", stages=lift)
    assert lifted.history["holder.stroke"][-1] == pytest.approx(cup.history["holder.stroke"][-1] - 6.0, abs=1e-3)
    for tool in ("punch", "die", "holder"):
        last = [r.history[f"{tool}.force"][-1] for r in (lifted, cup)]
        assert last[0] == pytest.approx(last[1], rel=5e-3)
    np.testing.assert_allclose(lifted.field("thickness"), cup.field("thickness"), rtol=1e-3)


def test_a_draw_in_two_stages_is_that_in_one(cup, tmp_path) -> None:
    """What tools bear when a stage ends they go on bearing: the punch force has no jump there."""
    stages = [
        {"name": name, "tools": {"punch": {"stroke": 3}, "holder": {"force": HOLDER_FORCE}}} for name in ("one", "two")
    ]
    parts = run_stamping(CUP, tmp_path / "out", stages=stages)
    stroke, force = parts.history["punch.stroke"], parts.history["punch.force"]
    whole = np.interp(stroke, cup.history["punch.stroke"], cup.history["punch.force"])
    second = parts.history["stage"] == "two"
    np.testing.assert_allclose(force[second], whole[second], rtol=0.05)
    assert force[-1] == pytest.approx(cup.history["punch.force"][-1], rel=5e-3)
    np.testing.assert_allclose(parts.field("displacement"), cup.field("displacement"), atol=0.02)


def test_a_punch_that_goes_back_lets_go_and_the_holder_keeps_its_force(tmp_path) -> None:
    back = [*CUP["stages"], {"name": "back", "tools": {"punch": {"stroke": -6}}}]
    history = run_stamping(CUP, tmp_path / "out", stages=back).history
    assert history["punch.stroke"][-1] == pytest.approx(0.0, abs=1e-9)
    assert history["punch.force"][-1] == 0.0
    assert history["holder.force"][-1] == pytest.approx(HOLDER_FORCE, rel=1e-4)


@pytest.mark.validation
def test_a_holder_comes_to_stand_on_the_rising_die_as_the_cup_is_drawn_through(tmp_path) -> None:
    """A round cup; bare, the holder is a sheet's thickness nearer to the die, and goes on with it."""
    blank = {"shape": "circle", "diameter": 60, "thickness": 1, "element_size": 7.5, "material": "steel"}
    tools = {"punch": (30, 5, 0.1), "die": (33, 5, 0.05), "holder": (34, 1, 0.05)}
    history = run_stamping(
        {**CUP, "blank": {**blank, "symmetry": ["x", "y"]}, "implicit": {}}, tmp_path / "out",
        tools={kind: {"kind": kind, "shape": "round", "diameter": diameter, "edge_radius": edge, "mu": mu}
               for kind, (diameter, edge, mu) in tools.items()},
        stages=[{"name": "lift", "tools": {"die": {"stroke": 34}, "holder": {"force": 6000}}}],
    ).history  # fmt: skip
    bare = history["holder.stroke"] + history["die.stroke"]
    assert bare.max() == bare[-1] == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(history["holder.force"][(bare < 0.99) & (history["die.stroke"] > 3)], 6000, rtol=1e-3)
    assert history["holder.force"][-1] == 0.0


def test_pictures_are_drawn(cup, tmp_path) -> None:
    names = [p.name for p in plot_all(cup, tmp_path, fields=["thickness_strain"])]
    assert {
        "force_stroke.png",
        "draw_in.png",
        "energies.png",
        "outline_002.png",
        "shell_thickness_strain_002.png",
    } <= set(names)


def test_a_resumed_run_gives_the_same_bits(cup, tmp_path) -> None:
    run_in_two_parts(build_model(StampingCase.model_validate(CUP)), tmp_path / "part", 12)
    assert_same_bits(tmp_path / "part", cup.folder)


def test_giving_up_leaves_results_and_says_why(tmp_path) -> None:
    model = build_model(StampingCase.model_validate(CUP))
    strict = replace(model, solver=replace(model.solver, max_iterations=4, min_increment=5e-4))
    outcome = run_model(strict, tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert "finds no equilibrium" in outcome.reason
    assert np.isfinite(outcome.result.field("displacement")).all()


def test_a_blank_that_nothing_holds_is_refused(tmp_path) -> None:
    free = {**STRIP, "boundary": {}}
    with pytest.raises(StartError, match="1 rigid motion \\(z\\)"):
        run_model(build_model(StampingCase.model_validate(free)), tmp_path / "out")


@pytest.mark.parametrize(("implicit", "fragment"), [
    ({"initial_increment": 0.5}, "initial_increment"),
    ({"max_increment": 1.5}, "max_increment"),
    ({"line_search": True}, "line_search"),
])  # fmt: skip
def test_bad_settings_are_named(implicit, fragment) -> None:
    with pytest.raises(CaseError, match=fragment):
        StampingCase.model_validate({**CUP, "implicit": implicit})
