# SPDX-License-Identifier: Apache-2.0
"""Heating and cooling without forming against closed solutions: NAFEMS T4; Carslaw & Jaeger (1959)."""

import numpy as np
import pytest

from presswork.case import build_model
from presswork.model import STEFAN_BOLTZMANN, ZERO_CELSIUS, FloatArray
from presswork.process.heat import HeatProcedure
from tests.problems.heat import (
    compute,
    cool_cylinder,
    cool_slab,
    fit_order,
    make_case,
    meet_half_spaces,
    radiate,
    temperature_at,
)


def solve_t4(cells: int, element: str = "quad4") -> float:
    """Return the temperature at (0.6, 0.2) m of NAFEMS T4 with 3 x 5 times `cells` squares cells."""
    film = {"coefficient": "750 W/(m^2*K)", "ambient": 0}
    case = make_case(
        initial_temperature=0,
        workpiece={
            "material": "steel",
            "element": element,
            "mesh": {"size": ["0.6 m", "1 m"], "cells": [3 * cells, 5 * cells]},
        },
        stages=[
            {
                "name": "steady",
                "duration": 1e9,
                "temperature": [{"set": "bottom", "value": 100}],
                "convection": [{"set": "right", **film}, {"set": "top", **film}],
            }
        ],
        solver={"fixed_step": 0.5},
    )
    return temperature_at(compute(case), 600, 200)


def test_nafems_t4() -> None:
    """Steady conduction with convection (NAFEMS 1990, T4): 18.3 degrees C; the series gives 18.2537."""
    errors = [solve_t4(n) - 18.2537 for n in (2, 4, 8, 16)]
    assert abs(errors[-1]) < 0.011
    assert fit_order([1, 0.5, 0.25, 0.125], np.abs(errors).tolist())[1:] == pytest.approx([2.0, 2.0], abs=0.06)


@pytest.mark.parametrize(
    ("element", "most"), [("tri3", 0.04), ("quad8", 1e-3), ("quad9", 2e-3), ("tri6_6pt", 2e-3), ("quad4_fbar", 0.05)]
)
def test_nafems_t4_on_other_cells(element, most) -> None:
    assert abs(solve_t4(8, element) - 18.2537) < most


SHEET = {"density": "7830 kg/m^3", "conductivity": "25 W/(m*K)", "specific_heat": "650 J/(kg*K)"}
DIES = {"coefficient": "2000 W/(m^2*K)", "ambient": 75}


def cool_sheet(cells: int, duration: float, start: float = 900.0, **solver) -> float:
    """Return the temperature in the middle of a sheet of 1.5 mm between dies."""
    case = make_case(
        materials={"steel": SHEET},
        initial_temperature=start,
        workpiece={"material": "steel", "mesh": {"size": [0.75, 0.1], "cells": [cells, 1]}},
        stages=[{"name": "dies", "duration": duration, "convection": [{"set": "right", **DIES}]}],
        solver=solver,
    )
    return temperature_at(compute(case), 0, 0)


@pytest.mark.parametrize(("time", "middle"), [(0.5, 719.39), (1.0, 573.44), (2.0, 373.22), (4.0, 181.76)])
def test_sheet_between_dies(time, middle) -> None:
    """Closed solution of a slab with a film on both sides; figures worked out independently of the program."""
    biot, fourier = 2.0 * 0.75 / 25.0, 25.0 / (7830e-12 * 650e6) * time / 0.75**2
    assert 75 + 825 * cool_slab(biot, fourier) == pytest.approx(middle, abs=0.006)
    assert cool_sheet(16, time) == pytest.approx(middle, abs=0.15)


@pytest.mark.parametrize("difference", [825.0, 50.0, 5.0])
@pytest.mark.parametrize("time", [0.5, 4.0, 20.0])
def test_defaults_err_by_less_than_a_thousandth_of_the_difference(difference, time) -> None:
    exact = 75 + difference * cool_slab(2.0 * 0.75 / 25.0, 25.0 / (7830e-12 * 650e6) * time / 0.75**2)
    assert cool_sheet(32, time, 75 + difference) == pytest.approx(exact, abs=1e-3 * difference)


def test_time_steps_are_of_second_order() -> None:
    """Each error is that beside a hundred steps more on the same cells."""
    exact = cool_sheet(32, 4.0, fixed_step=0.001)
    steps = [0.1, 0.05, 0.025, 0.0125]
    errors = [abs(cool_sheet(32, 4.0, fixed_step=step) - exact) for step in steps]
    assert fit_order(steps, errors) == pytest.approx([2.0, 2.0, 2.0], abs=0.1)


def test_steps_follow_the_tolerance() -> None:
    """Short steps while the sheet cools, long ones once it is cold; a quarter of the tolerance quarters the error."""
    exact = cool_sheet(32, 2.0, fixed_step=0.001)
    counts, errors = [], []
    for tolerance in (4.0, 1.0, 0.25):
        case = make_case(
            materials={"steel": SHEET},
            initial_temperature=900,
            workpiece={"material": "steel", "mesh": {"size": [0.75, 0.1], "cells": [32, 1]}},
            stages=[
                {"name": "first", "duration": 2.0, "convection": [{"set": "right", **DIES}]},
                {"name": "rest", "duration": 40.0, "convection": [{"set": "right", **DIES}]},
            ],
            solver={"tolerance": tolerance, "max_step": 1},
        )
        procedure = HeatProcedure(build_model(case), threads=1)
        reports = list(procedure.advance())
        rest = [report.time for report in reports if report.stage == "rest"]
        assert rest[-1] - rest[-2] > 10 * (rest[2] - rest[1])
        counts.append(len(reports))
        errors.append(abs(cool_sheet(32, 2.0, tolerance=tolerance, max_step=1) - exact))
    assert counts[0] < counts[1] < counts[2] < 200
    assert errors == pytest.approx([4 * errors[1], errors[1], 0.25 * errors[1]], rel=0.4)
    assert errors[1] < 0.1


def test_a_step_too_long_for_the_tolerance_overshoots_by_less_than_it() -> None:
    """The method has a small negative part for modes much faster than a step: a surface put into a cold bath."""
    case = make_case(
        initial_temperature=900,
        workpiece={"material": "steel", "mesh": {"size": [10, 1], "cells": [40, 1]}},
        stages=[
            {"name": "bath", "duration": 100.0, "convection": [{"set": "right", "coefficient": 50.0, "ambient": 20}]}
        ],
        solver={"initial_step": 0.05},
    )
    procedure = HeatProcedure(build_model(case), threads=1)
    coldest, cutbacks = 900.0, 0
    for report in procedure.advance():
        coldest, cutbacks = min(coldest, procedure.state["temperature"].min()), cutbacks + len(report.cutbacks)
    assert cutbacks > 0
    assert coldest > 20.0 - 1.0


def test_slab_on_ever_finer_cells_is_of_second_order() -> None:
    """At Biot 10 the profile is curved; the errors are those beside 96 cells with the same time steps."""

    def surface(cells: int, element: str = "quad4") -> float:
        case = make_case(
            initial_temperature=0,
            workpiece={
                "material": "steel",
                "element": element,
                "mesh": {"size": [10, 1], "cells": [cells, 1]},
            },
            stages=[
                {
                    "name": "heat",
                    "duration": 1.0,
                    "convection": [{"set": "right", "coefficient": 52.0, "ambient": 1000}],
                }
            ],
            solver={"fixed_step": 0.005},
        )
        return temperature_at(compute(case), 0, 0)

    fourier = 52.0 / (7850e-12 * 460e6) / 100.0
    exact = 1000 * (1 - cool_slab(10.0, fourier))
    fine = surface(96)
    assert fine == pytest.approx(exact, rel=0.01)
    errors = [abs(surface(n) - fine) for n in (4, 8, 16)]
    assert fit_order([1, 0.5, 0.25], errors) == pytest.approx([2.0, 2.0], abs=0.15)


@pytest.mark.parametrize("place", [0.0, 1.0])
def test_cylinder_in_a_bath(place) -> None:
    """Infinite cylinder: radius 20 mm, h 2 kW/m2K, 900 into 20 degrees C, after 10 s."""
    case = make_case(
        geometry="axisymmetric",
        initial_temperature=900,
        workpiece={"material": "steel", "mesh": {"size": [20, 1], "cells": [40, 1]}},
        stages=[{"name": "bath", "duration": 10, "convection": [{"set": "right", "coefficient": 2.0, "ambient": 20}]}],
    )
    fourier = 52.0 / (7850e-12 * 460e6) * 10 / 400.0
    exact = 20 + 880 * cool_cylinder(2.0 * 20 / 52.0, fourier, place)
    assert temperature_at(compute(case), 20 * place, 0) == pytest.approx(exact, abs=0.25)


def join_half_spaces(time: float, cells: int = 60, *, sides: str = "grid", **solver: float) -> HeatProcedure:
    """Return steel at 1200 on steel at 200 degrees C, 10 kW/m2K, after a time [s]; cells of each along its depth."""
    half = {"material": "steel", "mesh": {"zones_x": [[1, 2, 1]], "zones_y": [[60, cells, 0.003]]}}
    lower = {**half, "mesh": {"origin": [0, -60], "zones_x": [[1, 2, 1]], "zones_y": [[60, cells, 0.003]]}}
    upper = {"mesh": {"zones_x": [[1, 2 if sides == "grid" else 3, 1]], "zones_y": [[60, cells, 1 / 0.003]]}}
    case = make_case(
        materials={"steel": {"density": "7800 kg/m^3", "conductivity": "30 W/(m*K)", "specific_heat": "650 J/(kg*K)"}},
        workpiece={**half, **upper, "initial_temperature": 1200},
        bodies={"die": {**lower, "initial_temperature": 200}},
        contacts={"face": {"between": ["workpiece", "die"], "conductance": "10 kW/(m^2*K)"}},
        stages=[{"name": "touch", "duration": time}],
        solver=solver,
    )
    return compute(case)


def contact_temperature(done: HeatProcedure) -> FloatArray:
    return np.asarray(done.state["temperature"][done.model.mesh.node_sets["bottom"]])


@pytest.mark.parametrize("sides", ["grid", "finer"])
@pytest.mark.parametrize(
    ("time", "hot", "cold"), [(0.1, 1004.59, 395.41), (1.0, 851.37, 548.63), (10.0, 754.02, 645.98)]
)
def test_two_half_spaces_with_a_conductance(time, hot, cold, sides) -> None:
    """On cells that match across the contact or do not."""
    exact = meet_half_spaces(1200, 200, np.sqrt(30.0 * 7800e-12 * 650e6), 10.0, time)
    assert exact == pytest.approx(hot, abs=0.006)
    done = join_half_spaces(time, sides=sides)
    upper_side = contact_temperature(done)
    lower_side = done.state["temperature"][done.model.mesh.node_sets["die.top"]]
    assert upper_side == pytest.approx(hot, abs=0.3)
    assert lower_side == pytest.approx(cold, abs=0.3)
    assert np.ptp(upper_side) < 1e-6
    assert abs(done.stored()) < 1e-9 * 1000 * 60 * 7800e-12 * 650e6, "what one body loses the other gains"


def test_two_half_spaces_converge_with_the_square_of_cells_and_of_time_steps() -> None:
    exact = meet_half_spaces(1200, 200, np.sqrt(30.0 * 7800e-12 * 650e6), 10.0, 1.0)
    by_cells = [
        abs(contact_temperature(join_half_spaces(1.0, n, fixed_step=0.005)).mean() - exact) for n in (10, 20, 40)
    ]
    assert fit_order([1, 0.5, 0.25], by_cells) == pytest.approx([2.0, 2.0], abs=0.15)
    fine = contact_temperature(join_half_spaces(1.0, 40, fixed_step=0.00125)).mean()
    steps = [0.1, 0.05, 0.025]
    by_steps = [abs(contact_temperature(join_half_spaces(1.0, 40, fixed_step=step)).mean() - fine) for step in steps]
    assert fit_order(steps, by_steps) == pytest.approx([2.0, 2.0], abs=0.05)


def radiate_from_1000(**solver: float) -> float:
    """Return the temperature of a lumped plate of 1 mm when the closed form has 600 degrees C; surroundings of 20."""
    emissivity = 0.8
    rate = 2 * emissivity * STEFAN_BOLTZMANN / (7850e-12 * 460e6 * 1.0)
    time = radiate(1000 + ZERO_CELSIUS, 20 + ZERO_CELSIUS, rate)(600 + ZERO_CELSIUS)
    faces = [{"set": name, "emissivity": emissivity, "ambient": 20} for name in ("left", "right")]
    case = make_case(
        initial_temperature=1000,
        workpiece={"material": "steel", "mesh": {"size": [1, 1], "cells": [1, 1]}},
        stages=[{"name": "air", "duration": time, "radiation": faces}],
        solver=solver,
    )
    return temperature_at(compute(case), 0, 0)


def test_small_body_that_radiates() -> None:
    assert radiate_from_1000() == pytest.approx(600, abs=0.1)


def test_radiation_converges_with_the_square_of_the_time_steps() -> None:
    steps = [0.2, 0.1, 0.05]
    errors = [abs(radiate_from_1000(fixed_step=step) - 600) for step in steps]
    assert fit_order(steps, errors) == pytest.approx([2.0, 2.0], abs=0.05)


@pytest.mark.parametrize("element", ["tri3", "quad4", "quad4_1pt"])
def test_no_overshoot_however_short_the_step(element) -> None:
    """A consistent capacity falls below the cold side for steps under h^2 / (6 alpha); the lumped one does not."""
    diffusivity, h = 52.0 / (7850e-12 * 460e6), 1.0
    step = 1e-4 * h**2 / (6 * diffusivity)
    case = make_case(
        initial_temperature=0,
        workpiece={"material": "steel", "element": element, "mesh": {"size": [10, 1], "cells": [10, 1]}},
        stages=[{"name": "shock", "duration": 5 * step, "temperature": [{"set": "left", "value": 1000}]}],
        solver={"fixed_step": 0.2},
    )
    temperature = compute(case).state["temperature"]
    assert temperature.min() > -1e-9
    assert temperature.max() <= 1000.0


def test_hexahedra_agree_with_the_plane() -> None:
    film = {"coefficient": [[20, 1.0], [900, 5.0]], "ambient": 20}
    stages = [{"name": "air", "duration": 5, "convection": [{"set": "right", **film}, {"set": "top", **film}]}]
    materials = {"steel": {**SHEET, "conductivity": [[20, 50], [900, 25]]}}
    solver = {"fixed_step": 0.05}
    plane = compute(
        make_case(
            materials=materials,
            initial_temperature=900,
            workpiece={"material": "steel", "mesh": {"size": [10, 8], "cells": [5, 4]}},
            stages=stages,
            solver=solver,
        )
    )
    space = compute(
        make_case(
            geometry="solid",
            materials=materials,
            initial_temperature=900,
            workpiece={"material": "steel", "mesh": {"size": [10, 8, 3], "cells": [5, 4, 2]}},
            stages=stages,
            solver=solver,
        )
    )
    for place in ((0, 0), (10, 8), (4, 6)):
        for z in (0.0, 1.5, 3.0):
            assert temperature_at(space, *place, z) == pytest.approx(temperature_at(plane, *place), abs=1e-7)
    assert space.stored() == pytest.approx(3.0 * plane.stored(), rel=1e-10)


def test_heat_balances_with_tables_latent_heat_and_radiation() -> None:
    case = make_case(
        materials={
            "steel": {
                "density": "7850 kg/m^3",
                "conductivity": [[20, 53], [800, 27], [1200, 28]],
                "specific_heat": [[20, "440 J/(kg*K)"], [700, "900 J/(kg*K)"], [1200, "650 J/(kg*K)"]],
                "latent_heat": {"heat": "80 kJ/kg", "start": 700, "end": 760},
            }
        },
        initial_temperature=1100,
        geometry="axisymmetric",
        workpiece={"material": "steel", "mesh": {"size": [10, 20], "cells": [8, 16]}},
        stages=[
            {
                "name": "quench",
                "duration": 30,
                "convection": [{"set": "right", "coefficient": [[20, 1], [400, 8], [1000, 2]], "ambient": 20}],
                "radiation": [{"set": "top", "emissivity": 0.8, "ambient": [[0, 20], [30, 60]]}],
                "temperature": [{"set": "bottom", "value": [[0, 1100], [30, 300]]}],
            },
            {"name": "flame", "duration": 5, "flux": [{"set": "right", "value": "500 kW/m^2"}]},
        ],
        solver={"tolerance": 5.0},
    )
    done = compute(case)
    heat = done.state["heat"]
    assert (heat != 0).all()
    assert abs(done.stored() - heat.sum()) < 1e-8 * np.abs(heat).max()


def test_latent_heat_holds_the_temperature_back() -> None:
    """Even heating by a flux: the heat content says the temperature, through the transformation and beyond."""
    case = make_case(
        materials={**{"steel": {**SHEET, "latent_heat": {"heat": "65 kJ/kg", "start": 700, "end": 800}}}},
        initial_temperature=600,
        workpiece={"material": "steel", "mesh": {"size": [0.01, 1], "cells": [1, 1]}},
        stages=[{"name": "heat", "duration": 1.0, "flux": [{"set": "right", "value": 7830e-12 * 0.01 * 650e6 * 250}]}],
        solver={"fixed_step": 0.1},
    )
    # 250 K of specific heat: 100 to 700, then 100 + 100 latent to 800, and none left but 50 of those: 775
    assert temperature_at(compute(case), 0, 0) == pytest.approx(775.0, abs=0.002)
