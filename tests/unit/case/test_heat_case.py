# SPDX-License-Identifier: Apache-2.0
"""Cases of heat alone: what is taken, and what is refused with file, key, value and remedy."""

from copy import deepcopy
from typing import Any

import pytest

from presswork.case import CaseError, build_model
from presswork.case.description import describe
from presswork.case.heat.quantities import to_temperature
from presswork.case.heat.schema import HeatCase
from presswork.case.plane.schema import Case

CASE: dict[str, Any] = {
    "title": "heat",
    "analysis": "heat",
    "geometry": "plane",
    "initial_temperature": "1473.15 K",
    "workpiece": {"material": "steel", "mesh": {"size": [10, 10], "cells": [2, 2]}},
    "materials": {"steel": {"density": "7850 kg/m^3", "conductivity": 30, "specific_heat": "650 J/(kg*K)"}},
    "stages": [{"name": "air", "duration": 10, "convection": [{"set": "right", "coefficient": 0.1, "ambient": 20}]}],
}


def change(key: str, value: object, case: dict[str, Any] | None = None) -> dict[str, Any]:
    """Return the case, that of heat alone by default, with one key set, or removed by None."""
    data = deepcopy(CASE if case is None else case)
    here: Any = data
    *path, last = key.split(".")
    for name in path:
        here = here[int(name)] if isinstance(here, list) else here.setdefault(name, {})
    if value is None:
        del here[last]
    else:
        here[last] = value
    return data


def test_units_and_tables_are_taken() -> None:
    data = change("materials.steel.conductivity", [[20, "53 W/(m*K)"], ["1073.15 K", 27]])
    data["stages"][0]["convection"][0]["coefficient"] = "100 W/(m^2*K)"
    built = build_model(HeatCase.model_validate(data))
    assert built.heat is not None
    assert built.heat.initial == (pytest.approx(1200.0),)
    thermal = built.materials[0].thermal
    assert thermal is not None
    assert thermal.conductivity.tolist() == [[20, 53], [pytest.approx(800), 27]]
    assert thermal.specific_heat.tolist() == [[0, 650e6]]
    assert thermal.density == pytest.approx(7.85e-9)
    assert built.stages[0].heat is not None
    assert built.stages[0].heat.convections[0].coefficient.tolist() == [[0, 0.1]]
    assert built.freedoms == 1


def test_kelvin_and_celsius() -> None:
    assert to_temperature("1200 °C") == to_temperature("1200 degC") == to_temperature(1200) == 1200.0
    assert to_temperature("300 K") == pytest.approx(26.85)


BAD = [
    ("initial_temperature", "20 K", "initial_temperature", "-253.15 degrees C is a temperature of no forming"),
    ("initial_temperature", "1200 F", "initial_temperature", "expected a temperature"),
    ("initial_temperature", 12000, "initial_temperature", "12000 degrees C is a temperature of no forming"),
    ("materials.steel.specific_heat", 650, "materials.steel.specific_heat", "> 1e+06 mm^2/(s^2*K)"),
    ("materials.steel.conductivity", -3, "materials.steel.conductivity", "> 0 N/(s*K)"),
    ("materials.steel.conductivity", [[800, 27], [20, 53]], "materials.steel.conductivity", "does not increase"),
    ("materials.steel.conductivity", [], "materials.steel.conductivity", "from 1 to 1000 rows"),
    ("materials.steel.density", 7850, "materials.steel.density", "density of no metal"),
    ("materials.steel.latent_heat", {"heat": 1e10, "start": 760, "end": 700}, "latent_heat.end", "not above start"),
    ("stages.0.convection.0.coefficient", -1, "coefficient", "is not negative"),
    ("stages.0.convection.0.set", "rigth", "stages.0.convection.0.set", "no such edge set"),
    ("stages.0.temperature", [{"set": "nowhere", "value": 3}], "stages.0.temperature.0.set", "no such node set"),
    ("stages.0.radiation", [{"set": "top", "emissivity": 1.2, "ambient": 20}], "emissivity", "<= 1"),
    ("stages.0.convection", None, "stages.0", "nothing heats or cools the body"),
    ("stages.0.duration", 0, "stages.0.duration", "> 0"),
    ("workpiece.material", "stele", "workpiece.material", "no such material"),
    ("workpiece.element", "hex8", "workpiece.element", "no element of geometry = plane"),
    ("workpiece.element", "tri3x", 'workpiece.element = "tri3x"', "did you mean `tri3`"),
    ("workpiece.mesh", {"size": [1, 1, 1], "cells": [1, 1, 1]}, "workpiece.mesh", "a box does not go with"),
    ("workpiece.mesh.origin", [-5, 0], "workpiece.mesh", "beyond the axis"),
    ("geometry", "solid", "workpiece.mesh", "a rectangle does not go with"),
    ("depth", -1, "depth", "> 0"),
    ("output", {"rows": 3}, "output.rows", "a row a time step"),
    ("tools", {"punch": {}}, "tools", "unknown key"),
]


@pytest.mark.parametrize(("key", "value", "where", "what"), BAD)
def test_bad_input_is_told_by_key_value_and_remedy(key, value, where, what) -> None:
    data = change(key, value)
    if key == "workpiece.mesh.origin":
        data["geometry"] = "axisymmetric"
    with pytest.raises(CaseError) as caught:
        build_model(HeatCase.model_validate(data))
    assert where in str(caught.value)
    assert what in str(caught.value)


def with_die(**die: Any) -> dict[str, Any]:
    data = deepcopy(CASE)
    data["bodies"] = {
        "die": {"material": "steel", "mesh": {"origin": [0, -5], "size": [10, 5], "cells": [3, 2]}, **die}
    }
    data["contacts"] = {"face": {"between": ["workpiece", "die"], "conductance": 5.0}}
    return data


def test_contacts_of_bodies() -> None:
    built = build_model(HeatCase.model_validate(with_die(initial_temperature=150)))
    assert built.heat is not None
    assert built.heat.initial == (pytest.approx(1200.0), 150.0)
    apart = with_die(mesh={"origin": [0, -6], "size": [10, 5], "cells": [3, 2]})
    with pytest.raises(CaseError, match="do not lie on each other"):
        build_model(HeatCase.model_validate(apart))
    within = with_die(mesh={"origin": [2, 0], "size": [5, 5], "cells": [3, 2]})
    with pytest.raises(CaseError, match="do not lie on each other"):
        build_model(HeatCase.model_validate(within))
    alone = with_die()
    del alone["contacts"]
    with pytest.raises(CaseError, match="no heat would reach it"):
        build_model(HeatCase.model_validate(alone))
    quadratic = with_die(element="quad8")
    quadratic["workpiece"]["element"] = "quad8"
    with pytest.raises(CaseError, match="straight edges of two nodes"):
        build_model(HeatCase.model_validate(quadratic))


FORMING: dict[str, Any] = {
    "title": "hot",
    "analysis": "axisymmetric",
    "workpiece": {"material": "steel", "mesh": {"size": [10, 10], "cells": [2, 2]}},
    "materials": {
        "steel": {
            "young": 100e3,
            "poisson": 0.3,
            "density": "7850 kg/m^3",
            "hardening": {"law": "linear", "yield_stress": 100},
            "thermal": {"conductivity": 30, "specific_heat": "650 J/(kg*K)"},
            "heating": {"reference": 900, "melting": 1500, "exponent": 1},
        }
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
    "tools": {
        "die": {
            "profile": [[0, 10], [30, 10]],
            "contact": "frictionless",
            "heat": {"temperature": 200, "conductance": [[0, 1], ["50 MPa", "10 kW/(m^2*K)"]]},
        }
    },
    "heat": {"initial_temperature": 1200},
    "stages": [{"name": "upset", "duration": 1, "tools": {"die": {"stroke": 2, "direction": [0, -1]}}}],
}


def test_heat_in_forming_is_taken() -> None:
    built = build_model(Case.model_validate(FORMING))
    assert built.heat is not None
    assert not built.heat.alone
    assert built.freedoms == 2
    assert built.heat.tools["die"].conductance.tolist() == [[0, 1], [50, 10]]
    assert built.heat.effusivity == pytest.approx([(30 * 7850e-12 * 650e6) ** 0.5])
    assert built.materials[0].heating is not None
    assert built.materials[0].heating.start == 1200.0, "the law begins at the temperature of the workpiece"


BAD_FORMING = [
    ("heat", None, "tools.die.heat", "has no meaning without [heat]"),
    ("solver.displacements", "small", "heat", "for large displacements"),
    ("materials.steel.thermal", None, "materials.steel.thermal", "missing key"),
    ("materials.steel.density", None, "materials.steel.density", "missing key"),
    ("materials.steel.heating.heat_capacity", 6e8, "heating.heat_capacity", "heat twice"),
    ("materials.steel.heating.start", 1000, "heating.start", "gives the initial temperature"),
    ("heat.initial_temperature", 1500, "heat.initial_temperature", "not below the melting temperature"),
    ("heat.initial_temperature", 12000, "heat.initial_temperature", "a temperature of no forming"),
    ("stages.0.duration", None, "stages.0.duration", "heat needs a duration"),
    ("tools.die.heat.conductance", -1, "tools.die.heat.conductance", "is not negative"),
    ("tools.die.heat.conductivity", 25, "tools.die.heat.conductivity", "is given without the others"),
    ("tools.die.heat.warms_up", True, "tools.die.heat.warms_up", "needs a steel"),
    ("heat.surroundings", {"emissivity": 2}, "emissivity", "<= 1"),
]


@pytest.mark.parametrize(("key", "value", "where", "what"), BAD_FORMING)
def test_bad_heat_in_forming_is_told(key, value, where, what) -> None:
    with pytest.raises(CaseError) as caught:
        build_model(Case.model_validate(change(key, value, FORMING)))
    assert where in str(caught.value)
    assert what in str(caught.value)


def test_two_temperatures_on_one_set_are_refused() -> None:
    rows = [{"set": "right", "value": 20}, {"set": "right", "value": 900}]
    with pytest.raises(CaseError, match=r"stages\.0\.temperature\.1\.set.*two temperatures"):
        build_model(HeatCase.model_validate(change("stages.0.temperature", rows)))


def test_surfaces_beside_a_contact_that_conducts_are_not_all_insulated() -> None:
    alone = change("stages", [*CASE["stages"], {"name": "rest", "duration": 10}])
    assert "all surfaces are insulated" in describe(build_model(HeatCase.model_validate(alone)))
    die = {"material": "steel", "mesh": {"size": [10, 10], "origin": [0, -10], "cells": [2, 2]}}
    touching = alone | {
        "bodies": {"die": die},
        "contacts": {"face": {"between": ["workpiece", "die"], "conductance": "10 kW/(m^2*K)"}},
    }
    text = describe(build_model(HeatCase.model_validate(touching)))
    assert "all surfaces apart from face are insulated" in text
    assert "all surfaces are insulated" not in text
