# SPDX-License-Identifier: Apache-2.0
"""Memory: what a problem takes is held against what the machine has, before anything is computed."""

from __future__ import annotations

import functools
import resource
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from presswork import memory
from presswork.case import Case, CaseError, ShellCase, build_model
from presswork.case.stamping.schema import StampingCase
from presswork.cli import app
from presswork.implicit.linear import direct
from presswork.memory import available_memory, estimate_memory
from presswork.model import FloatArray
from presswork.outcome import StartError
from presswork.process.begin import check_start
from presswork.recorder import run_model
from tests.unit.case.round_cup import CUP
from tests.unit.case.test_magnitudes import IMPACT, SHELL, SOLID, STEEL

CASES = {
    "solid": lambda: Case(**SOLID, materials={"steel": STEEL}),
    "explicit solid": lambda: Case(**IMPACT, materials={"steel": {**STEEL, "density": 7.85e-9}}),
    "shell": lambda: ShellCase(**SHELL, materials={"steel": STEEL}),
    "explicit stamping": lambda: StampingCase(**CUP),
    "implicit stamping": lambda: StampingCase(**CUP, procedure="implicit"),
}


@pytest.mark.parametrize("kind", CASES)
def test_more_memory_than_there_is_is_refused_before_anything_is_computed(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = build_model(CASES[kind]())
    monkeypatch.setattr(memory, "available_memory", lambda: 0.5 * estimate_memory(problem))
    with pytest.raises(StartError, match=r"of memory are needed, and .* are free.*fewer or larger elements"):
        check_start(problem)
    with pytest.raises(StartError, match="of memory are needed"):
        run_model(problem, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_rectangle_too_large_for_the_machine_is_refused_before_it_is_meshed(tmp_path: Path) -> None:
    billet = SOLID | {"materials": {"steel": STEEL}}
    billet["workpiece"] = {**billet["workpiece"], "mesh": {"size": [10, 15], "cells": [100_000, 200]}}  # type: ignore[dict-item]
    strip = SHELL | {"materials": {"steel": STEEL}}
    strip["workpiece"] = {**strip["workpiece"], "mesh": {"size": [10, 15], "cells": [100_000, 1000]}}  # type: ignore[dict-item]
    for case in (Case(**billet), ShellCase(**strip)):
        with pytest.raises(CaseError, match=r"workpiece\.mesh\.cells = .*MB of memory are needed, and"):
            build_model(case)


def test_check_says_how_much_memory_is_needed_and_free(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["examples", "upsetting_4cst", "--to", str(tmp_path)])
    result = CliRunner().invoke(app, ["check", str(tmp_path / "upsetting_4cst.toml")])
    assert "MB (an estimate) of" in result.output
    assert "MB that are free on this machine" in result.output


def test_limits_of_the_process_and_of_its_group_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    free = available_memory()
    (tmp_path / "memory.max").write_text("3000\n")
    (tmp_path / "memory.current").write_text("1000\n")
    assert memory._free_of_group(tmp_path) == 2000
    (tmp_path / "memory.max").write_text("max\n")
    assert memory._free_of_group(tmp_path) == float("inf")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (memory._pages_taken(memory._ADDRESS_SPACE) + 5e6, -1))
    assert available_memory() == pytest.approx(5e6, rel=0.2)
    assert free > 5e6


def test_memory_that_ends_on_the_way_is_said_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not called a failure to find equilibrium, whose remedy, a finer mesh, would make it worse."""
    calls = []

    def fail(whole: Callable[..., None], self: object, data: FloatArray, *modes: object) -> None:
        calls.append(len(data))
        if len(calls) > 5:
            raise direct._explain(-2)
        whole(self, data)

    for solver in (direct.Pardiso, direct.SuperLU):
        monkeypatch.setattr(solver, "factorise", functools.partialmethod(functools.partial(fail, solver.factorise)))
    outcome = run_model(build_model(CASES["solid"]()), tmp_path / "out")
    assert outcome.status == "gave_up"
    assert "not enough memory" in outcome.reason
    assert "finer" not in outcome.reason
    assert (tmp_path / "out" / "checkpoint.h5").is_file()
