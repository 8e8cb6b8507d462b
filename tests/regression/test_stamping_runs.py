# SPDX-License-Identifier: Apache-2.0
"""A stamping from case file to results, pictures and checkpoint."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.explicit.shells import ExplicitShells
from presswork.recorder import run_model
from presswork.results import OutputError
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import assert_same_bits, stop_after, stop_within_a_row


def pull(**changes: Any) -> dict[str, Any]:
    """A strip pulled along x between two symmetry planes: a quarter of 20 x 8 mm, 0.8 mm thick."""
    return {
        "title": "strip in tension",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 2, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "stages": [{"name": "pull", "velocity": "0.5 m/s",
                    "displacement": [{"set": "right", "component": "x", "value": 1}]}],
        "output": {"rows": 20, "steps": 2, "checkpoint_every": 7},
        **changes,
    }  # fmt: skip


@pytest.fixture(scope="module")
def pulled(tmp_path_factory) -> Result:
    outcome = run_model(build_model(StampingCase.model_validate(pull())), tmp_path_factory.mktemp("pull") / "out")
    assert outcome.status == "completed"
    return outcome.result


def test_a_strip_in_tension_follows_its_flow_curve(pulled) -> None:
    """Uniaxial tension of von Mises: stress = K (e0 + p)^n, width and thickness strain -p/2."""
    strain = np.log(11 / 10)
    stress = pulled.field("stress_middle_xx")
    p = strain - stress.mean() / 206e3
    np.testing.assert_allclose(stress, 565.32 * (0.007117 + p) ** 0.2589, rtol=2e-3)
    np.testing.assert_allclose(pulled.field("eqps"), p, rtol=2e-3)
    np.testing.assert_allclose(pulled.field("thickness_strain"), -p / 2 - 0.3 * stress / 206e3, rtol=3e-3)
    np.testing.assert_allclose(pulled.field("major_strain_top"), strain, rtol=2e-3)
    np.testing.assert_allclose(pulled.field("minor_strain_top"), -p / 2 - 0.3 * stress / 206e3, rtol=3e-3)
    right = pulled.mesh.points[:, 0] > 9.99
    force = stress.mean() * 8 * 0.8 * np.exp(-strain) / 2  # of the half that is modelled
    assert pulled.field("reaction_force")[right, 0].sum() == pytest.approx(force, rel=5e-3)


@pytest.mark.parametrize(("angle", "r"), [(0.0, 1.0), (45.0, 2.5), (90.0, 1.0)])
@pytest.mark.parametrize("cells", ["quadrilaterals", "triangles"])
@pytest.mark.parametrize("procedure", ["explicit", "implicit"])
def test_every_kind_of_blank_narrows_by_the_r_value_of_its_rolling_direction(
    procedure, cells, angle, r, tmp_path: Path
) -> None:
    """Hill 1948 with r00 = r90, so that a strip at 45 degrees does not shear; plastic strains by Hooke's law."""
    case = pull(procedure=procedure)
    case["blank"] |= {"cells": cells, "rolling_direction": angle, "element_size": 4}
    case["materials"]["steel"]["yield_function"] = {"law": "hill1948", "r00": 1.0, "r45": 2.5, "r90": 1.0}
    case["stages"][0]["displacement"] += [{"set": "right", "component": "z", "value": 0}]
    case["implicit"] = {"initial_increment": 0.1, "max_increment": 0.1}
    result = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "out", threads=1).result
    assert {b.vtk_type for b in result.mesh.blocks} == {5 if cells == "triangles" else 9}
    elastic = -0.3 * result.field("effective_stress_middle") / 206e3
    width, thickness = (result.field(name) - elastic for name in ("minor_strain_middle", "thickness_strain"))
    if r < 1.5:
        np.testing.assert_allclose(width, thickness, rtol=0.01)
    else:
        width = result.field("strain_middle")[:, 1] - elastic
        np.testing.assert_allclose(width / thickness, r, rtol=0.01)


@pytest.mark.parametrize("cells", ["quadrilaterals", "triangles"])
def test_a_strip_blank_between_two_planes_is_a_slice_of_a_wide_one(cells, tmp_path: Path) -> None:
    """Plane strain of von Mises: no width strain; 2/sqrt(3) of the uniaxial stress, at p = 2/sqrt(3) of the strain."""
    case = pull(boundary={"slice": {"set": "top", "hold": "symmetry_y"}})
    case["blank"] |= {"size": [20, 4], "cells": cells}
    case["stages"][0]["velocity"] = "0.25 m/s"
    result = run_model(build_model(StampingCase.model_validate(case)), tmp_path / "out", threads=1).result
    np.testing.assert_allclose(result.field("strain_middle")[:, 1], 0.0, atol=2**-24)
    stress, strain = result.field("stress_middle_xx"), np.log(11 / 10)
    p = 2 / np.sqrt(3) * (strain - (1 - 0.25) * stress / 206e3)  # elastic: sigma_yy is half of sigma_xx
    np.testing.assert_allclose(stress, 2 / np.sqrt(3) * 565.32 * (0.007117 + p) ** 0.2589, rtol=3e-3)


def test_motion_ends_where_the_case_says_and_the_energies_balance(pulled) -> None:
    """Within what the rounding of velocities can add up to: they are kept in single precision."""
    right = pulled.mesh.points[:, 0] > 9.99
    np.testing.assert_allclose(pulled.field("displacement")[right, 0], 1.0, rtol=0, atol=2**-24)
    history = pulled.history
    assert len(history["time"]) == 20
    assert history["cycles"][-1] == pulled.summary["cycles"]
    assert np.abs(history["energy_error_percent"]).max() < 0.1
    assert history["kinetic_energy"][-1] < 1e-3 * history["internal_energy"][-1]
    assert pulled.summary["warnings"] == []
    assert pulled.times == pytest.approx([0.0, history["time"][9], history["time"][19]])


def test_the_element_of_the_case_is_the_one_that_is_computed(pulled, tmp_path) -> None:
    """Fully integrated shells in homogeneous tension: the same fields, means over their points; no hourglass energy."""
    model = build_model(StampingCase.model_validate(pull(explicit={"element": "shell4_mitc_plus"})))
    run = run_model(model, tmp_path / "out").result
    assert model.mesh.blocks[0].element == "shell4_mitc_plus"
    for name in ("eqps", "thickness_strain", "stress_middle_xx", "major_strain_top"):
        np.testing.assert_allclose(run.field(name), pulled.field(name), rtol=2e-3, err_msg=name)
    assert pulled.history["hourglass_energy"][-1] > 0.0
    assert run.history["hourglass_energy"].max() == 0.0


def test_pictures_are_drawn(pulled, tmp_path) -> None:
    names = [p.name for p in plot_all(pulled, tmp_path)]
    assert "energies.png" in names
    assert "shell_thickness_strain_002.png" in names


def test_a_resumed_run_and_one_with_two_threads_give_the_same_bits(pulled, tmp_path: Path) -> None:
    model = build_model(StampingCase.model_validate(pull()))
    run_model(model, tmp_path / "two", threads=2)
    assert run_model(model, tmp_path / "part", threads=1, on_increment=stop_after(10)).status == "interrupted"
    other_rows = replace(model, output=replace(model.output, rows=model.output.rows + 10))
    with pytest.raises(OutputError, match=r"a run with output.rows = \d+, on which its steps depend; use --overwrite"):
        run_model(other_rows, tmp_path / "part", resume=True)
    assert run_model(model, tmp_path / "part", threads=1, resume=True).status == "completed"
    for other in ("two", "part"):
        assert_same_bits(tmp_path / other, pulled.folder)


def test_ctrl_c_within_a_row_goes_back_to_its_beginning(pulled, tmp_path, monkeypatch) -> None:
    model = build_model(StampingCase.model_validate(pull()))
    outcome = stop_within_a_row(model, tmp_path / "out", monkeypatch, ExplicitShells, 58)
    assert outcome.status == "interrupted"
    assert 0 < len(outcome.result.history["time"]) < 20
    assert run_model(model, tmp_path / "out", threads=1, resume=True).status == "completed"
    assert (tmp_path / "out" / "history.csv").read_bytes() == (pulled.folder / "history.csv").read_bytes()


def test_mass_added_for_a_longer_step_is_told_and_warned_of(pulled, tmp_path) -> None:
    """Thirty times the step needs 900 times the mass; kinetic energy then is out of hand, and said so."""
    step = 30 * pulled.history["time_step"][0]
    case = StampingCase.model_validate(pull(explicit={"target_step": step}))
    result = run_model(build_model(case), tmp_path / "out").result
    history = result.history
    assert history["cycles"][-1] < 0.04 * pulled.history["cycles"][-1]
    assert history["added_mass_percent"][0] > 85_000
    assert (np.diff(history["added_mass_percent"]) >= 0).all()
    assert np.abs(history["energy_error_percent"]).max() < 0.5
    assert "kinetic energy reached" in result.summary["warnings"][0]


def test_a_step_beyond_stability_ends_with_a_reason_and_the_last_good_state(tmp_path) -> None:
    """Without the safety of the step the run breaks down: told, and the checkpoint is finite."""
    case = StampingCase.model_validate(pull())
    model = build_model(case)
    wild = replace(model, explicit=replace(model.explicit, safety=3.0))
    outcome = run_model(wild, tmp_path / "out")
    assert outcome.status == "gave_up"
    assert "no finite position" in outcome.reason
    assert np.isfinite(outcome.result.field("displacement")).all()


@pytest.mark.parametrize(("explicit", "column"), [
    ({"precision": "double"}, "internal_energy"),
    ({"damping": 2e3}, "damping_energy"),
    ({"safety": 0.5}, "time_step"),
    ({"step_bound": "mesh"}, "time_step"),
])  # fmt: skip
def test_every_setting_of_the_explicit_procedure_changes_the_run_and_not_the_answer(
    pulled, tmp_path, explicit, column
) -> None:
    changed = run_model(build_model(StampingCase.model_validate(pull(explicit=explicit))), tmp_path / "out").result
    assert (changed.history[column] != pulled.history[column]).any()
    np.testing.assert_allclose(changed.field("thickness_strain"), pulled.field("thickness_strain"), rtol=5e-3)
