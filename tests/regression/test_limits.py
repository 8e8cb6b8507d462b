# SPDX-License-Identifier: Apache-2.0
"""Runs that are no longer physics stop, say at which stroke and why, keep what they have, and go on if told to."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import StampingCase, build_model, read_case
from presswork.recorder import Outcome, run_model
from tests.regression.test_implicit_stamping import CUP, STRIP
from tests.regression.whole_runs import assert_same_bits

# A billet of mild steel on a die with a rib 1 mm wide: edges of 2.5 mm do not see it.
GEAR_BLANK = """
title = "A billet pressed onto a die with a narrow rib"
analysis = "axisymmetric"
[workpiece]
material = "steel"
element = "tri3"
[workpiece.mesh]
kind = "rectangle"
size = [15, 12]
cells = [6, 5]
pattern = "crossed"
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7850 kg/m^3"
hardening = {law = "linear", yield_stress = 130, modulus = 10}
[tools.punch]
profile = [[0, 12], [40, 12]]
contact = "frictionless"
[tools.die]
profile = [[0, -3], {to = [8.6, -3], radius = 0.3}, {to = [9, 0], radius = 0.15}, {to = [9.6, 0], radius = 0.15}, {to = [10, -3], radius = 0.3}, [40, -3]]
contact = "frictionless"
[boundary.axis]
set = "left"
fix = ["x"]
[[stages]]
name = "press"
[stages.tools.punch]
stroke = 3
direction = [0, -1]
[output]
steps = 4
"""  # noqa: E501
IMPLICIT = [f"tools.{tool}.{key}" for tool in ("punch", "die") for key in ('contact="shear"', "m=0.4")]
EXPLICIT = ['procedure="explicit"', 'workpiece.element="quad4_1pt"', 'workpiece.mesh.pattern="quad"',
            'stages.0.duration="1 ms"', "output.rows=20"]  # fmt: skip
# A round cup whose flange is clamped by its edge: the wall is stretched until it is torn.
TORN_CUP = """
title = "A cup that is torn"
analysis = "stamping"
[blank]
shape = "circle"
diameter = 60
thickness = 0.8
element_size = 4
material = "steel"
symmetry = ["x", "y"]
[materials.steel]
young = "210 GPa"
poisson = 0.3
hardening = {law = "swift", K = 565, e0 = 0.007, n = 0.26}
forming_limit = {law = "keeler", thickness = 0.8, n = 0.26}
[tools.punch]
kind = "punch"
shape = "round"
diameter = 30
edge_radius = 5
mu = 0.1
[tools.die]
kind = "die"
shape = "round"
diameter = 34
edge_radius = 5
mu = 0.1
[boundary.clamped]
set = "edge"
fix = ["x", "y", "z"]
[[stages]]
name = "draw"
velocity = "10 m/s"
tools.punch = {stroke = 30}
[output]
steps = 5
rows = 100
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "case.toml"
    path.write_text(text)
    return path


def run(path: Path, out: Path, *overrides: str, **how: Any) -> Outcome:
    return run_model(build_model(read_case(path, overrides=list(overrides))), out, threads=1, **how)


@pytest.mark.parametrize("overrides", [IMPLICIT, EXPLICIT], ids=["implicit", "explicit"])
def test_a_rib_that_cuts_through_edges_stops_a_forging(tmp_path, overrides) -> None:
    """Half an edge of 2.5 mm: the rib stands at y = 0, where the billet begins, so the stroke says how deep it is."""
    case = write(tmp_path, GEAR_BLANK)
    outcome = run(case, tmp_path / "out", *overrides)
    assert outcome.status == "gave_up"
    summary = outcome.result.summary
    assert summary["status"] == "gave_up"
    stroke = outcome.result.history["punch.stroke"][-1]
    assert 1.25 < stroke < 1.6
    assert f"stage 'press', punch at {stroke:.4g} mm: the tool die has cut" in outcome.reason
    assert "limits.penetration = 0.5" in outcome.reason
    assert "--set limits.stop=false" in outcome.reason
    assert outcome.result.times[-1] == outcome.result.history["time"][-1]  # the state it stopped at is saved
    again = run(case, tmp_path / "out", *overrides, resume=True)
    assert again.status == "gave_up"
    assert len(again.result.history["time"]) == len(outcome.result.history["time"])  # nothing was added
    on = run(case, tmp_path / "out", *overrides, "limits.stop=false", resume=True)
    assert on.status == "completed"
    assert any("has cut" in warning for warning in on.result.summary["warnings"])
    whole = run(case, tmp_path / "whole", *overrides, "limits.stop=false")
    assert_same_bits(on.folder, whole.folder)
    assert on.result.summary["limits"] == whole.result.summary["limits"]
    assert on.result.summary["fields"] == whole.result.summary["fields"]


@pytest.mark.parametrize("overrides", [IMPLICIT, EXPLICIT], ids=["implicit", "explicit"])
def test_a_rib_stops_a_forging_in_plane_strain(tmp_path, overrides) -> None:
    outcome = run(write(tmp_path, GEAR_BLANK), tmp_path / "out", 'analysis="plane_strain"', *overrides)
    assert outcome.status == "gave_up"
    stroke = outcome.result.history["punch.stroke"][-1]
    assert 1.25 < stroke < 1.7
    assert f"stage 'press', punch at {stroke:.4g} mm: the tool die has cut" in outcome.reason


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_thinned_strip_stops_where_the_volume_says(tmp_path, procedure) -> None:
    """A strip in tension has thinned by 1 - (L0/L)^(1/2): by a tenth at 2.35 mm of 10."""
    case = StampingCase.model_validate(
        {
            **STRIP,
            "procedure": procedure,
            "limits": {"thinning": 0.1},
            "stages": [
                {**STRIP["stages"][0], "displacement": [{"set": "right", "component": "x", "value": 3}]},
            ],
        }
    )
    outcome = run_model(build_model(case), tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert "limits.thinning = 0.1" in outcome.reason
    limit = outcome.result.summary["limits"]["thinning"]["largest"]
    way = outcome.result.points()[:, 0].max() - 10
    assert 10 / 0.9**2 - 10 < way < 10 / 0.9**2 - 10 + 0.2  # a row is 0.15 mm
    assert limit == pytest.approx(1 - (10 / (10 + way)) ** 0.5, abs=2e-3)


def test_a_tool_in_the_sheet_stops_an_implicit_stamping(tmp_path) -> None:
    """Nodes keep off tools to a hundredth of the thickness; a limit below that stops the run."""
    draw = {**CUP, "stages": [{"name": "draw", "tools": {"punch": {"stroke": 1}}}]}
    whole = run_model(build_model(StampingCase.model_validate(draw)), tmp_path / "whole", threads=1)
    assert whole.status == "completed"
    deepest = whole.result.summary["limits"]["penetration"]
    assert 0 < deepest["largest"] < 0.1
    limits = {"penetration": 0.5 * deepest["largest"]}
    limited = StampingCase.model_validate({**draw, "limits": limits})
    stopped = run_model(build_model(limited), tmp_path / "out", threads=1)
    assert stopped.status == "gave_up"
    assert "deep in the surface of the sheet of 0.8 mm" in stopped.reason


def test_limits_are_what_the_case_says(tmp_path) -> None:
    case = write(tmp_path, GEAR_BLANK)
    deeper = run(case, tmp_path / "deeper", "limits.penetration=0.8", "stages.0.tools.punch.stroke=1.6")
    assert deeper.status == "completed"
    # a billet upset without friction has a third of its flow stress
    flat = "tools.die.profile=[[0, 0], [40, 0]]"
    assert run(case, tmp_path / "flat", flat, "stages.0.tools.punch.stroke=0.5").status == "completed"
    stressed = run(case, tmp_path / "stressed", flat, "limits.hydrostatic_stress=0.3")
    assert stressed.status == "gave_up"
    assert "the hydrostatic stress is" in stressed.reason
    assert "0.333 times the flow stress" in stressed.reason


CLOSED_DIE = """
title = "A billet in a closed die that its volume more than fills"
analysis = "axisymmetric"
[workpiece]
material = "steel"
[workpiece.mesh]
kind = "rectangle"
size = [10, 20]
cells = [10, 20]
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7850 kg/m^3"
hardening = {law = "swift", K = 700, e0 = 0.015, n = 0.2}
[tools.punch]
profile = [[0, 20], [40, 20]]
contact = "frictionless"
[tools.container]
profile = [[12, -5], [12, 30]]
contact = "frictionless"
[boundary.axis]
set = "left"
fix = ["x"]
[boundary.middle]
set = "bottom"
fix = ["y"]
[[stages]]
name = "press"
[stages.tools.punch]
stroke = 9
direction = [0, -1]
[limits]
stop = false
"""


@pytest.mark.parametrize(
    "overrides", [[], [*EXPLICIT[:2], EXPLICIT[3], "output.rows=200"]], ids=["implicit", "explicit"]
)
@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_a_closed_cavity_stops_a_run_that_would_go_on_beyond_its_limits(tmp_path, analysis, overrides) -> None:
    """A full container answers by the bulk modulus: the pressure is K times the logarithm of the lost volume.

    The volume of the container, 12 wide, is that of the billet, 10 wide and 20 high, where the punch stands at
    20 (10 / 12)^2 in axisymmetry, and at 20 (10 / 12) in plane strain.
    """
    outcome = run(write(tmp_path, CLOSED_DIE), tmp_path / "out", f'analysis="{analysis}"', *overrides)
    assert outcome.status == "gave_up"
    history, largest = outcome.result.history, outcome.result.summary["limits"]["mean_pressure"]["largest"]
    stroke, force = history["punch.stroke"][-1], abs(history["punch.force"][-1])
    full = 20 * (10 / 12) ** (2 if analysis == "axisymmetric" else 1)
    stop = re.search(r"mean pressure in the workpiece is ([\d.e+]+) MPa, ([\d.]+) times its mean flow", outcome.reason)
    assert stop is not None
    assert float(stop[2]) == pytest.approx(largest, rel=5e-3)
    assert 10.0 < largest < 15.0
    assert float(stop[1]) == pytest.approx(200e3 / 3 / (1 - 0.6) * np.log(full / (20 - stroke)), rel=0.05)
    assert f"punch presses with {force:.4g} N" in outcome.reason
    if not overrides:
        assert "hold 100 % of the surface" in outcome.reason
    assert "--set limits.mean_pressure=" in outcome.reason
    on = run(write(tmp_path, CLOSED_DIE), tmp_path / "on", f'analysis="{analysis}"', *overrides,
             "limits.mean_pressure=1000", f"stages.0.tools.punch.stroke={stroke + 0.2}")  # fmt: skip
    assert on.status == "completed"


def test_a_closed_cavity_stops_with_its_fill_and_force(tmp_path) -> None:
    """The punch has a cone of 2 mm on a radius of 8 mm: the container is full where 6.41 mm of the stroke are done."""
    keys = ["tools.punch.profile=[[0, 22], [8, 20], [12.5, 20]]", "workpiece.mesh.cells=[8, 14]"]
    outcome = run(write(tmp_path, CLOSED_DIE), tmp_path / "out", *keys, "stages.0.tools.punch.stroke=8")
    assert outcome.status == "gave_up"
    last = {name: column[-1] for name, column in outcome.result.history.items()}
    full = 20.0 - (20.0 * 10**2 - 2.0 * 8**2 / 3.0) / 12**2
    assert full < last["punch.stroke"] < full + 0.6
    assert "tools and supports hold 100 % of the surface" in outcome.reason
    assert f"the wall of punch is filled to {100.0 * last['punch.fill']:.3g} %" in outcome.reason
    assert last["punch.fill"] > 0.85
    assert f"punch presses with {abs(last['punch.force']):.4g} N" in outcome.reason
    assert "shorten the stroke, make the workpiece smaller, or open the die" in outcome.reason


@pytest.fixture(scope="module")
def torn(tmp_path_factory) -> dict[str, Outcome]:
    """The cup stopped at the limit, and let go on to its end."""
    folder = tmp_path_factory.mktemp("torn")
    case = write(folder, TORN_CUP)
    return {
        "stopped": run(case, folder / "stopped"),
        "went on": run(case, folder / "went_on", "limits.stop=false"),
    }


def test_a_torn_cup_stops_and_says_when_it_cracked(torn) -> None:
    stopped = torn["stopped"]
    assert stopped.status == "gave_up"
    assert "the sheet is thinned by" in stopped.reason
    assert "limits.thinning = 0.7" in stopped.reason
    result, summary = stopped.result, stopped.result.summary
    stroke = result.history["punch.stroke"][-1]
    assert f"punch at {stroke:.4g} mm" in stopped.reason
    assert 70.0 < summary["formability"]["largest_thinning_percent"]["value"] < 80.0
    crack = summary["first_crack"]
    assert crack["stage"] == "draw"
    assert 0.0 < crack["strokes_mm"]["punch"] < stroke
    assert crack["margin"] < 0.0
    margins = [result.field("forming_limit_margin", step).min() for step in range(len(result.times))]
    before = [m for m, t in zip(margins, result.times, strict=True) if t < crack["time_s"]]
    after = [m for m, t in zip(margins, result.times, strict=True) if t >= crack["time_s"]]
    assert min(before) >= 0.0 > max(after)


def test_a_torn_cup_goes_on_if_told_to(torn) -> None:
    went_on = torn["went on"]
    assert went_on.status == "completed"
    summary = went_on.result.summary
    assert any("the sheet is thinned by" in warning for warning in summary["warnings"])
    assert summary["first_crack"] == torn["stopped"].result.summary["first_crack"]
    assert summary["limits"]["thinning"]["largest"] > 0.7


def test_the_summary_holds_the_extremes_of_every_field_with_place_and_step(torn) -> None:
    """Against all the steps of the results file."""
    result = torn["went on"].result
    found = result.summary["fields"]
    for name in ("thinning", "thickness", "effective_stress_top", "forming_limit_margin"):
        values = np.array([result.field(name, step) for step in range(len(result.times))])
        for key, pick in (("smallest", np.argmin), ("largest", np.argmax)):
            step, cell = np.unravel_index(pick(values), values.shape)
            assert found[name][key]["value"] == pytest.approx(values[step, cell])
            at = found[name][key]
            if (values == values[step, cell]).sum() == 1:
                assert at["step"] == step
                now = result.points(step)
                places = np.concatenate([now[block.connectivity].mean(axis=1) for block in result.mesh.blocks])
                assert at["at_mm"] == pytest.approx(places[cell])
    assert set(found) >= {"displacement", "contact_force", "stress_top_xx", "major_strain_middle"}


def test_the_summary_holds_the_largest_forces_with_the_stroke(torn) -> None:
    result = torn["went on"].result
    at = int(np.argmax(np.abs(result.history["punch.force"])))
    punch = result.summary["largest_forces"]["punch"]
    assert punch["force_n"] == result.history["punch.force"][at]
    assert punch["strokes_mm"] == {"punch": result.history["punch.stroke"][at]}
    assert punch["stage"] == "draw"


def test_the_command_line_ends_with_status_3_and_the_stroke(tmp_path) -> None:
    case = write(tmp_path, GEAR_BLANK)
    command = [sys.executable, "-c", "from presswork.cli import app; app()", "run", str(case), "--no-plot"]
    done = subprocess.run([*command, "--output", str(tmp_path / "out")], capture_output=True, text=True, check=False)
    assert done.returncode == 3, done.stderr
    assert "gave up: stage 'press', punch at" in done.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["fraction_computed"] < 1.0
