# SPDX-License-Identifier: Apache-2.0
"""How often and how far metal flows outside the window that its flow stress was fitted in, where the law stays as at
the window's end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork.model import FEW_OUTSIDE, FloatArray, Material
from presswork.state import RUN, Arrays, OnNewMesh, State

QUANTITIES = ("strain", "rate", "temperature")
UNITS = ("", " 1/s", " degrees C")
FLOWS = 1e-6
"""Growth of the equivalent plastic strain in an increment from which metal flows; less is round-off and unloading."""


@dataclass
class LawWindow(Arrays):
    """What the materials went through where they flowed, since the start; laws without a window have nothing."""

    owner = "law_window"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(("flowed", "outside", "reached"), RUN)
    flowed: FloatArray
    """Points times increments in which they flowed (n_materials,)."""
    outside: FloatArray
    """Sums of these below and above the window, by QUANTITIES (n_materials, 3, 2)."""
    reached: FloatArray
    """Lowest and highest strain, rate [1/s] and temperature [degrees C] (n_materials, 3, 2)."""

    @classmethod
    def at_rest(cls, materials: Sequence[Material]) -> LawWindow:
        """Return that of materials that have not flowed."""
        n = len(materials)
        reached = np.tile([np.inf, -np.inf], (n, 3, 1))
        return cls(np.zeros(n), np.zeros((n, 3, 2)), reached)

    def note(
        self, number: int, material: Material, strain: FloatArray, grown: FloatArray, dt: float, temperature: FloatArray
    ) -> None:
        """Note the points that have flowed in an increment of dt [s].

        strain, grown: equivalent plastic strain at its end, and by how much it has grown (n,); temperature: (n,)
        [degrees C].
        """
        window, flows = None if material.hardening is None else material.hardening.window, grown > FLOWS
        if window is None or not flows.any():
            return
        self.flowed[number] += flows.sum()
        for k, found in enumerate((strain[flows], grown[flows] / dt, temperature[flows])):
            low, high = window[k]
            self.outside[number, k] += (found < low).sum(), (found > high).sum()
            ends = self.reached[number, k]
            ends[:] = min(ends[0], found.min()), max(ends[1], found.max())

    def summarise(self, materials: Sequence[Material]) -> dict[str, Any]:
        """Return windows, what was reached and the shares outside, by material and quantity."""
        windows: dict[str, Any] = {}
        for i, material in enumerate(materials):
            window = None if material.hardening is None else material.hardening.window
            if window is None or not self.flowed[i]:
                continue
            windows[material.name] = {
                name: {
                    "window": window[k].tolist(),
                    "reached": self.reached[i, k].tolist(),
                    "share_below": float(self.outside[i, k, 0] / self.flowed[i]),
                    "share_above": float(self.outside[i, k, 1] / self.flowed[i]),
                }
                for k, name in enumerate(QUANTITIES)
            }
        return {"law_windows": windows} if windows else {}

    def warnings(self, materials: Sequence[Material]) -> list[str]:
        """Warn of laws used beyond their windows by more than few points and increments.

        Below the smallest strain all are, since metal passes it as it yields.
        """
        found = []
        for i, material in enumerate(materials):
            window = None if material.hardening is None else material.hardening.window
            if window is None or not self.flowed[i]:
                continue
            for k, name in enumerate(QUANTITIES):
                for end, word in ((0, "down"), (1, "up")):
                    share = self.outside[i, k, end] / self.flowed[i]
                    if share < FEW_OUTSIDE or (name, end) == ("strain", 0):
                        continue
                    low, high = window[k]
                    found.append(
                        f"{material.name}: its law holds for a {name} from {low:g} to {high:g}{UNITS[k]}, and metal "
                        f"flowed {word} to {self.reached[i, k, end]:.4g}, {100 * share:.3g} % of points and increments "
                        "outside; there the flow stress was taken as at the end of the window"
                    )
        return found


def note_rates(
    block: int, number: int, material: Material, state_n: State, trial: State, dt: float, temperature: FloatArray
) -> None:
    """Fill the rates of plastic strain of a block after an increment over dt [s], and note what flowed.

    number: of the material; temperature: at the points (n,) [degrees C].
    """
    grown = trial.cells.eqps[block] - state_n.cells.eqps[block]
    trial.cells.rate[block] = grown / dt
    trial[LawWindow].note(number, material, trial.cells.eqps[block].ravel(), grown.ravel(), dt, temperature)
