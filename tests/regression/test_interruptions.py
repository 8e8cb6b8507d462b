# SPDX-License-Identifier: Apache-2.0
"""Runs killed or signalled while they write: no signal is lost, no file cut short; resumed to the same bits."""

import os
import random
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest

from presswork import Case, OutputError, Result, run
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.fingerprint import fingerprint
from presswork.recorder import run_model
from presswork.results import load_checkpoint
from presswork.results.folder import CHECKPOINT, HISTORY, RESULTS
from tests.regression.faulty_runs import Ending, Fault, run_with_fault
from tests.regression.whole_runs import assert_same_bits

CASES = {
    "implicit": (
        "upsetting_q4",
        ["workpiece.mesh.cells=[3,3]", "stages.0.tools.punch.stroke=3", "output.steps=3", "output.checkpoint_every=2"],
    ),
    "explicit": (
        "taylor_bar",
        ["workpiece.mesh.cells=[3,12]", "output.steps=3", "output.rows=6", "output.checkpoint_every=2"],
    ),
}
STOP = (signal.SIGINT, signal.SIGTERM)


@pytest.fixture(scope="module", params=CASES)
def whole(request, tmp_path_factory) -> tuple[Path, list[str], Path, Ending]:
    """A case, its settings, and the folder and ending of a run that nothing struck."""
    name, overrides = CASES[request.param]
    case = copy_example(name, tmp_path_factory.mktemp("case"))
    folder = tmp_path_factory.mktemp("whole") / "out"
    ending = run_with_fault(case, overrides, folder, None, resume=False)
    assert ending.status == "completed"
    assert ending.operations > 50
    return case, overrides, folder, ending


def test_a_run_killed_at_any_operation_on_files_resumes_to_the_same_bits(whole, tmp_path) -> None:
    case, overrides, reference, unstruck = whole
    rng = random.Random(7)
    out = tmp_path / "out"
    killed = 0
    for _ in range(40):
        resume = (out / CHECKPOINT).exists()
        fault = Fault(rng.randrange(1, unstruck.operations), (signal.SIGKILL,)) if killed < 6 else None
        ending = run_with_fault(case, overrides, out, fault, resume=resume)
        killed += ending.exit_code == -signal.SIGKILL
        if ending.status:
            break
        for name, check in ((CHECKPOINT, load_checkpoint), (RESULTS, lambda path: Result(path.parent).field("eqps"))):
            if (out / name).exists():
                check(out / name)
    assert ending.status == "completed"
    assert killed > 0
    assert_same_bits(out, reference)


@pytest.mark.parametrize(
    ("number", "times"), [pytest.param(signal.SIGINT, 1, marks=pytest.mark.validation), (signal.SIGTERM, 2)]
)
def test_no_signal_during_a_write_is_lost(whole, tmp_path, number, times) -> None:
    """Wherever it comes, the run stops there and then, leaves whole files, and is resumed to the same bits."""
    case, overrides, reference, unstruck = whole
    rng = random.Random(f"{number} {times}")
    for trial in range(2):
        out = tmp_path / f"{trial}"
        at = rng.randrange(1, unstruck.operations)
        ending = run_with_fault(case, overrides, out, Fault(at, (number,) * times), resume=False)
        if ending.status == "KeyboardInterrupt" and at > 0.7 * unstruck.operations:  # all of the run was computed
            assert Result(out).summary["status"] == "completed"
            assert_same_bits(out, reference)
            continue
        assert ending.status == "interrupted", (at, ending)
        assert Result(out).summary["status"] == "interrupted"
        assert Result(out).field("eqps").size > 0
        ending = run_with_fault(case, overrides, out, None, resume=True)
        assert ending.status == "completed"
        assert_same_bits(out, reference)


def test_a_signal_after_the_last_increment_ends_the_program_with_a_whole_folder(whole, tmp_path) -> None:
    case, overrides, reference, unstruck = whole
    last = unstruck.operations - 3  # the clock decides how often progress is told, and so on one more or less
    ending = run_with_fault(case, overrides, tmp_path / "out", Fault(last, STOP[:1]), resume=False)
    assert ending.status == "KeyboardInterrupt"
    assert Result(tmp_path / "out").summary["status"] == "completed"
    assert_same_bits(tmp_path / "out", reference)


@pytest.mark.parametrize("name", [HISTORY, RESULTS])
@pytest.mark.parametrize("number", [2, 4])
def test_a_file_deleted_during_a_run_stops_it(tmp_path, name, number) -> None:
    """Number 4 is near the end, where only the summary would still read the files."""
    case = copy_example(CASES["implicit"][0], tmp_path)
    model = build_model(read_case(case, overrides=CASES["implicit"][1]))
    left = iter(range(number - 1, -1, -1))

    def delete(_: object) -> None:
        if next(left, -1) == 0:
            (tmp_path / "out" / name).unlink()

    with pytest.raises(OutputError, match=f"{name} was deleted .*--overwrite"):
        run_model(model, tmp_path / "out", threads=1, on_increment=delete)


def test_a_history_to_which_another_program_wrote_stops_the_run(tmp_path) -> None:
    case = copy_example(CASES["implicit"][0], tmp_path)
    model = build_model(read_case(case, overrides=CASES["implicit"][1]))

    def write(_: object) -> None:
        with open(tmp_path / "out" / HISTORY, "a") as file:
            file.write("0,0,0\n")

    with pytest.raises(OutputError, match="was changed by another program"):
        run_model(model, tmp_path / "out", threads=1, on_increment=write)


@pytest.mark.parametrize("change", ["output.at=[0.37]", "output.steps=5"])
def test_saved_steps_that_change_increments_cannot_be_changed_on_resuming(whole, tmp_path, change) -> None:
    case, overrides, _, unstruck = whole
    out = tmp_path / "out"
    run_with_fault(case, overrides, out, Fault(unstruck.operations // 2, STOP[:1]), resume=False)
    other = Case.from_toml(case, overrides=[*overrides, change])
    if other.procedure == "explicit":  # rows stay as they are
        if "steps" in change:
            assert run(other, out, resume=True).status == "completed"
        return
    with pytest.raises(OutputError, match="output"):
        run(other, out, resume=True)


def test_titles_and_checkpoints_may_change_on_resuming(whole) -> None:
    case, overrides, _, _ = whole
    models = [
        build_model(read_case(case, overrides=[*overrides, *more]))
        for more in ([], ['title="other"', "output.checkpoint_every=7"])
    ]
    assert fingerprint(models[0]) == fingerprint(models[1])


def test_a_resumed_run_writes_to_no_other_name_of_its_files(whole, tmp_path) -> None:
    """A copy made of hard links, as backups are, stays as it is."""
    case, overrides, reference, unstruck = whole
    out, copy = tmp_path / "out", tmp_path / "copy"
    run_with_fault(case, overrides, out, Fault(unstruck.operations // 2, STOP[:1]), resume=False)
    copy.mkdir()
    for file in out.iterdir():
        os.link(file, copy / file.name)
    before = {file.name: file.read_bytes() for file in copy.iterdir()}
    assert run_with_fault(case, overrides, out, None, resume=True).status == "completed"
    assert_same_bits(out, reference)
    assert {file.name: file.read_bytes() for file in copy.iterdir()} == before


# --- folders and disks -----------------------------------------------------------------------------------------------


@pytest.fixture
def mounted(tmp_path):
    """Mount a file system in memory of 2 MB, if this machine lets us."""
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(folder)]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting needs the right to do so")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_names_a_remedy_that_works(whole, mounted) -> None:
    """Whatever room there is, the advice given leads to the end once there is more."""
    case, overrides, reference, _ = whole
    largest = (reference / RESULTS).stat().st_size  # a copy of it is written beside it
    advised = set()
    for room in (10_000, int(1.7 * largest)):
        out = mounted / "out"
        filler = mounted / "filler"
        filler.write_bytes(bytes(2 * 1024**2 - 8192 - room))
        ending = run_with_fault(case, overrides, out, None, resume=False)
        assert "disk full" in ending.status, ending
        filler.unlink()
        remedy = next(r for r in ("--resume", "--overwrite", "run again") if r in ending.status)
        advised.add(remedy)
        subprocess.run(["mount", "-o", "remount,size=50m", str(mounted)], check=True)
        again = run_model(
            build_model(read_case(case, overrides=overrides)),
            out,
            resume=remedy == "--resume",
            overwrite=remedy == "--overwrite",
            threads=1,
        )
        assert again.status == "completed"
        assert_same_bits(out, reference)
        for file in out.iterdir():
            file.unlink()
        subprocess.run(["mount", "-o", "remount,size=2m", str(mounted)], check=True)
    assert advised == {"--overwrite", "--resume"}


@pytest.mark.parametrize("mode", ["resume", "overwrite"])
def test_a_folder_on_a_read_only_disk_is_refused_clearly(whole, mounted, mode) -> None:
    case, overrides, _, unstruck = whole
    run_with_fault(case, overrides, mounted / "out", Fault(unstruck.operations // 2, STOP[:1]), resume=False)
    before = {file.name: file.read_bytes() for file in (mounted / "out").iterdir()}
    subprocess.run(["mount", "-o", "remount,ro", str(mounted)], check=True)
    with pytest.raises(OutputError, match=r"cannot be written: Read-only file system"):
        run_model(build_model(read_case(case, overrides=overrides)), mounted / "out", threads=1, **{mode: True})
    assert {file.name: file.read_bytes() for file in (mounted / "out").iterdir()} == before


def test_numbers_of_a_resumed_run_are_those_of_one_never_stopped(whole, tmp_path) -> None:
    """Beside the bits of files: what the summary says of fields and energies."""
    case, overrides, reference, unstruck = whole
    out = tmp_path / "out"
    run_with_fault(case, overrides, out, Fault(unstruck.operations // 2, STOP[:1]), resume=False)
    assert run_with_fault(case, overrides, out, None, resume=True).status == "completed"
    found, wanted = (Result(folder).summary for folder in (out, reference))
    for key in wanted.keys() - {"wall_seconds", "peak_memory_mb"}:
        np.testing.assert_equal(found[key], wanted[key], err_msg=key)
