# SPDX-License-Identifier: Apache-2.0
"""Arrays as text in a page: 16-bit numbers in a range, as differences of neighbours, bytes of a rank together.

They are deflated and written in base64. Neighbours in a mesh have values alike, so that most high bytes are zero and
deflate removes them. `page/unpack.js` reads what is written here.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

LEVELS = 65534
"""Steps between the smallest and the largest value; LEVELS + 1 stands for a value that is not finite."""
_DEFLATE = 3
"""Higher levels take several times as long and save a few per cent."""

Packed = dict[str, Any]
"""What the page needs to unpack an array: the block's number or text, how it is written, how many values it has."""


@dataclass
class Blocks:
    """Blocks of a page, in the order in which they were added."""

    texts: list[str] = field(default_factory=list)
    is_inline: bool = False
    """Whether a packed array has its text in itself, in place of the number of a block."""

    def add_values(self, values: NDArray[np.floating[Any]]) -> Packed:
        """Add values (n,) or (n, k), each column in 16 bits of its own range [lo, hi]; whole numbers stay whole."""
        columns = np.atleast_2d(np.asarray(values, dtype=np.float64).T)
        lows, highs, coded, is_whole = [], [], [], []
        for column in columns:
            finite = np.isfinite(column)
            inside = column[finite]
            low, high = (float(inside.min()), float(inside.max())) if len(inside) else (0.0, 0.0)
            scale = LEVELS / (high - low) if high > low else 0.0
            whole = np.full(len(column), LEVELS + 1, dtype=np.uint16)
            whole[finite] = np.rint((inside - low) * scale).astype(np.uint16)
            coded.append(whole)
            lows.append(low)
            highs.append(high)
            is_whole.append(high - low <= LEVELS and bool((inside == np.rint(inside)).all()))
        flat = np.concatenate(coded) if coded else np.zeros(0, dtype=np.uint16)
        number = self._add(_split_bytes(_difference(flat)))
        return {"block": number, "as": "range", "n": int(columns.shape[1]), "lo": lows, "hi": highs, "whole": is_whole}

    def add_numbers(self, values: NDArray[np.floating[Any]]) -> Packed:
        """Add values (n,) in single precision."""
        single = np.ascontiguousarray(values, dtype="<f4").view(np.uint32)
        return {"block": self._add(_split_bytes(single)), "as": "single", "n": len(single)}

    def add_indices(self, values: NDArray[np.integer[Any]]) -> Packed:
        """Add whole numbers of any shape, flat, from 0 to 2^31 - 1."""
        flat = np.ascontiguousarray(values, dtype=np.uint32).ravel()
        return {"block": self._add(_split_bytes(_difference(flat))), "as": "index", "n": len(flat)}

    def count_bytes(self) -> int:
        """Return how long all texts are."""
        return sum(len(text) for text in self.texts)

    def _add(self, data: bytes) -> int | str:
        text = base64.b64encode(zlib.compress(data, _DEFLATE)).decode("ascii")
        if self.is_inline:
            return text
        self.texts.append(text)
        return len(self.texts) - 1


def _difference(values: NDArray[Any]) -> NDArray[Any]:
    """Return differences of neighbours, modulo the type's range, small ones of either sign as small numbers."""
    signed = np.dtype(f"i{values.itemsize}")
    step = np.diff(values, prepend=values.dtype.type(0)).view(signed)
    return ((step << 1) ^ (step >> (8 * values.itemsize - 1))).view(values.dtype)


def _split_bytes(values: NDArray[Any]) -> bytes:
    """Return the lowest bytes of all values, then the next ones, and so on."""
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return little.view(np.uint8).reshape(-1, values.itemsize).T.tobytes()
