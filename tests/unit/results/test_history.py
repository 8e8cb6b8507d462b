# SPDX-License-Identifier: Apache-2.0
"""history.csv grows by whole rows and reads back exactly."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.results import History, OutputError, history_columns, read_history

COLUMNS = ["time", "stage", "increment", "iterations", "die.force"]


def row(increment: int, force: float = 1.0) -> dict[str, float | int | str]:
    """One row."""
    return {"time": 0.1 * increment, "stage": "press", "increment": increment, "iterations": 4, "die.force": force}


def make_history(path: Path, n: int = 3) -> History:
    """A history of n rows."""
    history = History(path, COLUMNS)
    for increment in range(n):
        history.append(row(increment))
    return history


def test_columns_come_in_the_documented_order() -> None:
    assert history_columns(["die"]) == [
        *["time", "stage", "increment", "iterations"],
        *["die.stroke", "die.force", "die.force_x", "die.force_y", "die.force_z"],
    ]


@pytest.mark.parametrize("value", [0.1 + 0.2, 1e-310, -0.0, np.nextafter(1.0, 2.0), np.inf, -np.inf, np.nan])
def test_floats_read_back_to_the_last_bit(tmp_path: Path, value: float) -> None:
    history = make_history(tmp_path / "h.csv", 0)
    history.append(row(0, np.float64(value)))
    back = read_history(tmp_path / "h.csv")["die.force"]
    assert back.tobytes() == np.array([value]).tobytes()


def test_columns_have_their_types(tmp_path: Path) -> None:
    make_history(tmp_path / "h.csv")
    back = read_history(tmp_path / "h.csv")
    assert list(back) == COLUMNS
    assert back["stage"].tolist() == ["press"] * 3
    assert back["increment"].dtype == np.int64
    assert back["time"].dtype == np.float64


def test_history_without_rows_reads_as_empty_columns(tmp_path: Path) -> None:
    make_history(tmp_path / "h.csv", 0)
    assert {len(column) for column in read_history(tmp_path / "h.csv").values()} == {0}


def test_stage_name_with_a_comma_reads_back(tmp_path: Path) -> None:
    make_history(tmp_path / "h.csv", 0).append({**row(0), "stage": 'press, "then" hold'})
    assert read_history(tmp_path / "h.csv")["stage"].tolist() == ['press, "then" hold']


@pytest.mark.parametrize("change", [{"stage": "two\nlines"}, {"punch.force": 1.0}])
def test_row_that_does_not_fit_is_refused(tmp_path: Path, change: dict[str, Any]) -> None:
    history = make_history(tmp_path / "h.csv")
    with pytest.raises(ValueError, match=r"line break|columns"):
        history.append({**row(3), **change})
    assert len(read_history(tmp_path / "h.csv")["time"]) == 3


def test_stroke_of_a_tool_without_its_force_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time,stage,increment,iterations,die.stroke\n0.1,press,1,4,0.5\n")
    with pytest.raises(OutputError, match=r"history\.csv lacks the column die\.force: .*run the case anew"):
        read_history(path)


def test_row_on_disk_at_once(tmp_path: Path) -> None:
    history = make_history(tmp_path / "h.csv", 2)
    assert len(read_history(tmp_path / "h.csv")["time"]) == 2
    history.append(row(2))
    assert len(read_history(tmp_path / "h.csv")["time"]) == 3


@pytest.mark.parametrize("cut", [1, 5, 12])
def test_torn_last_row_is_left_out_and_overwritten(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "h.csv"
    make_history(path)
    path.write_bytes(path.read_bytes()[:-cut])
    assert read_history(path)["increment"].tolist() == [0, 1]
    History(path, COLUMNS).append(row(7))
    assert read_history(path)["increment"].tolist() == [0, 1, 7]


def test_damaged_row_inside_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "h.csv"
    make_history(path)
    text = path.read_text()
    path.write_text(text.replace("press,1,4", "press,1"))
    with pytest.raises(OutputError, match="line 3"):
        read_history(path)
    for damaged in ("one", "18446744073709551616", "1" * 400):
        path.write_text(text.replace("press,1,4", f"press,{damaged},4"))
        with pytest.raises(OutputError, match="damaged"):
            read_history(path)


def test_truncated_history_continues_after_the_checkpoint(tmp_path: Path) -> None:
    history = make_history(tmp_path / "h.csv", 5)
    whole = (tmp_path / "h.csv").read_bytes()
    history.truncate(3)
    history.append(row(3))
    history.append(row(4))
    history.sync()
    assert (tmp_path / "h.csv").read_bytes() == whole
    with pytest.raises(OutputError, match="holds 5 increments, 6 are needed"):
        history.truncate(6)


def test_other_columns_are_refused(tmp_path: Path) -> None:
    make_history(tmp_path / "h.csv")
    with pytest.raises(OutputError, match="other columns"):
        History(tmp_path / "h.csv", [*COLUMNS, "punch.force"])


def test_full_disk_takes_back_the_part_that_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    history = make_history(tmp_path / "h.csv")
    former = (tmp_path / "h.csv").read_bytes()

    write = os.write

    def write_a_little(handle: int, data: bytes) -> int:
        if len(data) < 8:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(handle, data[:6])

    monkeypatch.setattr(os, "write", write_a_little)
    with pytest.raises(OutputError, match="disk full"):
        history.append(row(3))
    assert (tmp_path / "h.csv").read_bytes() == former


def test_missing_history_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="no history"):
        read_history(tmp_path / "h.csv")
