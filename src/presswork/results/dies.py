# SPDX-License-Identifier: Apache-2.0
"""Meshes and temperatures of tools that conduct heat, in /presswork/dies of results.vtkhdf."""

from __future__ import annotations

from collections.abc import Mapping

import h5py

from presswork.model import FloatArray, IntArray
from presswork.results.vtkhdf_tools import COMPRESSION, append_rows

Dies = Mapping[str, tuple[FloatArray, IntArray, FloatArray]]
"""Points (n, 2) where they start [mm], cells (m, k) and temperatures (n,) [degrees C], by tool."""
_GROUP = "presswork/dies"


def write_dies(file: h5py.File, dies: Dies) -> None:
    """Write the meshes."""
    for name, (points, cells, temperature) in dies.items():
        group = file.create_group(f"{_GROUP}/{name}")
        group["points"], group["cells"] = points, cells
        n = len(temperature)
        group.create_dataset("temperature", (0, n), "f4", maxshape=(None, n), chunks=(1, n), **COMPRESSION)


def append_dies(file: h5py.File, dies: Dies) -> None:
    """Append the temperatures of a step."""
    for name, (_, _, temperature) in dies.items():
        append_rows(file[f"{_GROUP}/{name}"], "temperature", temperature[None, :])


def truncate_dies(file: h5py.File, n: int) -> None:
    """Keep the first n steps."""
    for group in file.get(_GROUP, {}).values():
        group["temperature"].resize(n, axis=0)


def read_dies(file: h5py.File, step: int) -> dict[str, tuple[FloatArray, IntArray, FloatArray]]:
    """Return the meshes and the temperatures of a step."""
    return {
        name: (group["points"][()], group["cells"][()], group["temperature"][step].astype(float))
        for name, group in file.get(_GROUP, {}).items()
    }
