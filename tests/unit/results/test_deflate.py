# SPDX-License-Identifier: Apache-2.0
"""Chunks that are compressed by planes of bytes."""

from __future__ import annotations

import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest

from presswork.results.deflate import deflate
from presswork.results.vtkhdf_tools import COMPRESSION, append_rows

RANDOM = np.random.default_rng(3)
NUMBERS = {
    "noise": RANDOM.standard_normal(200_000),  # planes longer than a stored block may be
    "single": RANDOM.standard_normal((2000, 6)).astype(np.float32),
    "zeros": np.zeros((5000, 3)),
    "counts": np.arange(9000),
    "one": np.array([2.5]),  # left to HDF5, as all that is small
    "not finite": np.tile([np.nan, np.inf, -0.0], 3000),
}


@pytest.mark.parametrize("name", NUMBERS)
def test_hdf5_reads_back_every_bit(name: str, tmp_path: Path) -> None:
    numbers = NUMBERS[name]
    with h5py.File(tmp_path / "x.h5", "w") as file:
        shape = (0, *numbers.shape[1:])
        file.create_dataset("x", shape, numbers.dtype, maxshape=(None, *shape[1:]), chunks=numbers.shape, **COMPRESSION)
        for before in (0, len(numbers)):
            assert append_rows(file, "x", numbers) == before
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["x"][()].tobytes() == 2 * numbers.tobytes()


def test_a_field_takes_as_little_room_as_by_gzip() -> None:
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 100), np.linspace(0.0, 2.0, 100))
    field = (np.sin(3.0 * x) * np.cos(2.0 * y) + 1e-5 * RANDOM.standard_normal(x.shape)).ravel()
    whole = np.ascontiguousarray(field.view(np.uint8).reshape(-1, 8).T)
    assert zlib.decompress(deflate(field)) == whole.tobytes()
    assert len(deflate(field)) < 1.01 * len(zlib.compress(whole, 1)) < 0.9 * field.nbytes


def test_rows_that_fill_no_chunk_are_written_by_hdf5(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file.create_dataset("x", (0,), float, maxshape=(None,), chunks=(5000,), **COMPRESSION)
        sizes = (5000, 7000, 5000, 13000)
        for n in sizes:
            append_rows(file, "x", np.arange(n, dtype=float))
        assert np.array_equal(file["x"][()], np.concatenate([np.arange(n, dtype=float) for n in sizes]))
