# SPDX-License-Identifier: Apache-2.0
"""When a run may use an output folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from presswork.results import OutputError, folder, occupy, open_output_folder
from presswork.results.folder import delete_folder, find_members


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
    (tmp_path / "checkpoint.h5.0a1b2c3d.tmp").write_text("half")
    (tmp_path / "mine.tmp").write_text("user's")
    open_output_folder(tmp_path, resume=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["checkpoint.h5", "mine.tmp"]


def test_folder_that_cannot_be_written_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(path: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(folder, "create_file", refuse)
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

    monkeypatch.setattr(folder, "create_file", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(OutputError, match="cannot be written: Read-only file system"):
        open_output_folder(tmp_path, overwrite=True)


# --- links -----------------------------------------------------------------------------------------------------------

MADE = ("results.vtkhdf", "history.csv", "summary.json", "checkpoint.h5", "run.log")


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A folder that no run is to touch, beside `out`."""
    place = tmp_path / "beside"
    place.mkdir()
    for name in (*MADE, "a.png", "b.csv", "c.gif", "d.mp4"):
        (place / name).write_text("precious")
    (tmp_path / "out").mkdir()
    return place


def read_all(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


@pytest.mark.parametrize("mode", [{}, {"overwrite": True}])
def test_pictures_behind_a_link_are_not_deleted(tmp_path: Path, beside: Path, mode: dict[str, bool]) -> None:
    before = read_all(beside)
    (tmp_path / "out" / "plots").symlink_to(beside)
    with pytest.raises(OutputError, match=r"out/plots is a link.*remove it"):
        open_output_folder(tmp_path / "out", **mode)
    assert read_all(beside) == before
    (tmp_path / "out" / "plots").unlink()
    assert open_output_folder(tmp_path / "out", **mode).is_dir()


@pytest.mark.parametrize("name", MADE)
def test_links_are_replaced_by_an_overwrite_and_refused_by_all_else(tmp_path: Path, beside: Path, name: str) -> None:
    out, before = tmp_path / "out", read_all(beside)
    (out / "checkpoint.h5").write_text("whole")
    (out / name).unlink(missing_ok=True)
    (out / name).symlink_to(beside / name)
    with pytest.raises(OutputError, match=f"{name} is a link.*remove it"):
        open_output_folder(out, resume=True)
    open_output_folder(out, overwrite=True)
    assert not list(out.iterdir())
    (out / name).symlink_to(beside / "not there")
    with pytest.raises(OutputError, match=r"a link|holds results"):
        open_output_folder(out)
    assert read_all(beside) == before


def test_a_pipe_in_the_place_of_a_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "run.log")
    with pytest.raises(OutputError, match=r"run\.log is not a file; remove it"):
        open_output_folder(tmp_path)
    (tmp_path / "run.log").unlink()
    open_output_folder(tmp_path)


def test_members_behind_links_are_neither_deleted_nor_written(tmp_path: Path, beside: Path) -> None:
    (beside / "case.toml").write_text("precious")
    (tmp_path / "out" / "member_000").symlink_to(beside)
    for use in (lambda: find_members(tmp_path / "out", "member_*"), lambda: delete_folder(tmp_path / "out/member_000")):
        with pytest.raises(OutputError, match="member_000 is a link"):
            use()
    assert (beside / "a.png").read_text() == "precious"
