# SPDX-License-Identifier: Apache-2.0
"""What an explicit run reports of its energies and of the mass added to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core

WORTH_A_WARNING = 5.0
"""Energy in per cent of the internal energy above which a warning reports it."""
FORMED = 0.1
"""Part of the last internal energy from which on kinetic energy is compared with it: a blank at rest has none."""
YIELD_OFFSET = 0.002
"""Plastic strain that defines the yield strength: a sheet that has so much on the mean is being formed."""
ENERGIES = ("kinetic", "internal", "hourglass", "contact", "friction", "damping", "external")
"""Terms of an EnergyBalance, in the order of history.csv."""


@dataclass(frozen=True)
class EnergyBalance:
    """Energies at one time [N mm]; those of work are counted from the start of the run.

    contact: held by the springs of contact and of beads, and given to the change of thickness by its pressure; of
    solids, lost by nodes that strike walls. friction: lost, in beads too.
    damping: lost to mass damping, in the dampers of contact and of pushed tools, and by the springs of contact where
    shells are split. kinetic: that of pushed tools too.
    error is what the balance of all of them has lost or won since the start, in per cent of the largest sum of energies
    that has occurred.
    """

    kinetic: float
    internal: float
    hourglass: float
    external: float
    damping: float
    error_percent: float
    contact: float = 0.0
    friction: float = 0.0

    def warnings(self, formed: float = 0.0) -> list[str]:
        """Return warnings: kinetic or hourglass energy above 5 % of the internal, an error above 5 %.

        formed: internal energy [N mm] from which on the first two are compared with it: a sheet at rest has none, so
        that in its first moments any motion is more.
        """
        found = []
        compared = self.internal if self.internal >= formed else np.inf
        kinetic, hourglass = (100 * e / max(compared, 1e-300) for e in (self.kinetic, self.hourglass))
        if kinetic > 5:
            found.append(
                f"kinetic energy is {kinetic:.3g} % of the internal: this is not quasi-static; drive the tools slower "
                "or add less mass"
            )
        if hourglass > 5:
            found.append(
                f"hourglass energy is {hourglass:.3g} % of the internal: refine the mesh where it is bent sharply, or "
                "spread point loads"
            )
        if abs(self.error_percent) > 5:
            found.append(f"the energy balance is off by {self.error_percent:.3g} %: shorten the time step")
        return found


def sum_energies(e: _core.Energies) -> float:
    """Return what stays as it is in an undisturbed run: all energies, less the work from outside [N mm]."""
    return e.kinetic + e.internal + e.hourglass + e.damping + e.contact + e.friction - e.external


def compute_balance(
    e: _core.Energies, reference: tuple[float, float] | None
) -> tuple[EnergyBalance, tuple[float, float]]:
    """Return the balance, and the reference brought up to date.

    reference: the sum at the start of the run and the largest energies so far [N mm]; None before the start.
    """
    start, largest = reference or (sum_energies(e), 0.0)
    largest = max(largest, abs(e.kinetic) + abs(e.internal) + abs(e.hourglass), abs(e.external))
    error = 100.0 * (sum_energies(e) - start) / largest if largest > 0 else 0.0
    balance = EnergyBalance(e.kinetic, e.internal, e.hourglass, e.external, e.damping, error, e.contact, e.friction)
    return balance, (start, largest)


@dataclass(frozen=True)
class MassScaling:
    """State of mass scaling: true mass [t], mass added so far [t], number of elements heavier than they are."""

    mass: float
    added: float
    n_elements: int

    @property
    def percent(self) -> float:
        """Added mass in per cent of the true mass."""
        return 100.0 * self.added / self.mass


ADVICE = {
    "kinetic": "inertia counts: make the tools slower, or add less mass",
    "hourglass": "refine the mesh where it is bent sharply",
    "damping": "set explicit.damping lower, or make the tools slower",
    "contact": "the sheet sinks into its tools: refine the blank from the start "
    "round the tools' radii, export tools from files with finer facets, or push less hard",
    "error": "set explicit.safety lower",
}
"""Warnings of a stamping: energies beyond their limits."""


def choose_advice(damping: float) -> dict[str, str]:
    """Return the advice for a stamping; damping: of mass, without which no key makes it less [1/s]."""
    undamped = "dampers of contact and of pushed tools take so much: make the tools slower, or push less hard"
    return ADVICE if damping > 0.0 else {**ADVICE, "damping": undamped}


def warn_of_energies(history: Mapping[str, NDArray[Any]], advice: Mapping[str, str] = ADVICE) -> list[str]:
    """Return which energies with advice have been beyond their limits since forming began."""
    internal = history["internal_energy"]
    if len(internal) == 0 or internal.max() <= 0:
        return []
    formed = internal >= FORMED * internal.max()
    warnings = []
    for name in (name for name in ("kinetic", "hourglass", "damping", "contact") if name in advice):
        share = 100.0 * np.abs(history[f"{name}_energy"][formed]) / internal[formed]
        worst = int(np.argmax(share))
        if share[worst] > WORTH_A_WARNING:
            at = history["time"][formed][worst]
            warnings.append(
                f"{name} energy reached {share[worst]:.3g} % of the internal (t = {at:.4g} s): {advice[name]}"
            )
    error = history["energy_error_percent"][formed]
    if np.abs(error).max() > WORTH_A_WARNING:
        largest = float(error[np.argmax(np.abs(error))])
        at = history["time"][formed][np.argmax(np.abs(np.diff(error, prepend=error[0])))]
        warnings.append(
            f"the energy balance is off by {largest:.3g} %, most of it at t = {at:.4g} s: {advice['error']}"
        )
    return warnings
