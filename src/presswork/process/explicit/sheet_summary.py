# SPDX-License-Identifier: Apache-2.0
"""What the summary reports about an explicit stamping."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from presswork.explicit.energy import choose_advice, warn_of_energies
from presswork.process.explicit.intervals import last_energies
from presswork.process.held_flange import summarise_holders, warn_of_holders

if TYPE_CHECKING:
    from presswork.process.explicit.stamping import ExplicitStamping


def summarise_sheet(run: ExplicitStamping, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return counts, extremes and energies of a run, with warnings where they are beyond their limits."""
    shells, model = run.shells, run.model
    fields = run.show().sheet
    thickest = float(fields["thickness"].max())
    names = ("equivalent_plastic_strain", "effective_stress", "thickness", "thickness_strain")
    cycles = run.progress.cycles
    return {
        "increments": run.number,
        "cycles": cycles,
        "work": f"{cycles} cycles of {run.progress.shell_cycles / max(cycles, 1):.0f} shells",
        "freedoms": 6 * len(model.mesh.points),
        "extremes": {name: [float(fields[name].min()), float(fields[name].max())] for name in names},
        "mass": {"blank_t": run.blank_mass, "added_percent": run.added_mass},
        "energy": last_energies(history),
        "time_simulated": shells.time,
        **run.observers.summary(run, history),
        **(summarise_holders(model, history, thickest) if run.begins_flat else {}),
        "warnings": [
            *run.observers.warnings(run, history),
            *(warn_of_holders(model, history, thickest) if run.begins_flat else ()),
            *warn_of_energies(history, choose_advice(run.settings.damping)),
        ],
    }
