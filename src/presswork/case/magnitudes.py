# SPDX-License-Identifier: Apache-2.0
"""Stiffness and strength that no metal has: nearly always a unit taken for another. One place for all procedures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from presswork.case.units import fault
from presswork.model import FloatArray

Magnitudes = Literal["metal", "any"]
DESCRIPTION = (
    "metal: stiffness and strength that no metal has are refused, since they are errors of units; any: they are taken "
    "as they are, for academic problems in any one system of units"
)

SOFTEST, STIFFEST = 1e3, 2e6
"""Young's moduli of no metal [MPa]: a sixteenth of lead's, five times osmium's."""
WEAKEST, STRONGEST = 1e-5, 0.1
"""Flow stress over Young's modulus: lead creeps at 1e-4; a tenth is about the strength of a crystal without defects."""
EARLY, LATE = 0.002, 1.0
"""Plastic strains at which the flow stress is judged; late, beyond all tables, only against Young's modulus itself."""
_ANYWAY = 'or set magnitudes = "any" in this table, and it is taken as it is'


def require_metal(young: float, flow_stress: Callable[[FloatArray], FloatArray] | None) -> None:
    """Refuse a Young's modulus or a hardening law that no metal has, as validators do.

    young [MPa]. flow_stress: of equivalent plastic strains (n,), in MPa; None: of an elastic material.
    """
    if not SOFTEST < young < STIFFEST:
        raise fault(
            f"Young's modulus is {young:g} MPa, that of no metal",
            f'plain numbers are MPa; give it a unit, for instance "206 GPa", {_ANYWAY}',
            key="young",
        )
    if flow_stress is None:
        return
    early, late = (float(value) for value in flow_stress(np.array([EARLY, LATE])))
    if not WEAKEST * young < early < STRONGEST * young:
        raise fault(
            f"the flow stress at a plastic strain of {EARLY:g} is {early:.4g} MPa, {early / young:.1e} "
            "of Young's modulus",
            f"metals have 0.0005 to 0.02; plain numbers are MPa, {_ANYWAY}",
            key="hardening",
        )
    if not late < young:
        raise fault(
            f"the flow stress at a plastic strain of {LATE:g} is {late:.4g} MPa, more than Young's modulus",
            f"plain numbers are MPa; the last slope of a table goes on, {_ANYWAY}",
            key="hardening",
        )
