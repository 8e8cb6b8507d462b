# SPDX-License-Identifier: Apache-2.0
"""Heat of a stamping in a case: what is read, and what is refused."""

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from tests.problems.hot_strip import hot_strip

PHASES = {"austenite": {"expansion": 2.2e-5}, "martensite": {"expansion": 1.2e-5, "strain": 0.009}}


def problems(*changes: tuple[str, object]) -> str:
    with pytest.raises(CaseError) as caught:
        build_model(StampingCase.model_validate(hot_strip(*changes)))
    return "\n".join(str(problem) for problem in caught.value.problems)


def test_a_hot_strip_is_read() -> None:
    model = build_model(StampingCase.model_validate(hot_strip()))
    assert model.heat is not None
    assert model.heat.initial == (950.0,)
    assert [stage.slower for stage in model.stages] == pytest.approx([1.0, 100.0, 1.0])
    assert [stage.dwell is not None for stage in model.stages] == [True, False, True]
    steel = model.materials[0]
    assert steel.transformation is not None
    assert steel.transformation.martensite_start == pytest.approx(409, abs=1)
    assert steel.heating is not None
    assert steel.heating.start == 950.0
    assert model.heat.tools["die"].gap == 0.1
    assert np.array_equal(model.heat.tools["holder"].conductance, [[0.0, 2.0]])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("heat.initial_temperature", 20), "it is not austenite at 20 degrees C: Ae3 is 824"),
        (("heat.initial_temperature", 1400), "hotter than any furnace"),
        (("heat.initial_temperature", 5000), "a temperature of no forming"),
        (("tools.holder.heat.temperature", 1500), "no die steel works at 1500 degrees C"),
        (("tools.holder.heat.conductance", -5), "a coefficient of heat transfer is not negative"),
        (("stages.2.dwell", {"place": "tools"}), "stages.2.dwell.duration"),
        (("stages.2.dwell.duration", 0), "stages.2.dwell.duration"),
        (("stages.2.duration", 3), "nothing moves in a dwell"),
        (("stages.2.dwell.pressure", -1), "stages.2.dwell.pressure"),
        (("stages.0.dwell.pressure", 5), "nothing presses in air"),
        (("stages.0.dwell.place", "tools"), "no stage before has closed the tools"),
        (("stages.1", {"name": "form", "tools": {"holder": {"stroke": 0.1}}}), "heat needs a duration"),
        (("materials.steel.thermal", None), "add it: conductivity and specific_heat"),
        (("materials.steel.transformation", {}), "the start of martensite is not given"),
        (("materials.steel.transformation", {"composition": {"C": 23}}), "composition"),
        (("materials.steel.transformation", {"composition": {"C": 2.3}}), "outside the range of stamping steels"),
        (("materials.steel.transformation", {"steel": "22MnB5", "ms": 600}), "do not increase"),
        (("materials.steel.transformation", {"steel": "22MnB5", "latent_heat": [-1, 1]}), "sets heat free"),
        (("materials.steel.transformation", {"steel": "22MnB5", "composition": {"C": 0.2}}), "give one of them"),
        (("materials.steel.transformation", {"ms": 410, "phases": PHASES}), "strain and yield stress by phase are for"),
        (("materials.steel.heating.heat_capacity", 6e8), "plastic work would heat twice"),
        (("heat.levels", 1), "heat.levels"),
        (("heat.max_change", 20), "is for the implicit procedure"),
        (("blank.refine", {"levels": 1}), "temperatures do not pass to split shells"),
        (("heat", None), "has no meaning without [heat]"),
    ],
)
def test_wrong_input_is_told(change, words) -> None:
    assert words in problems(change)


def test_a_latent_heat_given_twice_is_told() -> None:
    twice = {"heat": "80 kJ/kg", "start": 700, "end": 800}
    assert "the transformation has a latent heat, too" in problems(("materials.steel.thermal.latent_heat", twice))


def test_martensite_alone_needs_its_start() -> None:
    change = ("materials.steel.transformation", {"ms": 410})
    steel = build_model(StampingCase.model_validate(hot_strip(change))).materials[0].transformation
    assert steel is not None
    assert steel.martensite_start == 410.0
    assert not steel.composition
