# SPDX-License-Identifier: Apache-2.0
"""Whole runs: the same bits however they are run, stopped, killed and resumed; nothing lost; honest exit status."""

import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from presswork import Case, OutputError, Result, run
from presswork.examples import copy_example
from presswork.implicit.progress import IncrementReport
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.run import Row
from presswork.results import load_checkpoint
from tests.regression.whole_runs import assert_same_bits, stop_after

SMALL = ["workpiece.mesh.cells=[6,6]", "output.checkpoint_every=3"]


def presswork(*arguments: str, **kwargs) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from presswork.cli import app; app()", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, **kwargs)


@pytest.fixture(scope="module")
def case_file(tmp_path_factory) -> Path:
    return copy_example("upsetting_4cst", tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def small_case(case_file) -> Case:
    return Case.from_toml(case_file, overrides=SMALL)


@pytest.fixture(scope="module")
def reference(small_case, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "reference"
    assert run(small_case, folder, threads=1).status == "completed"
    return folder


def test_one_thread_gives_the_same_bits_as_two(small_case, reference, tmp_path) -> None:
    run(small_case, tmp_path / "two", threads=2)
    assert_same_bits(tmp_path / "two", reference)


def test_interrupted_run_resumes_to_the_same_bits(small_case, reference, tmp_path) -> None:
    outcome = run(small_case, tmp_path / "out", on_increment=stop_after(7))
    assert outcome.status == "interrupted"
    assert "--resume" in outcome.reason
    assert 0 < outcome.result.summary["fraction_computed"] < 1
    for reports in (5, 1, 11):
        assert run(small_case, tmp_path / "out", resume=True, on_increment=stop_after(reports)).status == "interrupted"
    assert run(small_case, tmp_path / "out", resume=True).status == "completed"
    assert_same_bits(tmp_path / "out", reference)


def test_ctrl_c_between_an_increment_and_its_row_resumes_to_the_same_bits(
    small_case, reference, tmp_path, monkeypatch
) -> None:
    """The history lacks the row then: the checkpoint before it stands."""
    row, calls = ImplicitForming.row, iter(range(1, 100))

    def interrupted(self: ImplicitForming, report: IncrementReport) -> Row:
        if next(calls) == 8:
            raise KeyboardInterrupt
        return row(self, report)

    with monkeypatch.context() as patch:
        patch.setattr(ImplicitForming, "row", interrupted)
        outcome = run(small_case, tmp_path / "out", threads=1)
    assert outcome.status == "interrupted"
    assert len(outcome.result.history["time"]) == 7
    assert run(small_case, tmp_path / "out", resume=True, threads=1).status == "completed"
    assert_same_bits(tmp_path / "out", reference)


def test_killed_runs_resume_to_the_same_bits(case_file, reference, tmp_path) -> None:
    """kill -9 at random instants, those of a checkpoint being written among them (one after every increment)."""
    command = [sys.executable, "-c", "from presswork.cli import app; app()", "run", str(case_file), "--quiet"]
    command += ["--no-plot", "--output", str(tmp_path / "out"), "--set", SMALL[0], "--set", "output.checkpoint_every=1"]
    rng = random.Random(1)
    kills = 0
    while kills < 4:
        resume = ["--resume"] if (tmp_path / "out" / "checkpoint.h5").exists() else ["--overwrite"]
        process = subprocess.Popen(command + resume, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        started = time.monotonic()
        before = (tmp_path / "out" / "history.csv").stat().st_size if kills else 0
        while process.poll() is None and time.monotonic() - started < 60:  # until an increment or so has been computed
            history = tmp_path / "out" / "history.csv"
            if history.exists() and history.stat().st_size > before + 400:
                break
            time.sleep(0.002)
        time.sleep(rng.uniform(0, 0.03))
        if process.poll() is not None:
            assert process.returncode == 0, process.communicate()[1]
            break
        process.kill()
        process.communicate()
        kills += 1
    assert kills > 0
    last = subprocess.run([*command, "--resume"], capture_output=True, text=True, check=False)
    assert last.returncode == 0, last.stderr
    found, wanted = Result(tmp_path / "out"), Result(reference)
    assert (tmp_path / "out" / "history.csv").read_bytes() == (reference / "history.csv").read_bytes()
    np.testing.assert_array_equal(found.field("eqps"), wanted.field("eqps"))
    assert len(found.times) == len(wanted.times)


def test_a_signal_leaves_a_checkpoint_and_says_so(case_file, tmp_path) -> None:
    command = [sys.executable, "-c", "from presswork.cli import app; app()", "run", str(case_file), "--no-plot"]
    command += ["--output", str(tmp_path / "out"), "--set", "workpiece.mesh.cells=[40,40]"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not (tmp_path / "out" / "checkpoint.h5").exists():
        time.sleep(0.01)
    time.sleep(0.3)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate()
    assert process.returncode == 130, errors
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["status"] == "interrupted"
    assert Result(tmp_path / "out").field("eqps").size > 0


def test_a_full_disk_loses_nothing(case_file, tmp_path) -> None:
    """The operating system refuses to let files grow: the run stops with status 2, what was written stays readable."""

    def limit_files() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (900_000, 900_000))

    out = tmp_path / "out"
    done = presswork("run", str(case_file), "--no-plot", "--output", str(out), preexec_fn=limit_files)
    assert done.returncode == 2
    assert "disk" in done.stderr
    assert Result(out).field("eqps", 0).size > 0
    assert load_checkpoint(out / "checkpoint.h5")[1]["increments"] >= 0
    again = presswork("run", str(case_file), "--no-plot", "--output", str(out), "--resume")
    assert again.returncode == 0, again.stderr


def test_a_solver_that_gives_up_says_why_and_keeps_what_it_has(case_file, tmp_path) -> None:
    settings = ["--set", "solver.max_iterations=2", "--set", "solver.min_increment=0.002"]
    done = presswork("run", str(case_file), "--no-plot", "--output", str(tmp_path / "out"), *settings)
    assert done.returncode == 3
    assert "finds no equilibrium" in done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "gave_up"
    assert "cut back" in (tmp_path / "out" / "run.log").read_text()
    assert len(Result(tmp_path / "out").times) >= 1


def test_a_folder_with_results_is_refused(small_case, reference) -> None:
    before = (reference / "history.csv").read_bytes()
    with pytest.raises(OutputError, match="--overwrite"):
        run(small_case, reference)
    assert (reference / "history.csv").read_bytes() == before


def test_another_case_cannot_resume(case_file, reference) -> None:
    other = Case.from_toml(case_file, overrides=[*SMALL, "materials.steel.young=210000"])
    with pytest.raises(OutputError, match="another case"):
        run(other, reference, resume=True)


def test_bad_input_computes_nothing(case_file, tmp_path) -> None:
    done = presswork("run", str(case_file), "--output", str(tmp_path / "out"), "--set", "materials.steel.poisson=0.5")
    assert done.returncode == 2
    assert "materials.steel.poisson" in done.stderr
    assert not (tmp_path / "out").exists()


def test_force_from_python_is_the_force_in_the_file(reference) -> None:
    result = Result(reference)
    history = np.genfromtxt(reference / "history.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    np.testing.assert_array_equal(result.history["punch.force"], history["punchforce"])
    assert (result.history["punch.force"] > 0).all()
    assert result.history["punch.stroke"][-1] == 9.0


@pytest.mark.parametrize("command", [["--help"], ["run", "--help"], ["check"], ["schema"], ["examples"], ["--version"]])
def test_every_command_answers(command, case_file) -> None:
    done = presswork(*command, *([str(case_file)] if command == ["check"] else []))
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_run_draws_pictures(case_file, tmp_path) -> None:
    done = presswork("run", str(case_file), "--output", str(tmp_path / "out"), "--set", SMALL[0])
    assert done.returncode == 0, done.stderr
    pictures = list((tmp_path / "out" / "plots").glob("*.png"))
    assert len(pictures) >= 4
    assert all(os.path.getsize(p) > 5000 for p in pictures)


def test_a_tool_that_never_touched_is_named_at_the_end(case_file, tmp_path) -> None:
    far = 'tools.gauge={profile=[[0,40],[30,40]],contact="frictionless"}'
    settings = [part for setting in [*SMALL, far, "stages.0.tools.punch.stroke=1"] for part in ("--set", setting)]
    done = presswork("run", str(case_file), *settings, "--output", str(tmp_path / "out"), "--no-plot")
    assert done.returncode == 0, done.stderr
    assert "the tool gauge never touched the workpiece" in " ".join((done.stdout + done.stderr).split())
    assert Result(tmp_path / "out").summary["contact"]["tools_never_touched"] == ["gauge"]
