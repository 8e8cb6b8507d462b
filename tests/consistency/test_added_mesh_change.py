# SPDX-License-Identifier: Apache-2.0
"""A mesh change of one's own, written here alone: once it takes up the mesh where its points are by then.

Of an implicit run tests/regression/test_epochs.py does the same by a function that is asked for the mesh.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from presswork import build_model, run_model
from presswork.case.stamping.schema import StampingCase
from presswork.explicit.arrays import MotionArrays, SolidArrays
from presswork.fields.instant import Instant
from presswork.model import Model
from presswork.observe.contract import History, Observed, Row
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.mesh_change.contract import MeshChange
from tests.consistency.test_added_observer import make_model
from tests.problems.hot_strip import bent_strip

AFTER = 2


class Rebased(MeshChange):
    """Takes up the deformed mesh after some intervals."""

    def __init__(self, run: ExplicitForming) -> None:
        self._run = run

    def look(self, failure: str = "") -> bool:
        run = self._run
        if run.number != AFTER or run.epoch:
            return False
        old, position, origin = run.solids.state_as_given(), run.positions(), run.mesh.points
        run.begin_epoch(replace(run.model.mesh, points=position), origin)
        run.make_run({"rebased": np.ones(1)})
        run.begin_stage()
        new = run.solids.state_as_given()
        new.take_over(old)
        for kind in (MotionArrays, SolidArrays):
            for field in fields(kind):
                if field.name != "displacement":
                    setattr(new[kind], field.name, getattr(old[kind], field.name))
        run.solids.take_state_as_given(new)
        run.notes.append("the deformed mesh is taken up")
        return True

    def columns(self, run: Observed) -> list[str]:
        return ["meshes"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        return {"meshes": run.epoch + 1}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        return {"meshes": run.epoch + 1}

    def arrays(self) -> Mapping[str, NDArray[Any]]:
        return {"rebased": np.ones(1)}


class Onlooker(MeshChange):
    """Changes nothing, and says so everywhere."""

    def __init__(self) -> None:
        self.looks = self.shown = 0

    def look(self, failure: str = "") -> bool:
        self.looks += 1
        return False

    def columns(self, run: Observed) -> list[str]:
        return ["looks"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        return {"looks": self.looks}

    def begin_log(self) -> str:
        return "; an onlooker"

    def show(self, run: Observed, now: Instant) -> None:
        self.shown += 1


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
@pytest.mark.parametrize("family", ["solid", "sheet"])
def test_every_procedure_asks_and_shows_it(family: str, procedure: str, tmp_path: Path) -> None:
    onlooker = Onlooker()
    if family == "solid":
        model = make_model(procedure)
    else:
        model = build_model(StampingCase.model_validate(bent_strip(("procedure", procedure))))

    def begin_beside(model: Model, threads: int) -> Any:
        run = begin(model, threads)
        run.add_mesh_change(onlooker)  # type: ignore[attr-defined]
        return run

    found = run_model(model, tmp_path / "out", procedure=begin_beside).result
    assert "; an onlooker" in (tmp_path / "out" / "run.log").read_text()
    assert found.history["looks"][-1] == onlooker.looks > 0
    assert onlooker.shown > 0


def begin_rebased(model: Model, threads: int) -> Any:
    run = begin(model, threads)
    assert isinstance(run, ExplicitForming)
    run.add_mesh_change(Rebased(run))
    return run


def test_it_changes_the_mesh_and_nothing_else(tmp_path: Path) -> None:
    """But for the mass: that of the volume, which is elastically smaller by then."""
    model = make_model("explicit")
    once = run_model(model, tmp_path / "once").result
    found = run_model(model, tmp_path / "found", procedure=begin_rebased).result
    assert found.history["meshes"].tolist() == [1, 1, 2, 2]
    assert found.summary["meshes"] == 2
    assert "the deformed mesh is taken up" in (tmp_path / "found" / "run.log").read_text()
    for name in ("effective_stress", "equivalent_plastic_strain", "displacement"):
        wanted = once.field(name)
        np.testing.assert_allclose(found.field(name), wanted, rtol=2e-5, atol=2e-5 * np.abs(wanted).max())


def test_a_run_resumed_on_its_mesh_gives_the_same_bits(tmp_path: Path) -> None:
    model = make_model("explicit")
    whole = run_model(model, tmp_path / "whole", procedure=begin_rebased).result

    def stop(now: Any) -> None:
        if now.fraction > 0.7:
            raise KeyboardInterrupt

    folder = tmp_path / "cut"
    assert run_model(model, folder, procedure=begin_rebased, on_increment=stop).status == "interrupted"
    assert run_model(model, folder, procedure=begin_rebased, resume=True).status == "completed"
    assert (folder / "history.csv").read_bytes() == (whole.folder / "history.csv").read_bytes()
