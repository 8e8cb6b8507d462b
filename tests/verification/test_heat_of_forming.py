# SPDX-License-Identifier: Apache-2.0
"""Heat in forming against closed solutions: adiabatic upsetting, softening by its own heat, a cold tool, friction."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.evolution.points import EvolvedArrays
from presswork.implicit.energy import Work
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.heat.chilled_tool import Column

ENTHALPY = 7833e-12 * 586e6
"""Of a unit of volume [N/(mm2 K)]."""


def upset(*, max_increment: float = 0.02, law: dict[str, Any] | None = None, **changes: Any) -> Case:
    """Return a cylinder of 10 x 15 mm to be upset by 60 % without friction, unless told otherwise."""
    steel = {
        "young": "200e3 GPa",  # rigid, so that plastic strain is strain
        "poisson": 0.3,
        "magnitudes": "any",
        "density": "7833 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
        "thermal": {"conductivity": 30, "specific_heat": "586 J/(kg*K)"},
        **(law or {}),
    }
    return Case.model_validate(
        {
            "title": "upsetting",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "mesh": {"size": [10, 15], "cells": [2, 3]}},
            "materials": {"steel": steel},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
            "tools": {"punch": {"profile": [[0, 15], [40, 15]], "contact": "frictionless"}},
            "heat": {"initial_temperature": 20},
            "stages": [{"name": "upset", "duration": 1, "tools": {"punch": {"stroke": 9, "direction": [0, -1]}}}],
            "solver": {"max_increment": max_increment},
            **changes,
        }
    )


def compute(**changes: Any) -> ImplicitProcedure:
    """Compute such a case to its end."""
    procedure = ImplicitProcedure(build_model(upset(**changes)), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def test_adiabatic_upsetting() -> None:
    """700 + 300 e to 60 %, nine tenths of the work, density 7833, specific heat 586: 150.45 K."""
    strain = np.log(1 / 0.4)
    closed = 0.9 * (700 * strain + 150 * strain**2) / ENTHALPY
    assert closed == pytest.approx(150.45, abs=0.03)
    rise = compute().state[HeatArrays].temperature - 20
    assert np.ptp(rise) < 1e-6
    assert rise.mean() == pytest.approx(closed, rel=1e-3)


@pytest.mark.parametrize("steps", [50, 100])
def test_a_law_softens_by_the_heat_that_it_makes(steps) -> None:
    """Perfectly plastic with a linear softening: 1 - T* falls by exp(-0.9 s0 e / (rho c (Tm - T0))); first order."""
    heating = {"melting": 520, "exponent": 1.0, "reference": 20}
    hardening = {"law": "linear", "yield_stress": 700, "modulus": 0}
    done = compute(max_increment=1 / steps, law={"heating": heating, "hardening": hardening})
    strain = np.log(1 / 0.4)
    closed = 500 * (1 - np.exp(-0.9 * 700 * strain / (ENTHALPY * 500)))
    rise = float((done.state[HeatArrays].temperature - 20).mean())
    assert abs(rise / closed - 1) < 0.2 / steps
    stress = done.mechanics.flow_stress(0, done.state)
    assert stress == pytest.approx(700 * (1 - rise / 500), rel=1e-9)


def test_increments_follow_the_change_of_temperature() -> None:
    """The same law, in increments that may be long: none changes a temperature by more than 1.5 times the limit."""
    heating = {"melting": 520, "exponent": 1.0, "reference": 20}
    law = {"heating": heating, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 0}}
    closed = 500 * (1 - np.exp(-0.9 * 700 * np.log(1 / 0.4) / (ENTHALPY * 500)))
    errors, counts = [], []
    for limit in (4.0, 2.0, 1.0):
        case = upset(max_increment=0.2, law=law, heat={"initial_temperature": 20, "max_change": limit})
        done = ImplicitProcedure(build_model(case), threads=1)
        rises = [0.0]
        for _ in done.advance():
            rises.append(float((done.state[HeatArrays].temperature - 20).mean()))
        assert np.diff(rises).max() < 1.5 * limit
        errors.append(abs(rises[-1] / closed - 1))
        counts.append(len(rises) - 1)
    assert counts[0] < counts[1] < counts[2] < 130
    assert errors[1] < 0.5 * errors[0], "first order; cut-backs of the law make the increments uneven"
    assert errors[2] < 0.5 * errors[1]


def test_a_cold_tool_cools_the_surface_of_a_half_space() -> None:
    """A workpiece at 1200 degrees C pressed softly onto a tool held at 200, 10 kW/m2K, after a second.

    Surface: T = T1 - dT (1 - exp(z^2) erfc z), z = h sqrt(t) / b (Carslaw & Jaeger 1959, 2.7).
    """
    from scipy.special import erfc

    done = compute(
        max_increment=0.005,
        law={
            "density": "7800 kg/m^3",
            "thermal": {"conductivity": 30, "specific_heat": "650 J/(kg*K)"},
            "young": "200 GPa",
        },
        analysis="plane_strain",
        workpiece={
            "material": "steel",
            "mesh": {"zones_x": [[1, 1, 1]], "zones_y": [[40, 40, 30]]},
        },
        boundary={"side": {"set": "left", "fix": ["x"]}, "top": {"set": "top", "fix": ["y"]}},
        tools={
            "die": {
                "profile": [[-5, 0], [6, 0]],
                "contact": "frictionless",
                "heat": {"temperature": 200, "conductance": "10 kW/(m^2*K)"},
            }
        },
        heat={"initial_temperature": 1200},
        stages=[{"name": "press", "duration": 1, "tools": {"die": {"stroke": 0.001, "direction": [0, 1]}}}],
    )
    z = 10.0 / np.sqrt(30 * 7800e-12 * 650e6)
    closed = 1200 - 1000 * (1 - np.exp(z**2) * erfc(z))
    surface = done.state[HeatArrays].temperature[done.model.mesh.node_sets["bottom"]]
    assert surface == pytest.approx(closed, abs=3.0)
    assert np.ptp(surface) < 1e-6
    assert done.heat is not None
    heat = done.state[HeatArrays].heat
    assert abs(done.heat.forming.stored(done.state[HeatArrays]) - heat.sum()) < 1e-8 * np.abs(heat).max()


def test_friction_heat_is_shared_by_effusivity_and_all_heat_balances() -> None:
    steel = {"conductivity": 120, "specific_heat": "586 J/(kg*K)", "density": "7833 kg/m^3"}
    punch = {
        "profile": [[0, 15], [40, 15]],
        "contact": "shear",
        "m": 0.5,
        "heat": {"temperature": 20, "conductance": [[0, 1.0], [1000, 8.0]], **steel},
    }
    done = compute(
        tools={"punch": punch},
        heat={
            "initial_temperature": 300,
            "plastic_fraction": 0.8,
            "surroundings": {"ambient": 20, "emissivity": 0.8, "coefficient": "20 W/(m^2*K)"},
        },
        stages=[{"name": "upset", "duration": 1, "tools": {"punch": {"stroke": 4, "direction": [0, -1]}}}],
    )
    plastic, friction, tools, convection, radiation, _ = done.state[HeatArrays].heat
    assert friction == pytest.approx(done.state[Work].friction_work / 3, rel=1e-9), (
        "1 : 2 with four times the conductivity"
    )
    assert plastic == pytest.approx(0.8 * done.state[Work].plastic_work, rel=1e-9)
    assert tools < 0 > convection
    assert radiation < 0
    assert done.heat is not None
    incoming = done.state[HeatArrays].heat
    assert abs(done.heat.forming.stored(done.state[HeatArrays]) - incoming.sum()) < 1e-8 * np.abs(incoming).max()


@pytest.mark.parametrize(("time", "hot"), [(0.1, 1004.59), (1.0, 851.37), (10.0, 754.02)])
def test_a_tool_that_warms_up_is_a_half_space(time, hot) -> None:
    """Steel at 1200 degrees C on steel at 200, 10 kW/m2K: the closed solution of two half-spaces."""
    steel = {"conductivity": 30, "specific_heat": "650 J/(kg*K)"}
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "warms_up": True, **steel, "density": "7800 kg/m^3"}
    done = compute(
        max_increment=0.005,
        law={"density": "7800 kg/m^3", "thermal": steel, "young": "200 GPa"},
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"zones_x": [[1, 1, 1]], "zones_y": [[60, 60, 300]]}},
        boundary={"side": {"set": "left", "fix": ["x"]}, "top": {"set": "top", "fix": ["y"]}},
        tools={"die": {"profile": [[-5, 0], [6, 0]], "contact": "frictionless", "heat": die}},
        heat={"initial_temperature": 1200},
        stages=[{"name": "press", "duration": time, "tools": {"die": {"stroke": 0.001, "direction": [0, 1]}}}],
    )
    nodes = done.model.mesh.node_sets["bottom"]
    arrays = done.state[HeatArrays]
    assert arrays.temperature[nodes] == pytest.approx(hot, abs=3.0)
    column = Column(30.0, 7800e-12 * 650e6, 0.005 * time)
    # the workpiece gets wider by its elastic strain, 4e-6
    gained = column.content(arrays.columns[0, nodes] - 200.0).mean() * 1.0
    assert gained == pytest.approx(-arrays.heat[2], rel=1e-5), "what the workpiece gives the tool has"
    assert done.heat is not None
    assert 200 < done.heat.forming.hottest(done.state[HeatArrays])["die"] < 1400 - hot


HALF_SPACE = {
    "density": "7800 kg/m^3",
    "thermal": {"conductivity": 30, "specific_heat": "650 J/(kg*K)"},
    "young": "200 GPa",
    "hardening": {"law": "linear", "yield_stress": 5000, "modulus": 0},
}


@pytest.mark.parametrize(
    ("time", "hot", "cold", "columns"), [(0.1, 1004.59, 395.41, 2), (1.0, 851.37, 548.63, 3), (10.0, 754.02, 645.98, 2)]
)
def test_two_bodies_pressed_together_exchange_heat(time, hot, cold, columns) -> None:
    """Deformable blocks at 1200 and 200 degrees C, 10 kW/m2K: two half-spaces, on meshes that match or do not."""
    upper = {"zones_x": [[1, columns, 1]], "zones_y": [[60, 60, 300]]}
    lower = {"origin": [0, -60], "zones_x": [[1, 2, 1]], "zones_y": [[60, 60, 1 / 300]]}
    done = compute(
        max_increment=0.005,
        law=HALF_SPACE,
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": upper},
        bodies={"lower": {"material": "steel", "mesh": lower, "initial_temperature": 200}},
        contacts={"face": {"between": ["workpiece", "lower"], "contact": "frictionless",
                           "heat": {"conductance": [[0, 0], [1e-6, "10 kW/(m^2*K)"]]}}},
        boundary={
            "side": {"set": "left", "fix": ["x"]},
            "lower side": {"set": "lower.left", "fix": ["x"]},
            "bottom": {"set": "lower.bottom", "fix": ["y"]},
        },
        tools={},
        heat={"initial_temperature": 1200},
        stages=[
            {"name": "press", "duration": time, "displacement": [{"set": "top", "component": "y", "value": -0.01}]},
        ],
    )  # fmt: skip
    temperature, sets = done.state[HeatArrays].temperature, done.model.mesh.node_sets
    assert temperature[sets["bottom"]] == pytest.approx(hot, abs=3.0)
    assert temperature[sets["lower.top"]] == pytest.approx(cold, abs=3.0)
    assert np.ptp(temperature[sets["bottom"]]) < 0.01
    assert done.heat is not None
    assert abs(done.heat.forming.stored(done.state[HeatArrays])) < 1e-8 * 60 * 7800e-12 * 650e6 * 1000, (
        "what one loses the other gains"
    )


WELL = {"conductivity": 1e5, "specific_heat": "650 J/(kg*K)"}
STEEL: dict[str, Any] = {"poisson": 0.3, "magnitudes": "any", "young": "200 GPa",
                         "hardening": {"law": "linear", "yield_stress": 5000, "modulus": 0}}  # fmt: skip


def test_friction_heats_a_half_space() -> None:
    """0.1 x 500 MPa at 0.1 m/s, half into each of two half-spaces of effusivity 12,333: +228.73 K after 1 s.

    Surface of a half-space under a constant flux q: 2 q sqrt(t / pi) / b (Carslaw & Jaeger 1959, 2.9).
    """
    thermal = {"conductivity": 30, "specific_heat": "650 J/(kg*K)"}
    heat = {"temperature": 20, "conductance": 0, **thermal, "density": "7800 kg/m^3"}
    modulus = 200e3 * 0.7 / (1.3 * 0.4)
    done = compute(
        max_increment=0.005,
        law=HALF_SPACE,
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"zones_x": [[80, 8, 1]], "zones_y": [[12, 60, 100]]}},
        boundary={"top": {"set": "top", "fix": ["x", "y"]}},
        tools={"die": {"profile": [[-200, 0], [200, 0]], "contact": "coulomb", "mu": 0.1, "heat": heat}},
        heat={"initial_temperature": 20},
        stages=[
            {"name": "press", "duration": 1e-6, "tools": {"die": {"move": [0, 500 / modulus * 12]}}},
            {"name": "slide", "duration": 1, "tools": {"die": {"move": [100, 0]}}},
        ],
    )
    effusivity = np.sqrt(30 * 7800e-12 * 650e6)
    assert 2 * 2500 / np.sqrt(np.pi) / effusivity == pytest.approx(228.73, abs=0.01)
    middle = np.argmin(np.linalg.norm(done.model.mesh.points - (40, 0), axis=1))
    beside = (done.model.mesh.blocks[0].connectivity == middle).any(axis=1)
    pressure = -done.state.cells.stress[0][beside, :, 1].mean()
    rise = done.state[HeatArrays].temperature[middle] - 20
    assert pressure == pytest.approx(500, rel=0.02)
    assert rise == pytest.approx(228.73 * pressure / 500, rel=5e-3)


def cool_beside(what: str, gap: float) -> float:
    """Return the temperature of a block of 4 x 1 mm that conducts well, above something at 20 degrees C, after 1 s.

    The gap between them is 0.05 mm; air at 20 degrees C takes 1 kW/m2K from what is free.
    """
    passes = {"conductance": "4 kW/(m^2*K)", "gap": gap}
    below: dict[str, Any] = {"tools": {"die": {"profile": [[-5, -0.05], [9, -0.05]], "contact": "frictionless",
                                               "heat": {"temperature": 20, **passes}}}}  # fmt: skip
    held = {"side": {"set": "left", "fix": ["x"]}, "corner": {"set": "bottom_left", "fix": ["y"]}}
    if what == "body":
        massive = {"density": 9e-7, "thermal": {"conductivity": 1e5, "specific_heat": "9000 J/(kg*K)"}}
        below = {
            "bodies": {"die": {"material": "massive", "initial_temperature": 20,
                               "mesh": {"origin": [-5, -10.05], "size": [14, 10], "cells": [7, 5]}}},
            "contacts": {"face": {"between": ["workpiece", "die"], "contact": "frictionless", "heat": passes}},
            "materials": {"steel": {**STEEL, **HALF_SPACE, "thermal": WELL}, "massive": {**STEEL, **massive}},
            "tools": {},
        }  # fmt: skip
        held |= {"die": {"set": "die.bottom", "fix": ["x", "y"]}}
    done = compute(
        max_increment=0.01,
        law={**HALF_SPACE, "thermal": WELL},
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"size": [4, 1], "cells": [8, 2]}},
        boundary=held,
        heat={"initial_temperature": 500, "surroundings": {"ambient": 20, "coefficient": "1 kW/(m^2*K)"}},
        stages=[{"name": "dwell", "duration": 1}],
        **below,
    )
    return float(done.state[HeatArrays].temperature[: 9 * 3].mean())


@pytest.mark.parametrize("what", ["tool", "body"])
@pytest.mark.parametrize(("gap", "coefficient"), [(0.0, 1.0), (0.1, 0.5 * 4 + 0.5 * 1.0), (0.2, 0.75 * 4 + 0.25)])
def test_heat_passes_a_gap(what, gap, coefficient) -> None:
    """Half the gap: half the conductance, and air takes from the other half of the surface alone; lumped cooling."""
    rate = (coefficient * 4 + 1.0 * (4 + 1)) / (4 * 7800e-12 * 650e6)
    assert cool_beside(what, gap) - 20 == pytest.approx(480 * np.exp(-rate), rel=6e-3)


@pytest.mark.parametrize(
    ("time", "hot", "cold"),
    [
        pytest.param(0.1, 1004.59, 395.41, marks=pytest.mark.validation),
        (1.0, 851.37, 548.63),
        pytest.param(10.0, 754.02, 645.98, marks=pytest.mark.validation),
    ],
)
def test_a_meshed_die_is_a_half_space(time, hot, cold) -> None:
    """Steel at 1200 degrees C on a die at 200 with a mesh of its own, 10 kW/m2K: two half-spaces; all heat balances.

    The die stands still in the first stage and rises in the second, with the workpiece: its mesh goes along.
    """
    steel = {"conductivity": 30, "specific_heat": "650 J/(kg*K)", "density": "7800 kg/m^3"}
    size, depth = 0.06 * np.sqrt(time), 8 * np.sqrt(time)
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "mesh": {"size": size, "depth": depth}, **steel}
    width = 30 * size
    done = compute(
        max_increment=0.005,
        law=HALF_SPACE,
        analysis="plane_strain",
        workpiece={"material": "steel", "mesh": {"zones_x": [[width, 20, 1]], "zones_y": [[60, 60, 300]]}},
        boundary={"side": {"set": "left", "fix": ["x"]}},
        tools={"die": {"profile": [[0, 0], [width * 1.001, 0]], "contact": "frictionless", "heat": die}},
        heat={"initial_temperature": 1200, "tolerance": 0.5},
        stages=[
            {"name": name, "duration": 0.5 * time, "tools": {"die": {"move": [0, rise]}},
             "displacement": [{"set": "top", "component": "y", "value": rise - press}]}
            for name, rise, press in (("press", 0, 1e-3), ("rise", 1, 0))
        ],
    )  # fmt: skip
    arrays = done.state[HeatArrays]
    assert arrays.temperature[done.model.mesh.node_sets["bottom"]] == pytest.approx(hot, abs=3.0)
    assert done.heat is not None
    (face,) = done.heat.forming.dies.dies
    profile = np.unique(face.profile) - face.nodes.start
    assert arrays.dies[profile] == pytest.approx(cold, abs=3.0)
    gained, lost = (
        done.heat.forming.stored_in_dies(done.state[HeatArrays]),
        done.heat.forming.stored(done.state[HeatArrays]),
    )
    assert gained == pytest.approx(-lost, rel=1e-8)
    assert arrays.die_heat[1] == pytest.approx(-arrays.heat[2], rel=1e-9)
    assert abs(gained - arrays.die_heat.sum()) < 1e-8 * gained


def test_phases_follow_the_temperatures_of_a_solid() -> None:
    """A cylinder that is cooled: martensite by Koistinen and Marburger at its temperature, hardness by Maynier."""
    heat = {"temperature": 20, "conductance": "5 kW/(m^2*K)"}
    punch = {"profile": [[0, 15], [40, 15]], "contact": "frictionless", "heat": heat}
    done = compute(
        law={"transformation": {"steel": "22MnB5"}, "thermal": {"conductivity": 300, "specific_heat": "586 J/(kg*K)"}},
        tools={"punch": punch},
        heat={"initial_temperature": 900, "surroundings": {"ambient": 20, "coefficient": "2000 W/(m^2*K)"}},
        stages=[{"name": "press", "duration": 40, "tools": {"punch": {"stroke": 0.1, "direction": [0, -1]}}}],
        max_increment=0.002,
    )
    values = done.state[EvolvedArrays].values
    warm = done.heat.at_points(done.state, 0)
    assert warm.max() < 300.0
    diffused = sum(values[name][0] for name in ("ferrite", "pearlite", "bainite"))
    wanted = (1.0 - diffused) * (1.0 - np.exp(-0.011 * (408.98 - warm)))
    assert values["martensite"][0] == pytest.approx(wanted, abs=1e-4)
    assert values["martensite"][0].min() > 0.5
    assert values["cooling_rate"][0].min() > 20.0
    assert 350 < values["hardness"][0].min() < values["hardness"][0].max() < 500


@pytest.mark.parametrize("steps", [200, 400])
def test_martensite_slows_the_cooling_of_a_solid(steps: int) -> None:
    """Even temperature: dt = (c + L a exp(-a (Ms - T))) rho V / (h A (T - Ta)) dT, to first order."""
    start, rate, latent, h, ambient, radius, height = 410.0, 0.011, 81.5e9, 2.0, 20.0, 10.0, 15.0
    done = compute(
        law={
            "transformation": {"ms": start},
            "thermal": {"conductivity": 1e5, "specific_heat": "586 J/(kg*K)"},
        },
        tools={},
        heat={"initial_temperature": 500, "tolerance": 0.005, "surroundings": {"ambient": 20, "coefficient": h}},
        stages=[{"name": "cool", "duration": 12}],
        max_increment=1 / steps,
    )
    arrays = done.state[HeatArrays]
    assert np.ptp(arrays.temperature) < 0.1
    end = float(arrays.temperature.mean())
    assert 100.0 < end < 300.0, "far into the transformation"
    degrees = np.linspace(end, 500.0, 200_001)
    below = np.maximum(start - degrees, 0.0)
    capacity = 586e6 + np.where(below > 0.0, latent * rate * np.exp(-rate * below), 0.0)
    area, volume = 2 * np.pi * radius * height + np.pi * radius**2, np.pi * radius**2 * height
    time = np.trapezoid(capacity * 7833e-12 * volume / (h * area * (degrees - ambient)), degrees)
    assert abs(time / 12.0 - 1.0) < 0.6 / steps
    martensite = 1.0 - np.exp(-rate * (start - end))
    set_free = float(arrays.heat[5])
    assert set_free == pytest.approx(martensite * latent * 7833e-12 * volume, rel=1e-3)
    stored = done.heat.forming.stored(arrays)
    assert abs(stored - arrays.heat.sum()) < 1e-8 * abs(stored)


def test_bainite_warms_a_solid_that_loses_no_heat() -> None:
    """c (T - T0) = L X."""
    case = upset(
        law={"transformation": {"steel": "22MnB5"}},
        tools={},
        heat={"initial_temperature": 900},
        stages=[{"name": "hold", "duration": 20}],
        max_increment=0.01,
    )
    model = build_model(case)
    assert model.heat is not None
    procedure = ImplicitProcedure(replace(model, heat=replace(model.heat, initial=(500.0,))), threads=1)
    for _ in procedure.advance():
        pass
    arrays = procedure.state[HeatArrays]
    formed = arrays.phases.sum(axis=1)
    assert formed.min() > 0.3
    assert arrays.phases[:, 2] == pytest.approx(formed)
    assert arrays.temperature - 500.0 == pytest.approx(formed * 75.2e9 / 586e6, rel=1e-6)
    assert procedure.heat is not None
    assert procedure.heat.forming.stored(arrays) == pytest.approx(float(arrays.heat[5]), rel=1e-8)


def test_latent_heat_is_not_counted_twice() -> None:
    twice = {
        "conductivity": 30,
        "specific_heat": "586 J/(kg*K)",
        "latent_heat": {"heat": "77 kJ/kg", "start": 690, "end": 780},
    }
    with pytest.raises(CaseError, match="the transformation has a latent heat, too"):
        build_model(
            upset(law={"transformation": {"steel": "22MnB5"}, "thermal": twice}, heat={"initial_temperature": 900})
        )
