# SPDX-License-Identifier: Apache-2.0
"""A direction in which the history follows the edge of a drawn sheet."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DrawInDirection:
    """A direction from the middle of a blank."""

    name: str
    angle: float
    """Angle from x [rad]."""
