# SPDX-License-Identifier: Apache-2.0
"""Cases of solids by the explicit procedure: what they build, and what they refuse."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from presswork.case import Case, CaseError, build_model, describe
from presswork.model import ExplicitSolid, Heating, Model

BAR: dict[str, Any] = {
    "title": "bar on an anvil",
    "analysis": "axisymmetric",
    "procedure": "explicit",
    "workpiece": {"material": "steel", "element": "quad4_1pt", "velocity": [0, "-200 m/s"],
                  "mesh": {"size": [3, 30], "cells": [3, 30]}},
    "materials": {"steel": {"young": "207 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
                            "hardening": {"law": "linear", "yield_stress": 800, "modulus": 500},
                            "heating": {"melting": 1540, "exponent": 1.1, "heat_capacity": "460 J/(kg*K)"}}},
    "tools": {"anvil": {"profile": [[-1, 0], [20, 0]], "contact": "coulomb", "mu": 0.1}},
    "boundary": {"axis": {"set": "left", "fix": ["x"]}},
    "stages": [{"name": "impact", "duration": "50 us"}],
}  # fmt: skip


def build(**changes: Any) -> Model:
    """Build the bar with values changed: dots in a key are written as double underscores; None removes a key."""
    data = copy.deepcopy(BAR)
    for path, value in changes.items():
        *tables, key = path.split("__")
        table: Any = data
        for name in tables:
            table = table[int(name)] if isinstance(table, list) else table.setdefault(name, {})
        if value is None:
            del table[key]
        else:
            table[key] = value
    model = build_model(Case.model_validate(data))
    return model


def test_the_model_has_what_the_case_says() -> None:
    model = build(explicit={"target_step": "20 ns", "damping": 100}, output={"rows": 50, "steps": 5})
    assert model.explicit == ExplicitSolid((0.0, -2e5), pytest.approx(2e-8), 100.0)
    steel = model.materials[0]
    assert steel.density == pytest.approx(7.85e-9)
    assert steel.heating == Heating(melting=1540.0, exponent=1.1, heat_capacity=pytest.approx(4.6e8))
    assert (model.output.rows, model.output.steps) == (50, 5)
    assert build(materials__steel__heating__reference=100).materials[0].heating.start == 100.0


def test_motions_start_smoothly_within_a_tenth_of_the_stage_unless_it_says_otherwise() -> None:
    anvil = {"anvil": {"move": [0, -1]}}
    assert build().stages[0].ramp == pytest.approx(5e-6)
    assert build(stages__0__ramp="10 us").stages[0].ramp == pytest.approx(1e-5)
    assert build(stages__0__ramp=0).stages[0].ramp == 0.0
    moved = describe(build(stages__0__tools=anvil))
    assert moved.count('stage 1 "impact"') == 1
    assert "  5e-06 s to start and to stop" in moved
    blow = describe(build(stages__0__tools=anvil, stages__0__ramp=0))
    assert "  at full velocity from the first cycle on" in blow


def test_description_says_how_it_starts_and_how_long_it_takes() -> None:
    text = describe(build())
    assert "the workpiece starts at (0, -200000) mm/s, density 7.85e-09 t/mm3" in text
    assert "tool anvil stands still" in text
    assert "softens with temperature from 20 to 1540 degrees C, starts at 20, heated by 0.9 of its plastic work" in text
    # 1 mm cells, waves of 5.96 km/s
    assert "time steps: about 1.5e-07 s at first, cells that are flattened need shorter ones; so 3.3e+02 cycles" in text
    assert "about 2e-07 s at first, by adding mass" in describe(build(explicit__target_step=2e-7))
    assert "solver" not in text


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"workpiece__element": "quad4_fbar"}, ["workpiece.element", "no such element", "take tri3 or quad4_1pt"]),
        ({"materials__steel__density": None}, ["materials.steel.density", "missing key", "7850 kg/m^3"]),
        ({"materials__steel__density": 7850}, ["materials.steel.density", "7850 t/mm^3 is the density of no metal"]),
        ({"materials__steel__young": 207},
         ["materials.steel.young = 207", "that of no metal", "plain numbers are MPa"]),
        ({"workpiece__velocity": [0, -6e6]}, ["workpiece.velocity", "faster than sound", "5.14e+06", "plain numbers"]),
        ({"explicit__target_step": 1e-5}, ["explicit.target_step = 1e-05", "of 5e-05 s, has fewer than 20"]),
        ({"tools__anvil__contact": "shear", "tools__anvil__mu": None, "tools__anvil__m": 0.5},
         ["tools.anvil.contact", "no such law", "take frictionless, sticking or coulomb"]),
        ({"tools__anvil__mu": 3}, ["tools.anvil.mu", "expected a value <= 2"]),
        ({"tools__anvil__profile": [[-1, 0], {"to": [20, 0], "mu": 0.3}]},
         ["tools.anvil.profile.1.mu", "one coefficient of friction", "make it two tools"]),
        ({"tools__anvil__spring": {"stiffness": 1, "direction": [0, 1]}}, ["tools.anvil.spring", "rests on no spring"]),
        ({"stages__0__duration": None}, ["stages.0.duration", "missing key", "80 us"]),
        ({"stages__0__ramp": "30 us"}, ["stages.0.ramp", "do not fit into 5e-05 s", "take at most 2.5e-05 s"]),
        ({"stages__0__ramp": -1}, ["stages.0.ramp = -1", "expected a value >= 0"]),
        ({"stages__0__force": [{"set": "top", "value": [0, 1]}]}, ["stages.0.force", "no loads"]),
        ({"stages__0__pressure": [{"set": "top", "value": 1}]}, ["stages.0.pressure", "no loads"]),
        ({"stages__0__tools": {"anvil": {"force": 5, "direction": [0, 1]}}},
         ["stages.0.tools.anvil.force", "can be moved only"]),
        ({"stages__0__tools": {"anvil": {"turn": 5}}}, ["stages.0.tools.anvil.turn", "can be moved only"]),
        ({"solver": {"max_iterations": 5}}, ["solver.max_iterations", "is for the implicit procedure", "[explicit]"]),
        ({"output": {"every": 5}}, ["output.every", "is for the implicit procedure"]),
        ({"output": {"rows": 5, "steps": 10}}, ["output.steps", "no more than rows = 5"]),
        ({"contacts": {"own": {"between": ["workpiece", "workpiece"], "contact": "frictionless"}}, "remesh": {}},
         ["contacts", "does not go together with [remesh]", "leave out [remesh]"]),
        ({"bodies": {"other": {"material": "steel", "element": "tri3", "mesh": {"size": [1, 1], "cells": [1, 1],
                                                                                 "origin": [50, 0]}}}, "remesh": {}},
         ["bodies", "does not go together with [remesh]", "leave out [remesh]"]),
        ({"bodies": {"other": {"material": "steel", "element": "quad4_fbar",
                               "mesh": {"size": [1, 1], "cells": [1, 1], "origin": [50, 0]}}}},
         ["bodies.other.element", "the explicit procedure has no such element", "take tri3 or quad4_1pt"]),
        ({"workpiece__velocity": None}, ["stages.0", "moves nothing at all"]),
        ({"workpiece__velocity": [0, "5 kg"]}, ["workpiece.velocity", "a velocity"]),
        ({"explicit__hourglass_stiffness": 2}, ["explicit.hourglass_stiffness", "<= 1"]),
        ({"materials__steel__heating__heat_capacity": 460},
         ["materials.steel.heating.heat_capacity", "460 J/(kg*K)"]),
        ({"materials__steel__heating__melting": 10}, ["materials.steel.heating.melting", "not above reference = 20"]),
        ({"materials__steel__heating__start": 1600}, ["heating.start", "not from reference = 20 up to melting"]),
        ({"procedure": "implicit", "stages__0__tools": {"anvil": {"move": [0, 1]}}, "output": {"rows": 9},
          "stages__0__ramp": 1e-6},
         ["workpiece.velocity", "output.rows", "stages.0.ramp", "is for the explicit",
          'set procedure = "explicit"']),
        ({"procedure": "implict"}, ["procedure", "unknown choice", "did you mean `implicit`?"]),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_refused(changes: dict[str, Any], messages: list[str]) -> None:
    with pytest.raises(CaseError) as caught:
        build(**changes)
    for message in messages:
        assert message in str(caught.value)


def test_an_explicit_body_without_element_has_that_of_its_procedure() -> None:
    """The default of the implicit procedure is refused where it is named, and not taken where nothing is."""
    assert [block.element for block in build(workpiece__element=None).mesh.blocks] == ["quad4_1pt"]
    with pytest.raises(CaseError, match=r"workpiece\.element = \"quad4_fbar\": the explicit procedure"):
        build(workpiece__element="quad4_fbar")
