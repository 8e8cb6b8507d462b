# SPDX-License-Identifier: Apache-2.0
"""A point of the material that the history follows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MarkedPoint:
    """A point of the material."""

    name: str
    place: tuple[float, ...]
    """Where it is when the run begins, as many coordinates as the mesh has [mm]."""
