# SPDX-License-Identifier: Apache-2.0
"""The table [gradients]: what it refuses, and that a resumed run goes on with the same bits."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model
from presswork.case.errors import CaseError
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model
from presswork.outcome import StartError
from presswork.process.begin import begin
from presswork.process.derivatives import released
from presswork.process.implicit import folding
from presswork.process.implicit.self_contact import touches_itself
from presswork.process.line.springback import ReleasedStamping
from presswork.recorder import run_model
from tests.problems.differentiated import (
    bend_over_die,
    bend_twice,
    run_case,
    stamp_hot,
    upset_cylinder,
    upset_hot,
    upset_in_press,
    upset_two_bodies,
)
from tests.problems.mapped_meshes import upset_block_with_new_meshes, upset_with_new_meshes
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

HOT_ROWS = {"conductivity": [[20, 30], [1000, 25]], "specific_heat": "600 J/(kg*K)"}
LOOSE = {"initial_increment": 0.25, "max_increment": 0.25}


def refuse(gradients: dict[str, Any], **changes: Any) -> str:
    with pytest.raises(CaseError) as error:
        build_model(Case.model_validate(upset_cylinder(solver=LOOSE, gradients=gradients, **changes)))
    return str(error.value)


def test_key_that_the_case_does_not_have_is_refused_with_the_nearest() -> None:
    text = refuse({"by": ["tools.punsh.m"]})
    assert "gradients.by.0" in text
    assert "did you mean `punch`" in text


def test_key_without_a_number_is_refused() -> None:
    assert "is not a number" in refuse({"by": ["tools.punch.contact"]})


def test_quantity_by_temperature_that_the_case_gives_as_a_number_is_one() -> None:
    key = "materials.steel.thermal.conductivity"
    gradients = build_model(Case.model_validate(upset_hot(gradients={"by": [key]}))).gradients
    assert gradients is not None
    less, more = gradients.by[0].less, gradients.by[0].more
    assert less is not None
    given = [side.materials[0].thermal for side in (less, more)]
    assert [t.conductivity.tolist() for t in given if t] == [[[0.0, 29.97]], [[0.0, pytest.approx(30.03)]]]
    rows = upset_hot(gradients={"by": [key]})
    rows["materials"] = {"steel": {**rows["materials"]["steel"], "thermal": {**HOT_ROWS}}}
    with pytest.raises(CaseError, match="is not a number"):
        build_model(Case.model_validate(rows))
    build_model(Case.model_validate({**rows, "gradients": {"by": [f"{key}.1.1"]}}))


def test_number_without_room_on_both_sides_is_refused() -> None:
    tools = {"punch": {"profile": [[0, 15], [30, 15]], "contact": "shear", "m": 1.0}}
    assert "cannot be a little less and more" in refuse({"by": ["tools.punch.m"]}, tools=tools)


def test_zero_is_refused() -> None:
    assert "is zero" in refuse({"by": ["workpiece.mesh.origin.0"]})


def test_number_that_changes_cells_is_refused() -> None:
    assert "cannot be a little less and more" in refuse({"by": ["workpiece.mesh.cells.0"]})


def test_explicit_run_is_refused() -> None:
    data = upset_cylinder(gradients={"by": ["tools.punch.m"]}, procedure="explicit")
    data.pop("solver")
    data["materials"]["steel"]["density"] = 7.85e-9
    data["tools"]["punch"] = {"profile": [[0, 15], [30, 15]], "contact": "coulomb", "mu": 0.1}
    data["workpiece"]["element"] = "quad4_1pt"
    data["stages"][0]["duration"] = 1e-4
    with pytest.raises(CaseError, match="derivatives of dynamics are not available"):
        build_model(Case.model_validate({**data, "gradients": {"by": ["tools.punch.mu"]}}))


def test_column_that_the_history_does_not_have_is_refused_before_the_run() -> None:
    model = build_model(Case.model_validate(upset_cylinder(gradients={"of": ["punch.forse"], "by": ["tools.punch.m"]})))
    with pytest.raises(StartError, match=r"did you mean `punch\.force`"):
        begin(model, threads=1)


@pytest.mark.parametrize("upset", [upset_cylinder, upset_hot], ids=["cold", "hot"])
def test_resumed_run_has_the_same_derivatives_to_the_bit(upset: Callable[..., dict[str, Any]], tmp_path: Path) -> None:
    data = upset(solver=LOOSE, gradients={"by": ["tools.punch.m"]})
    data["output"] = {"steps": 1, "checkpoint_every": 1}
    whole = run_case(Case, data, tmp_path / "whole").history
    model = build_model(Case.model_validate(data))

    def stop(progress: Any) -> None:
        if progress.fraction > 0.4:
            raise KeyboardInterrupt

    with contextlib.suppress(KeyboardInterrupt):
        run_model(model, tmp_path / "cut", on_increment=stop)
    resumed = run_model(model, tmp_path / "cut", resume=True).result.history
    name = "d(punch.force)/d(tools.punch.m)"
    assert np.array_equal(whole[name], resumed[name])


@pytest.mark.parametrize("folds", [False, True])
def test_run_resumed_between_new_meshes_has_the_same_derivatives_to_the_bit(folds: bool, tmp_path: Path) -> None:
    """Where a body folds onto itself derivatives end; the run goes on."""
    data = upset_with_new_meshes(stroke=2.0, increment=0.2)
    data |= {"solver": {**data["solver"], "force_tolerance": 1e-6}, "output": {"steps": 1, "checkpoint_every": 1}}
    data["gradients"] = {"by": ["tools.punch.m"], "of": ["punch.force", "rim.x"]}
    model = build_model(Case.model_validate(data))
    with pytest.MonkeyPatch.context() as patch:
        if folds:
            patch.setattr(folding, "find_folding", fold_in_increment_two)
        whole = run_model(model, tmp_path / "whole").result
        run_in_two_parts(model, tmp_path / "cut", 3)
    found = np.asarray(whole.history["d(rim.x)/d(tools.punch.m)"])
    assert whole.history["remeshes"][-1] == 3
    assert np.isfinite(found).tolist() == [not folds or i < 2 for i in range(len(found))]
    assert any("tools.punch.m was not found in increment 3" in w for w in whole.summary["warnings"]) == folds
    assert_same_bits(tmp_path / "cut", whole.folder)


def fold_in_increment_two(procedure: ImplicitProcedure, bodies: Any) -> dict[int, str]:
    """Say that the body is about to fold, once."""
    is_new = procedure.state[Progress].increments == 2 and not touches_itself(procedure.model, 0)
    return {0: "the body folds"} if is_new else {}


def test_run_resumed_between_new_meshes_in_space_has_the_same_derivatives_to_the_bit(tmp_path: Path) -> None:
    data = upset_block_with_new_meshes()
    asked = {"gradients": {"of": ["rim.x"], "by": ["tools.punch.mu"]}, "output": {"steps": 1, "checkpoint_every": 7}}
    model = build_model(SpaceCase.model_validate(data | asked))
    whole = run_model(model, tmp_path / "whole").result
    run_in_two_parts(model, tmp_path / "cut", 7)
    assert whole.history["remeshes"][[6, -1]].tolist() == [1, 2]
    assert_same_bits(tmp_path / "cut", whole.folder)


def test_derivatives_end_where_a_body_in_space_folds_on_its_first_mesh(tmp_path: Path) -> None:
    """Its run goes on with contact with itself, as it does without derivatives, and resumes to the same bits."""
    data = upset_block_with_new_meshes(stroke=0.6)
    del data["remesh"]
    data |= {"solver": {**data["solver"], "force_tolerance": 1e-6}, "output": {"steps": 1, "checkpoint_every": 1}}
    data["gradients"] = {"of": ["rim.x"], "by": ["tools.punch.mu"]}
    model = build_model(SpaceCase.model_validate(data))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(folding, "find_folding", fold_in_increment_two)
        whole = run_model(model, tmp_path / "whole").result
        run_in_two_parts(model, tmp_path / "cut", 3)
    found = np.asarray(whole.history["d(rim.x)/d(tools.punch.mu)"])
    assert np.isfinite(found).tolist() == [i < 2 for i in range(len(found))]
    assert len(found) > 3
    assert_same_bits(tmp_path / "cut", whole.folder)


def test_neighbours_have_the_slaves_of_the_run() -> None:
    """Of two bodies that are as fine the softer one is the slave: here a number of its own decides."""
    data = upset_two_bodies({"contact": "frictionless"})
    data["bodies"]["upper"]["mesh"] = {**data["bodies"]["upper"]["mesh"], "size": [10, 8], "cells": [5, 4]}
    data["tools"]["punch"] = {"profile": [[0, 16], [30, 16]], "contact": "shear", "m": 0.2}
    data["materials"]["soft"] = data["materials"]["steel"]
    model = build_model(Case.model_validate(data | {"gradients": {"by": ["materials.soft.young"]}}))
    assert model.gradients is not None
    (asked,) = model.gradients.by
    slaves = [side.contacts[0].slave for side in (model, asked.less or model, asked.more)]
    assert slaves == [0, 0, 0]


def test_blows_on_metal_that_feels_the_strain_rate_are_refused() -> None:
    """The ram's speed says nothing where it comes to rest."""
    data = upset_in_press({"kind": "hammer", "energy": 1.0, "velocity": 6e3, "efficiency": 0.8})
    with pytest.raises(
        CaseError, match="derivatives of blows with heat, inertia, a strain rate or a UMAT are not available"
    ):
        build_model(Case.model_validate({**data, "gradients": {"by": ["tools.punch.m"]}}))


def test_derivative_ends_where_neighbours_are_cut_into_other_cells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = bend_over_die(trim={"end": {"shape": "rectangle", "size": [36, 6]}}, points={})
    data["implicit"] = {"initial_increment": 0.1, "max_increment": 0.1, "force_tolerance": 1e-9}
    data["stages"][0]["tools"]["punch"]["stroke"] = 1.0
    data["gradients"] = {"by": ["tools.die.mu", "blank.thickness"], "of": ["elastic_energy"]}
    release_like = released.release_like

    def release_lamed(side: ReleasedStamping, like: Model) -> bool:
        return release_like(side, like) and side.model.tools[1].friction.mu == 0.1

    monkeypatch.setattr(released, "release_like", release_lamed)
    found = run_case(StampingCase, data, tmp_path / "out")
    by_mu, by_thickness = (found.history[f"d(elastic_energy)/d({key})"] for key in data["gradients"]["by"])
    assert np.isfinite(by_thickness).all()
    first = list(found.history["stage"]).index("trim")
    assert np.isfinite(by_mu).tolist() == [i < first for i in range(len(by_mu))]
    assert any("derivative by tools.die.mu was not found" in warning for warning in found.summary["warnings"])


@pytest.mark.validation
def test_hot_stamping_resumed_in_a_dwell_has_the_same_derivatives_to_the_bit(tmp_path: Path) -> None:
    data = stamp_hot()
    data["implicit"] = {"initial_increment": 0.25, "max_increment": 0.5, "force_tolerance": 1e-9}
    data["stages"][1]["tools"]["punch"]["stroke"] = 1.0
    data["output"] = {"steps": 1, "checkpoint_every": 1}
    data["gradients"] = {"by": ["tools.die.heat.conductance"], "of": ["temperature_mean", "tip.z"]}
    model = build_model(StampingCase.model_validate(data))
    whole = run_model(model, tmp_path / "whole").result
    assert np.isfinite(whole.history["d(tip.z)/d(tools.die.heat.conductance)"]).all()
    run_in_two_parts(model, tmp_path / "cut", list(whole.history["stage"]).index("quench") + 1)
    assert_same_bits(tmp_path / "cut", whole.folder)


@pytest.mark.validation
@pytest.mark.parametrize("stage", ["bend_springback", "again_springback"])
def test_line_resumed_in_springback_has_the_same_derivatives_to_the_bit(stage: str, tmp_path: Path) -> None:
    data = bend_twice()
    data["implicit"] = {"initial_increment": 0.25, "max_increment": 0.25, "force_tolerance": 1e-9}
    data["operations"][0]["stages"][0]["tools"]["punch"]["stroke"] = 0.5
    data["operations"][1]["stages"][0]["tools"]["punch"]["stroke"] = 0.3
    data["output"] = {"steps": 1, "checkpoint_every": 1}
    data["gradients"] = {"by": ["materials.steel.hardening.K"], "of": ["again_punch.force", "external_work"]}
    model = build_model(StampingCase.model_validate(data))
    whole = run_model(model, tmp_path / "whole").result
    assert np.isfinite(whole.history["d(external_work)/d(materials.steel.hardening.K)"]).all()
    run_in_two_parts(model, tmp_path / "cut", list(whole.history["stage"]).index(stage) + 1)
    assert_same_bits(tmp_path / "cut", whole.folder)


@pytest.mark.parametrize("before_the_end", [pytest.param(3, marks=pytest.mark.validation), 1])
def test_stamping_resumed_before_and_within_springback_has_the_same_derivatives_to_the_bit(
    before_the_end: int, tmp_path: Path
) -> None:
    data = bend_over_die(gradients={"by": ["tools.die.mu"], "of": ["tip.z", "external_work"]})
    data["implicit"] = {"initial_increment": 0.1, "max_increment": 0.1, "force_tolerance": 1e-9}
    data["stages"][0]["tools"]["punch"]["stroke"] = 1.0
    data["output"] = {"steps": 1, "checkpoint_every": 1}
    model = build_model(StampingCase.model_validate(data))
    whole = run_model(model, tmp_path / "whole").result
    assert whole.history["stage"][-2] == "springback"
    assert np.isfinite(whole.history["d(tip.z)/d(tools.die.mu)"]).all()
    run_in_two_parts(model, tmp_path / "cut", len(whole.history["time"]) - before_the_end)
    assert_same_bits(tmp_path / "cut", whole.folder)
