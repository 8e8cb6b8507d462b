# SPDX-License-Identifier: Apache-2.0
"""Mirror images that complete a picture of what symmetry planes cut off."""

from __future__ import annotations

from typing import Literal

Mirror = Literal["", "x", "y", "xy"]
"""Planes that the picture is mirrored by: the one normal to x, to y, or both; they pass through the origin."""

IMAGES: dict[Mirror, list[tuple[int, int]]] = {
    "": [(1, 1)],
    "x": [(1, 1), (-1, 1)],
    "y": [(1, 1), (1, -1)],
    "xy": [(1, 1), (-1, 1), (1, -1), (-1, -1)],
}
"""Factors on x and y of the original and its images."""
