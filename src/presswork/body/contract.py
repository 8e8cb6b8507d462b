# SPDX-License-Identifier: Apache-2.0
"""The contract of a body: what procedures and interactions require of the cells of a model."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from presswork.model import FloatArray, IntArray
from presswork.state import State

Near = tuple[FloatArray, FloatArray]
"""Gap of nodes to a tool (n_points,), infinite beyond a reach [mm], and its normal there (n_points, 3)."""
Look = tuple[Callable[[FloatArray, float], Near], float]
"""What finds that at places (n, 3) within a reach, and the reach [mm]."""


class Cells(Protocol):
    """The cells of a model, as interactions see them."""

    def nodal_flow_stress(self, state: State) -> FloatArray:
        """Return the mean flow stress of the cells round each node (n_points,) [MPa]."""

    def nodal_temperature(self, state: State) -> FloatArray | None:
        """Return the mean temperature of the cells round each node (n_points,) [degrees C]; None: it is not known."""

    def couple(self, couplings: IntArray) -> None:
        """Let the matrix hold these node pairs (n, 2) beside those of the cells."""
