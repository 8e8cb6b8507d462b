# SPDX-License-Identifier: Apache-2.0
"""What the laws of a material require of the rest of a case: time where they depend on the rate, and a temperature."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from presswork.case.errors import Problem
from presswork.case.material.grain import Grain
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.plastic import PlasticLaws
from presswork.case.material.umat import UmatMaterial
from presswork.case.part import Part

TIMING = ("duration", "velocity", "press", "process_time", "dwell")
"""Keys any of which times a stage."""


def check_needs(
    materials: Mapping[str, PlasticLaws | UmatMaterial],
    used: Sequence[str],
    stages: Sequence[Part],
    *,
    heated: bool = False,
) -> Iterator[Problem]:
    """Yield the problems of rate laws in stages without a time, and of hot laws without a temperature.

    used: names of the materials of bodies. heated: [heat] gives the temperature.
    """
    for name in used:
        material = materials.get(name)
        if not isinstance(material, PlasticLaws):
            continue
        law = material.needs_time()
        for index, stage in enumerate(stages if law else ()):
            if not any(getattr(stage, key, None) and key in stage.model_fields_set for key in TIMING):
                fault = f"missing key: materials.{name}.{law} depends on the strain rate, and nothing times the stage"
                yield Problem(f"stages.{index}.duration", fault, "add it, in seconds")
        if not heated and (material.heating is None or material.heating.start is None):
            yield from _check_temperature(name, material)


def check_grain(key: str, grain: Grain, *, knows_temperature: bool, stages: Sequence[Part]) -> list[Problem]:
    """Return the problems of a grain size that lacks temperature or time; key: of the material."""
    problems, own = [], f"{key}.grain.temperature"
    if grain.temperature is None and not knows_temperature:
        remedy = "add it [degrees C], or [heat], or `heating` of the material"
        problems.append(Problem(own, "missing key: recrystallisation needs a temperature", remedy))
    if grain.temperature is not None and knows_temperature:
        problems.append(Problem(own, "the run knows the temperature", "remove it", grain.temperature))
    for index, stage in enumerate(stages):
        if not any(getattr(stage, name, None) and name in stage.model_fields_set for name in TIMING):
            fault = "missing key: recrystallisation takes time"
            problems.append(Problem(f"stages.{index}.duration", fault, "add it [s], or a velocity or press"))
    return problems


def _check_temperature(name: str, material: PlasticLaws) -> Iterator[Problem]:
    hardening, key = material.hardening, material.follows_temperature()
    if isinstance(hardening, HotLaw):
        remedy = f"such as {hardening.window()[2].mean():g} degrees C"
    elif key is not None:
        remedy = "such as 20 degrees C"
    else:
        return
    fault = f"missing key: {hardening.law if isinstance(hardening, HotLaw) else key} depends on temperature"
    yield Problem(f"materials.{name}.heating.start", fault, f"add the temperature of the material, {remedy}")
