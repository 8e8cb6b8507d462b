# SPDX-License-Identifier: Apache-2.0
"""checkpoint.h5: the converged state to the last bit, with a checksum over all of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from presswork import __version__
from presswork.results.whole_file import OutputError, replace_whole, write_hdf5

FORMAT_VERSION = 7
_OVERHEAD_BYTES = 16384
_WITH_GROUPS = h5py.h5p.create(h5py.h5p.LINK_CREATE)
_WITH_GROUPS.set_create_intermediate_group(True)
_WITHOUT_TIMES = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
_WITHOUT_TIMES.set_obj_track_times(False)

Meta = dict[str, int | float | str]


def save_checkpoint(
    path: Path | str, arrays: Mapping[str, NDArray[Any]], meta: Mapping[str, int | float | str]
) -> None:
    """Replace the checkpoint by these arrays (numeric, any shape) and this meta data. Raises OutputError."""
    path = Path(path)
    whole = {name: np.asarray(values) for name, values in arrays.items()}
    text = json.dumps({name: _plain(value) for name, value in meta.items()}, sort_keys=True)
    needed = sum(values.nbytes for values in whole.values()) + _OVERHEAD_BYTES
    with replace_whole(path, needed_bytes=needed) as new, write_hdf5(new, "w") as file:
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["written_by"] = f"presswork {__version__}"
        file.attrs["meta"] = text
        file.attrs["checksum"] = _checksum(whole, text)
        group = file.create_group("arrays")
        for name, values in whole.items():
            _write_array(group, name, values)


def _write_array(group: h5py.Group, name: str, values: NDArray[Any]) -> None:
    """Write an array by the calls of HDF5 itself: `create_dataset` takes four times as long for a short array."""
    kind = h5py.h5t.py_create(values.dtype, logical=True)
    space = h5py.h5s.create_simple(values.shape) if values.ndim else h5py.h5s.create(h5py.h5s.SCALAR)
    dataset = h5py.h5d.create(group.id, name.encode(), kind, space, dcpl=_WITHOUT_TIMES, lcpl=_WITH_GROUPS)
    if values.size:
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, np.ascontiguousarray(values))


def load_checkpoint(path: Path | str) -> tuple[dict[str, NDArray[Any]], Meta]:
    """Return the arrays and the meta data, bit for bit as saved.

    Raises OutputError if there is none, it is damaged, or a version of presswork wrote it that this one cannot read.
    """
    path = Path(path)
    if not path.is_file():
        raise OutputError(f"there is no checkpoint at {path}")
    damaged = f"{path} is damaged; it cannot be resumed from: run with --overwrite to start anew"
    try:
        with h5py.File(path, "r") as file:
            version, text, checksum = (file.attrs[name] for name in ("format_version", "meta", "checksum"))
            author = str(file.attrs.get("written_by", "an earlier presswork"))
            text.encode()  # damage may lie in the text, too
            if version == FORMAT_VERSION:
                arrays = {name: values[()] for name, values in _walk(file)}
                "".join(arrays).encode()  # HDF5 gives bytes where it cannot decode a name
    except Exception as error:  # HDF5 meets damage with errors of every kind
        raise OutputError(damaged) from error
    if version != FORMAT_VERSION:
        raise OutputError(
            f"{path} was written by {author} in format {version}; presswork {__version__} reads format "
            f"{FORMAT_VERSION}: go on with that version, or run with --overwrite to start anew"
        )
    if _checksum(arrays, text) != checksum:
        raise OutputError(damaged)
    return arrays, json.loads(text)


def _walk(file: h5py.File) -> list[tuple[str, h5py.Dataset]]:
    """Return every array's dataset with its name, which may hold slashes."""
    found: list[tuple[str, h5py.Dataset]] = []
    if "arrays" in file:
        file["arrays"].visititems(lambda name, item: found.append((name, item)) if hasattr(item, "dtype") else None)
    return found


def _plain(value: int | float | str) -> int | float | str:
    """Return a numpy scalar as the Python number that it stands for."""
    return value.item() if isinstance(value, np.generic) else value


def _checksum(arrays: Mapping[str, NDArray[Any]], meta: str) -> str:
    """Return a digest of names, types, shapes, bytes and meta data."""
    digest = hashlib.blake2b(meta.encode(), digest_size=16)
    for name in sorted(arrays):
        values = arrays[name]
        digest.update(f"{name} {values.dtype.str} {values.shape}".encode())
        digest.update(np.ascontiguousarray(values).reshape(-1).view(np.uint8).data)
    return digest.hexdigest()
