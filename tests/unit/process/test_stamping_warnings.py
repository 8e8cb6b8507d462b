# SPDX-License-Identifier: Apache-2.0
"""What a stamping says of its energies at the end."""

import numpy as np
import pytest

from presswork.explicit.energy import ENERGIES, choose_advice, warn_of_energies

SHARE, BALANCE = 6.0, 30.0


def history(**changed: list[float]) -> dict[str, np.ndarray]:
    """Five rows; internal energy grows from next to nothing to 100 N mm."""
    rows = {f"{name}_energy": [0.0] * 5 for name in ENERGIES} | {"energy_error_percent": [0.0] * 5}
    rows |= {"time": [1.0, 2.0, 3.0, 4.0, 5.0], "internal_energy": [1e-3, 1.0, 20.0, 60.0, 100.0]}
    return {name: np.array(values) for name, values in (rows | changed).items()}


@pytest.mark.parametrize(
    ("column", "late", "said"),
    [
        ("kinetic_energy", SHARE, "kinetic energy reached 6 % of the internal (t = 5 s): inertia counts"),
        ("hourglass_energy", SHARE, "hourglass energy reached 6 % of the internal (t = 5 s): refine the mesh"),
        ("damping_energy", SHARE, "damping energy reached 6 % of the internal (t = 5 s): set explicit.damping lower"),
        (
            "contact_energy",
            SHARE,
            "contact energy reached 6 % of the internal (t = 5 s): the sheet sinks into its tools",
        ),
        (
            "contact_energy",
            -SHARE,
            "contact energy reached 6 % of the internal (t = 5 s): the sheet sinks into its tools",
        ),
        (
            "energy_error_percent",
            -BALANCE,
            "the energy balance is off by -30 %, most of it at t = 5 s: set explicit.safety lower",
        ),
    ],
)
def test_energies_out_of_hand_are_told_once_forming_is_under_way(column: str, late: float, said: str) -> None:
    (warning,) = warn_of_energies(history(**{column: [0.0, 0.0, 0.0, 0.0, late]}))
    assert warning.startswith(said)
    assert warn_of_energies(history(**{column: [late, late, 0.0, 0.0, 0.0]})) == [], "the first touch is all there is"


def test_damping_that_is_not_asked_for_is_not_to_be_set_lower() -> None:
    damped = history(damping_energy=[0.0, 0.0, 0.0, 0.0, 90.0])
    (asked,) = warn_of_energies(damped, choose_advice(10.0))
    (unasked,) = warn_of_energies(damped, choose_advice(0.0))
    assert "set explicit.damping lower" in asked
    assert "explicit.damping" not in unasked
    assert "make the tools slower" in unasked
