# SPDX-License-Identifier: Apache-2.0
"""When a run may use an output folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from presswork.results import OutputError, occupy, open_output_folder


def test_new_folder_is_created(tmp_path: Path) -> None:
    assert open_output_folder(tmp_path / "run").is_dir()


def test_missing_parent_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="parent folder"):
        open_output_folder(tmp_path / "no" / "run")


def test_file_in_its_place_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "run").write_text("")
    with pytest.raises(OutputError, match="not a folder"):
        open_output_folder(tmp_path / "run")


@pytest.mark.parametrize("name", ["results.vtkhdf", "history.csv", "summary.json", "checkpoint.h5"])
def test_folder_with_results_is_refused_with_the_remedy(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("precious")
    with pytest.raises(OutputError, match=rf"{name}.*--overwrite.*--resume"):
        open_output_folder(tmp_path)
    assert (tmp_path / name).read_text() == "precious"


def test_overwrite_deletes_only_what_a_run_made(tmp_path: Path) -> None:
    for name in ("results.vtkhdf", "history.csv", "summary.json", "checkpoint.h5", "run.log", "case.toml", "notes.txt"):
        (tmp_path / name).write_text("x")
    open_output_folder(tmp_path, overwrite=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "notes.txt"]


def test_overwrite_deletes_the_pictures_of_the_run_before(tmp_path: Path) -> None:
    (tmp_path / "plots").mkdir()
    for name in ("history.csv", "report.html", "plots/section_011.png", "plots/draw_in_011.csv", "plots/notes.txt"):
        (tmp_path / name).write_text("x")
    open_output_folder(tmp_path, overwrite=True)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["notes.txt"]


def test_resume_needs_a_checkpoint(tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text("x")
    with pytest.raises(OutputError, match=r"no checkpoint\.h5"):
        open_output_folder(tmp_path, resume=True)
    (tmp_path / "checkpoint.h5").write_text("x")
    open_output_folder(tmp_path, resume=True)
    assert (tmp_path / "history.csv").read_text() == "x"


def test_resume_of_a_missing_folder_creates_nothing(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="no checkpoint"):
        open_output_folder(tmp_path / "run", resume=True)
    assert not (tmp_path / "run").exists()


def test_overwrite_and_resume_exclude_each_other(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="exclude"):
        open_output_folder(tmp_path, overwrite=True, resume=True)


def test_rest_of_a_killed_write_is_removed(tmp_path: Path) -> None:
    (tmp_path / "checkpoint.h5").write_text("whole")
    (tmp_path / "checkpoint.h5.tmp").write_text("half")
    (tmp_path / "mine.tmp").write_text("user's")
    open_output_folder(tmp_path, resume=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["checkpoint.h5", "mine.tmp"]


def test_folder_that_cannot_be_written_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path, data: bytes) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "write_bytes", refuse)
    with pytest.raises(OutputError, match="Permission denied"):
        open_output_folder(tmp_path)


def test_folder_in_which_a_run_is_at_work_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text("growing")
    with occupy(tmp_path), pytest.raises(OutputError, match=r"another run is at work in .*--output"):
        open_output_folder(tmp_path, overwrite=True)
    assert (tmp_path / "history.csv").read_text() == "growing"
    open_output_folder(tmp_path, overwrite=True)


@pytest.mark.parametrize("mode", ["resume", "overwrite"])
def test_a_name_that_is_too_long_is_an_error(tmp_path: Path, mode: str) -> None:
    for name in ("x" * 300, "/".join(["x" * 200] * 30)):
        with pytest.raises(OutputError, match="File name too long"):
            open_output_folder(tmp_path / name, **{mode: True})


def test_a_read_only_disk_whose_probe_cannot_be_removed_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unlinking a file that is not there fails on a read-only file system, too."""

    def refuse(self: Path, *_: object, **__: object) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(Path, "write_bytes", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(OutputError, match="cannot be written: Read-only file system"):
        open_output_folder(tmp_path, overwrite=True)
