# SPDX-License-Identifier: Apache-2.0
"""Outlines as files: points and closed polylines, read back by other programs' readers."""

import ezdxf
import numpy as np
import pytest

from presswork.results import write_outline

SQUARE = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 20.0], [0.0, 20.0]])
HOLE = np.array([[10.0, 5.0], [10.0, 15.0], [20.0, 10.0]])


def test_points_are_written_loop_by_loop(tmp_path):
    write_outline((SQUARE, HOLE), tmp_path / "blank.csv")
    assert (tmp_path / "blank.csv").read_text().startswith("loop,x_mm,y_mm\n0,0,0\n")
    rows = np.loadtxt(tmp_path / "blank.csv", delimiter=",", skiprows=1)
    assert rows[:, 1:] == pytest.approx(np.concatenate([SQUARE, HOLE]))
    assert rows[:, 0].tolist() == [0, 0, 0, 0, 1, 1, 1]


def test_loops_in_space_keep_their_height(tmp_path):
    write_outline([np.column_stack([SQUARE, np.full(4, 7.0)])], tmp_path / "flange.csv")
    assert (tmp_path / "flange.csv").read_text().splitlines()[:2] == ["loop,x_mm,y_mm,z_mm", "0,0,0,7"]


def test_drawings_hold_closed_polylines_in_millimetres(tmp_path):
    write_outline((SQUARE, HOLE), tmp_path / "blank.dxf")
    drawing = ezdxf.readfile(tmp_path / "blank.dxf")
    lines = list(drawing.modelspace())
    assert drawing.header["$INSUNITS"] == 4
    assert [line.closed for line in lines] == [True, True]
    assert np.array(lines[0].get_points("xy")) == pytest.approx(SQUARE)
