# SPDX-License-Identifier: Apache-2.0
"""Compression of numbers for HDF5's filters shuffle and gzip, at a third of their time.

Shuffled, the first bytes of all numbers come first, then the second ones, and so on: a plane each. In the low planes of
computed numbers nearly every byte is as likely as any other. Such planes are stored as they are; the others are
compressed. Any inflater reads the stream (RFC 1950, 1951), which is as long as one that was compressed throughout.
"""

from __future__ import annotations

import zlib
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

NOISE = 7.5
"""Bits a byte of information above which a plane is stored."""
_SAMPLE = 8
"""One of so many bytes is counted."""
_LEVEL = 1
_LARGEST_STORED = 65535


def deflate(values: NDArray[np.generic]) -> bytes:
    """Return the numbers as one chunk of a dataset with HDF5's filters shuffle and gzip."""
    planes = np.ascontiguousarray(values).reshape(-1).view(np.uint8).reshape(-1, values.dtype.itemsize).T
    shuffled = np.ascontiguousarray(planes)
    parts = [
        _store(part) if noise else _compress(part)
        for noise, of_kind in groupby(shuffled, _is_noise)
        for part in [np.concatenate(list(of_kind))]
    ]
    end = b"\x03\x00"  # an empty last block
    return b"".join([b"\x78\x01", *parts, end, zlib.adler32(shuffled.data).to_bytes(4, "big")])


def _is_noise(plane: NDArray[np.uint8]) -> bool:
    counts = np.bincount(plane[::_SAMPLE])
    share = counts[counts > 0] / counts.sum()
    return bool(-(share * np.log2(share)).sum() > NOISE)


def _store(planes: NDArray[np.uint8]) -> bytes:
    parts = []
    for first in range(0, len(planes), _LARGEST_STORED):
        part = planes[first : first + _LARGEST_STORED].tobytes()
        size = len(part)
        parts += [b"\x00", size.to_bytes(2, "little"), (size ^ 0xFFFF).to_bytes(2, "little"), part]
    return b"".join(parts)


def _compress(planes: NDArray[np.uint8]) -> bytes:
    stream = zlib.compressobj(_LEVEL, wbits=-zlib.MAX_WBITS)
    return stream.compress(planes.data) + stream.flush(zlib.Z_SYNC_FLUSH)
