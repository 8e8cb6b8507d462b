# SPDX-License-Identifier: Apache-2.0
"""The example warm_extrusion against the first law: the steady product takes the ram's pressure with it as heat."""

from pathlib import Path

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.plane.schema import Case
from presswork.examples import copy_example
from presswork.results import Result
from tests.problems.warm_extrusion import find_enthalpy, find_exit_temperatures, find_pressure

INSULATED = (
    "tools.container.m=0",
    "tools.container.heat=",
    "tools.die.heat.conductance=0",
    "tools.die.heat.conductivity=0.001",
    "heat.surroundings=",
)
"""Tools that take no heat, nor a share of friction heat. Without friction the container leaves the billet as it was."""


def extrude(folder: Path, speed: str, *more: str) -> tuple[Case, Result]:
    """Run the example at a ram speed."""
    case = read_case(copy_example("warm_extrusion", folder), [f"stages.0.velocity={speed}", "output.steps=1", *more])
    outcome = run_model(build_model(case), folder / "out", threads=1)
    assert outcome.status == "completed", outcome.reason
    return case, outcome.result


@pytest.mark.validation
def test_without_losses_the_product_takes_the_pressure_with_it(tmp_path) -> None:
    """Work p A v comes in, heat A v rho c dT leaves: the mean of rho c dT over the product is p.

    What stood in the die at the start has left it long before: 15 mm of product need 8.4 mm of stroke.
    """
    case, result = extrude(tmp_path, "500 mm/s", *INSULATED)
    temperature, volume = find_exit_temperatures(result, 15)
    assert np.average(find_enthalpy(case, temperature), weights=volume) == pytest.approx(
        find_pressure(result), rel=0.02
    )
    assert temperature.max() > np.average(temperature, weights=volume) + 20  # friction of the die


@pytest.mark.validation
def test_a_slow_ram_leaves_a_cold_product(tmp_path) -> None:
    """At 5 mm/s the tools at 200 degrees C take more heat than forming makes, already after 10 mm."""
    _, result = extrude(tmp_path, "5 mm/s", "stages.0.tools.ram.stroke=10", "solver.max_increment=0.02")
    temperature, volume = find_exit_temperatures(result, 5)
    assert np.average(temperature, weights=volume) < 560
    assert result.history["heat_tools"][-1] < -2 * result.history["heat_plastic"][-1]
