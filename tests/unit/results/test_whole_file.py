# SPDX-License-Identifier: Apache-2.0
"""Files are replaced whole or not at all."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from presswork.results import OutputError
from presswork.results.whole_file import create_file, open_to_append, replace_whole, write_whole

# Writes under a limit on the size of a file, which the kernel enforces as it would a full disk, from one byte up.
_WRITE_UNDER_LIMITS = """
import resource, signal, sys
from pathlib import Path
import numpy as np
from presswork.results import OutputError, append_step, count_steps, load_checkpoint, save_checkpoint
from tests.unit.results.upset_output import make_fields, make_mesh

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
folder = Path(sys.argv[1])
mesh = make_mesh(("quad4",), 8)
results, checkpoint = folder / "results.vtkhdf", folder / "checkpoint.h5"
append_step(results, mesh, 0.0, *make_fields(mesh, 0.0))
save_checkpoint(checkpoint, {"stress": np.ones(5000)}, {"increment": 0})
former = results.read_bytes(), checkpoint.read_bytes()
hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
for limit in (1, 100, 2048, 10000, 30000, len(former[0]) + 500):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    refused = 0
    for write in (
        lambda: append_step(results, mesh, 1.0, *make_fields(mesh, 1.0)),
        lambda: save_checkpoint(checkpoint, {"stress": np.zeros(20000)}, {"increment": 1}),
    ):
        try:
            write()
        except OutputError as error:
            assert "disk full" in str(error) and "--resume" in str(error), error
            refused += 1
    assert refused == 2, limit
    assert (results.read_bytes(), checkpoint.read_bytes()) == former
    assert not list(folder.glob("*.tmp"))
resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
append_step(results, mesh, 1.0, *make_fields(mesh, 1.0))
assert count_steps(results) == 2
assert load_checkpoint(checkpoint)[1] == {"increment": 0}
print("all whole")
"""


def test_new_content_takes_the_name_only_when_complete(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_text("former")
    with replace_whole(target, needed_bytes=3) as file:
        file.write(b"new")
        assert target.read_text() == "former"
    assert target.read_text() == "new"
    assert os.listdir(tmp_path) == ["file"]


def test_nothing_is_written_where_links_lead(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.write_text("precious")
    for name in ("file", "file.tmp"):
        (tmp_path / name).symlink_to(outside)
    write_whole(tmp_path / "file", b"new")
    assert (tmp_path / "file").read_text() == "new"
    assert not (tmp_path / "file").is_symlink()
    for use in (open_to_append, create_file):
        with pytest.raises(OSError, match=r"File exists|symbolic links"):
            use(tmp_path / "file.tmp")
    assert outside.read_text() == "precious"


def test_any_failure_leaves_the_former_file_and_no_rest(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_text("former")

    def write_half() -> None:
        with replace_whole(target, needed_bytes=3) as file:
            file.write(b"ne")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_half()
    assert target.read_text() == "former"
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize(
    ("present", "remedy"),
    [("checkpoint.h5", "with --resume$"), ("history.csv", "with --overwrite$"), ("notes.txt", "run again$")],
)
def test_full_disk_is_named_with_bytes_and_a_remedy_that_works(tmp_path: Path, present: str, remedy: str) -> None:
    (tmp_path / present).write_text("")
    with (
        pytest.raises(OutputError, match=f"disk full.*1234 bytes needed.*{remedy}"),
        replace_whole(tmp_path / "file", needed_bytes=1234),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_other_errors_are_told_as_they_are(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        write_whole(tmp_path / "no" / "file", b"x")


@pytest.mark.skipif(sys.platform == "win32", reason="limits are POSIX")
def test_hdf5_files_survive_a_disk_that_fills_at_any_point(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    command = [sys.executable, "-c", _WRITE_UNDER_LIMITS, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "all whole"


def test_a_disk_that_cannot_be_written_is_told_though_nothing_can_be_removed(tmp_path, monkeypatch) -> None:
    """On a read-only disk removing the temporary file fails as writing it does, whether it is there or not."""

    def refuse(*arguments: object, **options: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(Path, "unlink", refuse)
    page = tmp_path / "report.html"
    with (
        pytest.raises(OutputError, match=r"report\.html cannot be written: Read-only file system"),
        replace_whole(page, needed_bytes=1),
    ):
        refuse()
