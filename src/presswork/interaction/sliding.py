# SPDX-License-Identifier: Apache-2.0
"""How fast, how far and how hot a workpiece slides on rigid tools, for friction that depends on it (law/friction.py).

The pressure acts at once. Speed, path and temperature are those at the start of an increment: a friction that falls
with the speed would otherwise have several answers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswork.law.friction import find_factor
from presswork.model import FloatArray, Tool
from presswork.state import SURFACE, Arrays, OnNewMesh, State


@dataclass
class SlidingArrays(Arrays):
    """Paths and speeds of nodes that tools may touch: the candidates in the plane, all nodes in space."""

    owner = "sliding"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"path": SURFACE, "speed": SURFACE}
    path: FloatArray
    """Slid on tools so far (n,) [mm]."""
    speed: FloatArray
    """Speed of sliding in the last increment (n,) [mm/s]."""


class Sliding:
    """What the friction of some tools must know of the surface of a workpiece."""

    def __init__(self, tools: Sequence[Tool], n_nodes: int) -> None:
        """n_nodes: that tools may touch."""
        self._factors = [tool.friction.factors for tool in tools]
        self._n_nodes = n_nodes
        given = [factors for factors in self._factors if factors is not None]
        self.is_needed = any(f.speed is not None or f.path is not None for f in given)
        self.needs_temperature = any(f.temperature is not None for f in given)

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of a surface that has not slid."""
        return (SlidingArrays(np.zeros(self._n_nodes), np.zeros(self._n_nodes)),) if self.is_needed else ()

    def find_factors(self, state: State, temperature: FloatArray | None) -> FloatArray:
        """Return what m and mu of each tool are multiplied by at the nodes (n_tools, n); pressures come later.

        temperature: at the nodes (n,) [degrees C], if a tool asks for it.
        """
        rest = np.zeros(self._n_nodes)
        path, speed = (state[SlidingArrays].path, state[SlidingArrays].speed) if self.is_needed else (rest, rest)
        found = [find_factor(factors, speed, path, temperature) for factors in self._factors]
        return np.array(found).reshape(len(self._factors), self._n_nodes)

    def advance(self, state_n: State, trial: State, slip: FloatArray, dt: float) -> None:
        """Take the slip of an increment of dt [s]: of each node where it touches a tool, else 0 (n,) [mm].

        One without time balances a new mesh, and counts for nothing.
        """
        if self.is_needed and dt > 0.0:
            trial[SlidingArrays].path = state_n[SlidingArrays].path + slip
            trial[SlidingArrays].speed = slip / dt
