# SPDX-License-Identifier: Apache-2.0
"""Sweeps and calibration from the command line: tables, failing members, Ctrl-C and --resume, exit status."""

import csv
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.study import measure_ring, run_sweep

SMALL = ["workpiece.mesh.cells=[4,2]", "stages.0.tools.punch.stroke=0.6", "output.steps=4"]
COMMAND = [sys.executable, "-c", "from presswork.cli import app; app()"]


def presswork(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, arguments)], capture_output=True, text=True, check=False)


def sets(settings: list[str]) -> list[str]:
    return [part for setting in settings for part in ("--set", setting)]


def read_table(folder: Path) -> list[dict[str, str]]:
    with open(folder / "table.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def case_file(tmp_path_factory) -> Path:
    return copy_example("ring_compression", tmp_path_factory.mktemp("case"))


def test_sweep_leaves_a_table_a_picture_and_the_bits_of_single_runs(case_file, tmp_path):
    out = tmp_path / "out"
    vary = ["--vary", "tools.punch.m=0.1:0.3:2", "--vary", "workpiece.mesh.cells.1=1,2"]
    done = presswork("sweep", case_file, *vary, *sets(SMALL), "--output", out)
    assert done.returncode == 0, done.stderr
    assert "4 of 4 completed" in done.stderr
    rows = read_table(out)
    assert [(r["member"], float(r["tools.punch.m"]), int(r["workpiece.mesh.cells.1"])) for r in rows] == [
        ("member_000", 0.1, 1),
        ("member_001", 0.1, 2),
        ("member_002", 0.3, 1),
        ("member_003", 0.3, 2),
    ]
    single = run(Case.from_toml(case_file, [*SMALL, "tools.punch.m=0.3"]), tmp_path / "single", threads=1)
    assert (out / "member_003/history.csv").read_bytes() == (tmp_path / "single/history.csv").read_bytes()
    last, summary = rows[3], single.result.summary
    assert last["status"] == "completed"
    assert int(last["increments"]) == summary["increments"]
    assert int(last["iterations"]) == summary["iterations"]
    assert float(last["punch.stroke"]) == single.result.history["punch.stroke"][-1]
    assert float(last["punch.force"]) == single.result.history["punch.force"][-1]
    assert float(last["max_equivalent_plastic_strain"]) == summary["extremes"]["equivalent_plastic_strain"][1]
    assert (out / "force_stroke.png").read_bytes().startswith(b"\x89PNG")
    again = presswork("sweep", case_file, *vary, *sets(SMALL), "--output", out, "--quiet")
    assert again.returncode == 2
    assert "--overwrite" in again.stderr
    other = presswork(
        "sweep", case_file, *vary, *sets(SMALL), "--set", "materials.steel.young=1e5", "--output", out, "--resume"
    )
    assert other.returncode == 2
    assert "another case" in other.stderr
    fewer = presswork("sweep", case_file, *vary[:2], *sets(SMALL), "--output", out, "--overwrite", "--quiet")
    assert (fewer.returncode, fewer.stderr) == (0, "")
    assert sorted(path.name for path in out.glob("member_*")) == ["member_000", "member_001"]


def test_sweep_survives_members_that_give_up_or_are_bad_input(case_file, tmp_path):
    result = run_sweep(
        case_file,
        {"solver.force_tolerance": [1e-4, 1e-30, -1.0]},
        tmp_path / "out",
        settings=[*SMALL, "solver.max_iterations=5", "solver.min_increment=1e-3"],
        jobs=1,
    )
    assert [member.status for member in result.members] == ["completed", "gave_up", "bad_input"]
    rows = read_table(tmp_path / "out")
    assert "no equilibrium" in rows[1]["reason"]
    assert "solver.force_tolerance" in rows[2]["reason"]
    assert not (tmp_path / "out/member_002").exists()


@pytest.mark.validation
@pytest.mark.parametrize(("vary", "status"), [("tools.punch.m=0.2,2", 2), ("solver.force_tolerance=1e-4,1e-30", 3)])
def test_exit_status_tells_the_worst_that_befell_a_member(case_file, tmp_path, vary, status):
    settings = [*SMALL, "solver.max_iterations=5", "solver.min_increment=1e-3"]
    done = presswork("sweep", case_file, "--vary", vary, *sets(settings), "--output", tmp_path / "out", "--quiet")
    assert done.returncode == status
    assert "member_001" in done.stderr
    assert read_table(tmp_path / "out")[0]["status"] == "completed"


@pytest.mark.validation
def test_ctrl_c_stops_a_sweep_and_resume_goes_on_to_the_same_bits(case_file, tmp_path):
    settings = ["output.checkpoint_every=3", "stages.0.tools.punch.stroke=1.5"]
    arguments = ["sweep", case_file, "--vary", "tools.punch.m=0.1,0.2,0.3", *sets(settings), "--jobs", 1]
    whole = presswork(*arguments, "--output", tmp_path / "whole", "--quiet")
    assert whole.returncode == 0
    out = tmp_path / "out"
    process = subprocess.Popen(
        [*COMMAND, *map(str, arguments), "--output", str(out)], stderr=subprocess.PIPE, text=True
    )
    history = out / "member_001/history.csv"
    deadline = time.monotonic() + 120
    while not (history.exists() and history.read_bytes().count(b"\n") > 5):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "--resume" in errors
    assert [row["status"] for row in read_table(out)] == ["completed", "interrupted", "waiting"]
    untouched = (out / "member_000/summary.json").stat().st_mtime_ns
    resumed = presswork(*arguments, "--output", out, "--resume")
    assert resumed.returncode == 0, resumed.stderr
    assert (out / "member_000/summary.json").stat().st_mtime_ns == untouched
    assert "resumed after increment" in (out / "member_001/run.log").read_text()
    for i in range(3):
        name = f"member_{i:03d}/history.csv"
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.validation
def test_calibrate_by_coulombs_law_finds_its_coefficient(case_file, tmp_path):
    """A run with mu = 0.08 from the same program: the coefficient comes back, and m would not stand for it."""
    settings = ["workpiece.mesh.cells=[6,3]"]
    coulomb = 'tools.punch={profile=[[0,6],[60,6]],contact="coulomb",mu=0.08}'
    ring = measure_ring(run(Case.from_toml(case_file, [*settings, coulomb]), tmp_path / "truth").result)
    at = [len(ring.height_reduction) // 2, -1]
    measured = tmp_path / "measured.csv"
    rows = [f"{ring.height_reduction[i]},{ring.bore_mean[i]}" for i in at]
    measured.write_text("\n".join(["height_reduction,bore_ratio", *rows]), encoding="utf-8")
    out = tmp_path / "fit"
    options = ["--case", case_file, "--law", "coulomb", "--values", "0.02,0.06,0.1,0.14", "--output", out, "--quiet"]
    done = presswork("calibrate", "ring", measured, *options, *sets(settings))
    assert done.returncode == 0, done.stderr
    fit = json.loads((out / "calibration.json").read_text("utf-8"))
    assert (out / "calibration.png").read_bytes().startswith(b"\x89PNG")
    assert fit["law"] == "coulomb"
    assert fit["mu"] == pytest.approx(0.08, abs=0.004)


@pytest.mark.validation
def test_a_member_that_cracks_says_so_in_table_picture_and_terminal(case_file, tmp_path):
    out = tmp_path / "out"
    vary = ["--vary", "materials.steel.damage.critical=0.001,10"]
    done = presswork("sweep", case_file, *vary, *sets(SMALL), "--output", out)
    assert done.returncode == 0, done.stderr
    told = " ".join(done.stderr.split())
    assert "member_000 (materials.steel.damage.critical = 0.001): warning: stage 'press'" in told
    cracked, whole = read_table(out)
    summary = json.loads((out / "member_000/summary.json").read_text())
    first = summary["damage"]["damage_cockcroft_latham"]["first_exceeded"]
    assert float(cracked["first_crack_stroke"]) == first["strokes_mm"]["punch"]
    assert float(cracked["first_crack_time"]) == first["time_s"]
    assert "a crack begins there" in cracked["warnings"]
    assert cracked["warnings"] == " | ".join(summary["warnings"])
    assert (whole["first_crack_stroke"], whole["first_crack_time"]) == ("", "")
    assert "a crack begins there" not in whole["warnings"]
