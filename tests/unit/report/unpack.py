# SPDX-License-Identifier: Apache-2.0
"""Reads a page's blocks back as page/unpack.js does."""

from __future__ import annotations

import base64
import zlib

import numpy as np
from numpy.typing import NDArray

from presswork.report.pack import LEVELS, Packed


def unpack(packed: Packed, texts: list[str]) -> NDArray[np.generic]:
    """Return the array (n, k) of a range, or (n,) of numbers and indices."""
    data = np.frombuffer(zlib.decompress(base64.b64decode(texts[packed["block"]])), dtype=np.uint8)
    size = 2 if packed["as"] == "range" else 4
    whole = np.zeros(len(data) // size, dtype=f"u{size}")
    for rank, part in enumerate(data.reshape(size, -1)):
        whole |= part.astype(whole.dtype) << np.array(8 * rank, dtype=whole.dtype)
    if packed["as"] == "single":
        return whole.view(np.float32)
    steps = (whole >> 1).astype(np.int64) ^ -(whole & 1).astype(np.int64)
    values = np.cumsum(steps) % (1 << (8 * size))
    if packed["as"] == "index":
        return values
    low, high = np.array(packed["lo"])[:, None], np.array(packed["hi"])[:, None]
    coded = values.reshape(len(packed["lo"]), -1)
    values = low + coded * (high - low) / LEVELS
    values = np.where(np.array(packed["whole"])[:, None], np.rint(values), values)
    return np.where(coded > LEVELS, np.nan, values).T
