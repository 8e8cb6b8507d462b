# SPDX-License-Identifier: Apache-2.0
"""Pauses end with whoever made them; no run is left behind that nothing wakes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from presswork.results import OutputError, open_output_folder
from presswork.results.pause import PAUSE, end_pause, is_paused, pause_run
from presswork.server.jobs import Jobs
from presswork.server.opened_folder import RefusedError
from presswork.server.scratch import Scratch, clear_stale

RUN = """
import itertools, sys, time
from functools import partial
from pathlib import Path
from presswork import stop
from presswork.results import occupy
from presswork.results.pause import is_paused
from presswork.results.progress import ProgressFile
folder = Path(sys.argv[1])
with stop.listen(None, partial(is_paused, folder)), occupy(folder):
    progress = ProgressFile(folder)
    for count in itertools.count():
        progress.report(0.5, "")
        (folder / "count").write_text(str(count))
        time.sleep(0.01)
        stop.look()
"""
"""What a run does at its steps, without a computation between them."""
SERVER = "from presswork.cli import main; main()"


@pytest.fixture
def at_work(tmp_path: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A run at work in the folder `out`."""
    (tmp_path / "out").mkdir()
    with subprocess.Popen([sys.executable, "-c", RUN, str(tmp_path / "out")], stderr=subprocess.DEVNULL) as process:
        wait_until(lambda: (tmp_path / "out" / "progress.json").is_file())
        yield process
        process.send_signal(signal.SIGCONT)
        process.kill()


def wait_until(holds: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def is_moving(folder: Path) -> bool:
    """Say whether the run in a folder does steps."""
    time.sleep(0.3)  # the step at work ends
    before = (folder / "count").read_text()
    time.sleep(0.3)
    return (folder / "count").read_text() != before


def ask(address: str, method: str = "POST") -> None:
    with urllib.request.urlopen(urllib.request.Request(address, method=method, data=b""), timeout=60):
        pass


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM, signal.SIGKILL])
def test_a_paused_run_goes_on_when_its_server_ends(tmp_path: Path, at_work: object, number: int) -> None:
    place = tmp_path / "temporary"
    place.mkdir()
    environment = {**os.environ, "TMPDIR": str(place), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", SERVER, "view", str(tmp_path), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment) as server:
        assert server.stdout is not None
        address = server.stdout.readline().decode().strip()
        ask(f"{address}pause?run=out")
        assert not is_moving(tmp_path / "out")
        server.send_signal(number)
    wait_until(lambda: is_moving(tmp_path / "out"))
    if number == signal.SIGKILL:
        assert list(place.iterdir())
        clear_stale(place)  # as a later server does
    assert not list(place.iterdir())


def test_a_pause_is_ended_by_any_server_and_by_a_stop(tmp_path: Path, at_work: subprocess.Popen[bytes]) -> None:
    out = tmp_path / "out"
    one, other = Jobs(tmp_path, tmp_path), Jobs(tmp_path, tmp_path)
    one.pause(out)
    assert not is_moving(out)
    assert other.state(out, {})["word"] == "paused"
    with pytest.raises(OutputError, match="paused in the browser"):
        open_output_folder(out, overwrite=True)
    other.resume(out)
    wait_until(lambda: is_moving(out))
    assert one.state(out, {})["word"] == "running"
    one.pause(out)
    one.stop(out)
    assert at_work.wait(30) != 0, "KeyboardInterrupt"


def test_a_folder_that_is_not_there_has_no_run_at_work(tmp_path: Path) -> None:
    jobs = Jobs(tmp_path, tmp_path)
    assert jobs.state(tmp_path / "new", {})["word"] == "new"
    for act in (jobs.pause, jobs.stop, jobs.resume):
        with pytest.raises(RefusedError, match=r"no run is at work|no checkpoint"):
            act(tmp_path / "new")


def test_a_run_that_a_signal_stopped_is_woken_by_a_later_server(
    tmp_path: Path, at_work: subprocess.Popen[bytes]
) -> None:
    at_work.send_signal(signal.SIGSTOP)
    jobs = Jobs(tmp_path, tmp_path)
    wait_until(lambda: jobs.state(tmp_path / "out", {})["word"] == "paused")
    jobs.resume(tmp_path / "out")
    assert is_moving(tmp_path / "out")


def test_remedy_for_a_folder_whose_run_a_signal_stopped_works(tmp_path: Path, at_work: subprocess.Popen[bytes]) -> None:
    out = tmp_path / "out"
    at_work.send_signal(signal.SIGSTOP)
    wait_until(lambda: not is_moving(out))
    (out / "checkpoint.h5").write_text("whole")
    with pytest.raises(OutputError, match="its process is stopped") as refused:
        open_output_folder(out, resume=True)
    remedy = re.search(r"`(kill -CONT \d+)`", str(refused.value))
    assert remedy is not None
    subprocess.run(["sh", "-c", remedy[1]], check=True)
    assert is_moving(out)


def test_a_file_that_nobody_locks_pauses_nothing(tmp_path: Path) -> None:
    (tmp_path / PAUSE).write_text("")
    assert not is_paused(tmp_path)
    handle = pause_run(tmp_path)
    assert is_paused(tmp_path)
    os.close(handle)
    assert not is_paused(tmp_path)
    end_pause(tmp_path)
    (tmp_path / PAUSE).symlink_to(tmp_path / "elsewhere")
    os.close(pause_run(tmp_path))
    assert not (tmp_path / "elsewhere").exists()


def test_only_own_folders_of_processes_that_are_gone_are_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "mine").mkdir()
    for name in ("presswork-stale", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "file").write_text("x")
    (tmp_path / "presswork-link").symlink_to(tmp_path / "mine")
    living = Scratch()
    clear_stale(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["mine", "other", "presswork-link", living.folder.name]
    )
    living.close()
    assert not living.folder.exists()
