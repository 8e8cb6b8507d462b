# SPDX-License-Identifier: Apache-2.0
"""Packaged forgings and extrusions on meshes that change, and closed dies drawn at random: hands off to the end."""

import re

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.post import measure_die_fill
from presswork.process.begin import begin
from presswork.recorder import run_model
from presswork.results import Result
from validation.closed_dies import FILLED, forge
from validation.force_steps import find_steps
from validation.sharp_corners import make_flash, make_hub

pytestmark = pytest.mark.validation

CAVITIES = {"forging_hub": ("die", 20.4), "forging_h_section": ("die", 19.0), "gear_blank": ("finisher", 28.5)}


@pytest.mark.parametrize(
    "name",
    [
        "forging_hub",
        "forging_h_section",
        "gear_blank",
        "can_extrusion",
        "combined_extrusion",
        "piercing",
        "upsetting_90",
        "bimetal_upsetting",
    ],
)
def test_example_goes_to_its_end(name, tmp_path):
    """The end of the last stroke; volume within 1e-4 beyond the elastic part, energy within 1 %; dies full; no new mesh
    changes the force by more than 2 %.
    """
    model = build_model(Case.from_toml(str(copy_example(name, tmp_path))))
    assert run_model(model, tmp_path / "run", threads=1).status == "completed"
    result = Result(tmp_path / "run")
    summary = result.summary
    volume = summary["volume"]
    assert summary["remeshes"] >= 4
    assert abs(volume["change_percent"] - volume["elastic_part_percent"]) < 0.01
    assert abs(summary["energy"]["error_percent"]) < 1.0
    assert find_steps(tmp_path / "run").at_rest.max() < 0.02
    if name in CAVITIES:
        tool, outer = CAVITIES[name]
        assert measure_die_fill(result, tool, x_range=(0.0, outer)).filled == pytest.approx(1.0)


def test_hub_on_a_sharp_corner_is_forged_to_full_die(tmp_path):
    """The packaged case: without new meshes it stops before 80 % of the stroke."""
    case = Case.from_toml(str(copy_example("forging_hub", tmp_path)))
    assert run_model(build_model(case), tmp_path / "run", threads=1).status == "completed"
    result = Result(tmp_path / "run")
    assert measure_die_fill(result, "die", x_range=(0, 20.4)).filled == pytest.approx(1.0)
    summary, rows = result.summary, result.history
    fill = summary["die_fill"]["die"]
    assert fill["wall_filled"] == rows["die.fill"][-1] == pytest.approx(1.0)
    assert fill["largest_gap_mm"] < 0.11
    assert fill["flash_thickness_mm"] == rows["die.flash_thickness"][-1] == pytest.approx(2.0, abs=0.02)
    assert 0.2 < rows["die.fill"][len(rows["time"]) // 2] < 0.9
    assert summary["remeshes"] >= 4
    volume = summary["volume"]
    assert abs(volume["change_percent"] - volume["elastic_part_percent"]) < 0.01
    assert abs(summary["energy"]["error_percent"]) < 1.0
    contact = summary["contact"]
    assert contact["largest_edge_penetration_mm"] < 0.045
    assert contact["largest_penetration_of_an_edge"] < 0.1
    assert not any("cut" in warning for warning in summary["warnings"])
    changes = re.findall(r"largest force of a tool changes by ([\d.]+)%", (tmp_path / "run" / "run.log").read_text())
    assert len(changes) == summary["remeshes"]
    assert max(map(float, changes)) < 1.0


@pytest.mark.parametrize(("foot", "land"), [(2.0, 1.5), (1.0, 1.5), (0.0, 1.5), (3.0, 0.0), (0.0, 0.0)])
def test_hub_on_sharper_corners_is_forged_to_full_die(foot, land, tmp_path):
    """The packaged hub has 3 mm at its foot and 1.5 mm at its flash land; 0 is a sharp corner."""
    model = build_model(make_hub(foot, land, None, tmp_path))
    assert run_model(model, tmp_path / "run", threads=1).status == "completed"
    result = Result(tmp_path / "run")
    assert measure_die_fill(result, "die", x_range=(0.0, 20.4)).filled == pytest.approx(1.0)
    volume = result.summary["volume"]
    assert abs(volume["change_percent"] - volume["elastic_part_percent"]) < 0.01
    assert abs(result.summary["energy"]["error_percent"]) < 1.0


def make_hub_on(foot, size, folder):
    """The packaged hub on another radius at its foot."""
    return make_hub(foot, 1.5, size, folder)


CLOSES = pytest.mark.xfail(strict=True, reason="2.4 % at 0.945 of the stroke, where 6 um of it are as much force")
SHAPES = [(make, radius) for radius in (3.0, 2.0, 1.0) for make in (make_hub_on, make_flash)]


@pytest.mark.parametrize(
    ("make", "radius"), [pytest.param(*of, marks=CLOSES if of == (make_hub_on, 3.0) else ()) for of in SHAPES]
)
def test_cells_of_half_the_size_change_the_force_by_less_than_2_percent(make, radius, tmp_path):
    """At every twentieth of the stroke, and at every two hundredth of its last seventh, while the die is filled."""
    parts = np.concatenate([np.arange(2, 17) / 20, np.arange(172, 201) / 200])
    force = {}
    for size in (0.75, 0.375):
        folder = tmp_path / f"case_{size:g}"
        folder.mkdir()
        case = make(radius, size, folder)
        case = case.model_copy(update={"output": case.output.model_copy(update={"at": tuple(parts[15:-1].tolist())})})
        assert run_model(build_model(case), tmp_path / f"{size:g}", threads=1).status == "completed"
        result = Result(tmp_path / f"{size:g}")
        assert measure_die_fill(result, "die", x_range=(0.0, 20.4)).filled == pytest.approx(1.0)
        volume, rows = result.summary["volume"], result.history
        assert abs(volume["change_percent"] - volume["elastic_part_percent"]) < 0.01
        assert abs(result.summary["energy"]["error_percent"]) < 1.0
        force[size] = np.interp(parts * 5.6, rows["die.stroke"], rows["die.force"])
    assert np.abs(force[0.75] / force[0.375] - 1.0).max() < 0.02


def test_most_closed_dies_drawn_at_random_are_filled(tmp_path):
    """A tenth of the hundred of `python -m validation.closed_dies`."""
    found = [forge(seed, tmp_path / f"die_{seed}") for seed in range(10)]
    filled = np.array([die.filled for die in found])
    assert (filled >= FILLED).sum() >= 9, [die.reason for die in found]
    assert max(abs(die.volume) for die in found) < 5e-4


def _run(case):
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, recording


@pytest.fixture(scope="module")
def two_bodies(tmp_path_factory):
    """The packaged core and ring on one mesh with cells of half the size."""
    path = copy_example("two_bodies", tmp_path_factory.mktemp("bodies"))
    keys = ["remesh.enabled=false", "workpiece.mesh.cells=[24,40]", "bodies.ring.mesh.cells=[14,32]"]
    return path, _run(Case.from_toml(path, keys))[0]


@pytest.mark.parametrize("keys", [["remesh.every=0.1"], []])
def test_contact_of_bodies_survives_new_meshes(two_bodies, keys):
    """Force of the punch within 1.5 % of the run on one fine mesh, of the ring on the core within 2 % in the mean.

    Nodes that come to touch or part make single values of the latter jump by some per cent on any mesh.
    """
    keys = ["remesh.size=0.4", "remesh.bodies.ring.size=0.3", *keys]
    path, once = two_bodies
    often, recording = _run(Case.from_toml(path, keys))
    assert often["remeshes"][-1] >= 4
    for key in ("punch.force", "bore.force_x"):
        stroke = np.linspace(1.0, 5.0, 9)
        wanted, found = (np.interp(stroke, rows["punch.stroke"], rows[key]) for rows in (once, often))
        assert abs((found / wanted).mean() - 1) < 0.02
        assert np.abs(found / wanted - 1).max() < (0.015 if key == "punch.force" else 0.06)
    procedure = recording.procedure
    plastic = procedure.volume() - procedure.mechanics.elastic_dilatation(procedure.state) - procedure.initial_volume
    assert abs(plastic / procedure.initial_volume) < 1e-4
    assert abs(procedure.energy_balance()["error_percent"]) < 0.5
