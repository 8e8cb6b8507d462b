# SPDX-License-Identifier: Apache-2.0
"""A checkpoint is bit-exact, whole, and says when it is damaged."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from presswork.results import OutputError, checkpoint, load_checkpoint, save_checkpoint

ARRAYS = {
    "displacement": np.random.default_rng(1).standard_normal((50, 2)),
    "special": np.array([np.nan, -0.0, np.inf, 5e-324]),
    "contact/nodes": np.arange(7, dtype=np.int32),
    "active": np.array([True, False]),
    "none": np.zeros((0, 4)),
    "time": np.array(0.25),
}
META = {"stage": 2, "increment": 31, "load": 0.1 + 0.2, "title": "Stauchversuch, 60 % (µ)"}


def test_everything_reads_back_to_the_last_bit(tmp_path: Path) -> None:
    save_checkpoint(tmp_path / "c.h5", ARRAYS, META)
    arrays, meta = load_checkpoint(tmp_path / "c.h5")
    assert meta == META
    assert set(arrays) == set(ARRAYS)
    for name, values in ARRAYS.items():
        assert arrays[name].dtype == values.dtype
        assert arrays[name].shape == values.shape
        assert arrays[name].tobytes() == values.tobytes()


def test_numpy_meta_data_reads_back_as_plain_numbers(tmp_path: Path) -> None:
    save_checkpoint(tmp_path / "c.h5", {}, {"n": np.int64(3), "x": np.float64(0.1)})  # type: ignore[dict-item]
    assert load_checkpoint(tmp_path / "c.h5") == ({}, {"n": 3, "x": 0.1})


def test_array_that_is_not_contiguous_is_saved(tmp_path: Path) -> None:
    values = np.arange(12.0).reshape(3, 4).T[::2]
    save_checkpoint(tmp_path / "c.h5", {"a": values}, {})
    np.testing.assert_array_equal(load_checkpoint(tmp_path / "c.h5")[0]["a"], values)


def test_any_changed_or_missing_byte_of_the_data_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "c.h5"
    save_checkpoint(path, ARRAYS, META)
    whole = path.read_bytes()
    place = whole.index(ARRAYS["displacement"].tobytes()) + 100
    for damaged in (
        whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :],
        whole[: len(whole) // 2],
        whole[:10],
        whole.replace(b"displacement\0", b"displacemen\xff\0"),
        b"",
        bytes(len(whole)),
    ):
        path.write_bytes(damaged)
        with pytest.raises(OutputError, match="damaged"):
            load_checkpoint(path)


def test_missing_checkpoint_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="no checkpoint"):
        load_checkpoint(tmp_path / "c.h5")


@pytest.mark.parametrize("version", [5, 99])
def test_format_of_another_version_is_named(tmp_path: Path, version: int) -> None:
    save_checkpoint(tmp_path / "c.h5", ARRAYS, META)
    with h5py.File(tmp_path / "c.h5", "r+") as file:
        file.attrs["format_version"] = version
    with pytest.raises(
        OutputError, match=rf"written by presswork \S+ in format {version}; .*reads format 7.*--overwrite"
    ):
        load_checkpoint(tmp_path / "c.h5")


def test_crash_in_the_middle_leaves_the_former_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_checkpoint(tmp_path / "c.h5", ARRAYS, META)
    written = checkpoint._write_array

    def crash(group: h5py.Group, name: str, values: np.ndarray) -> None:
        written(group, name, values)
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "_write_array", crash)
        with pytest.raises(MemoryError):
            save_checkpoint(tmp_path / "c.h5", ARRAYS, {"increment": 32})
    assert load_checkpoint(tmp_path / "c.h5")[1] == META
    assert [path.name for path in tmp_path.iterdir()] == ["c.h5"]
