# SPDX-License-Identifier: Apache-2.0
"""Whether the temperatures of a case look like kelvin or degrees Fahrenheit where degrees Celsius are meant."""

from __future__ import annotations

from collections.abc import Iterator

from presswork.model import ZERO_CELSIUS, Model

COLDEST_ROOM, HOTTEST_ROOM = -5.0, 45.0
"""Temperatures of a workshop [degrees C]."""
ROUND = 5.0
"""People write temperatures in steps of this [K]."""
VERY_ROUND = 50.0
"""A single number that is a step of this in kelvin is a slip; of steps of `ROUND` a fifth of all numbers is one [K]."""
WITHIN = 0.051
"""How far a number may lie off such a step."""
COOLER = 100.0
"""How much cooler surroundings are than a hot workpiece, at least [K]; in a furnace they are not."""


def warn_of_temperatures(model: Model) -> Iterator[str]:
    """Yield what looks like another unit: a start outside a law's window, several numbers of kelvin, a hot tool."""
    outside = list(_find_outside(model))
    yield from outside
    yield from _find_kelvin(model)
    heat = model.heat
    if heat is not None and not heat.alone:
        for name, tool in heat.tools.items():
            if tool.temperature > max(heat.initial):
                yield (
                    f"tools.{name}.heat.temperature: at {tool.temperature:g} degrees C it is hotter than the body "
                    f"at {max(heat.initial):g}; plain numbers are degrees C"
                )


def _find_outside(model: Model) -> Iterator[str]:
    """Yield starts outside the window of temperatures that a law was fitted in, and the unit in which they fit."""
    for material in model.materials:
        window = None if material.hardening is None else material.hardening.window
        if window is None or material.heating is None:
            continue
        (low, high), start = window[2], material.heating.start
        if low <= start <= high:
            continue
        units = {
            f'"{start:g} K" is {start - ZERO_CELSIUS:.4g} degrees C, which fits: kelvin?': start - ZERO_CELSIUS,
            f'"{start + ZERO_CELSIUS:.5g} K" was given, and {start + ZERO_CELSIUS:.5g} degrees C fit: degrees C?': start
            + ZERO_CELSIUS,
            f"{start:g} degrees F are {(start - 32.0) / 1.8:.4g} degrees C, which fits: Fahrenheit?": (start - 32.0)
            / 1.8,
        }
        hint = next((text for text, fits in units.items() if low <= fits <= high), "plain numbers are degrees C")
        yield (
            f"materials.{material.name}: it starts at {start:g} degrees C, and its law was fitted from {low:g} to "
            f"{high:g}; {hint}"
        )


def _find_kelvin(model: Model) -> Iterator[str]:
    """Yield a warning where a room, a very round number, two different ones, or two of a workshop look like kelvin."""
    temperatures = dict(_list_temperatures(model))
    hottest = max((t for key, t in temperatures.items() if not _is_room(key)), default=0.0)
    rooms = [key for key, t in temperatures.items() if _is_room(key) and _is_room_in_kelvin(t, hottest)]
    looks = [key for key, t in temperatures.items() if _is_round_in_kelvin(t)]
    cold = [key for key in looks if temperatures[key] - ZERO_CELSIUS <= HOTTEST_ROOM]
    sure = any(_is_round_in_kelvin(t, VERY_ROUND) for t in temperatures.values())
    if not rooms and not sure and len({temperatures[key] for key in looks}) < 2 and len(cold) < 2:
        return
    found = {key: temperatures[key] for key in dict.fromkeys([*rooms, *looks])}
    listed = ", ".join(f"{key} = {t:g} ({t - ZERO_CELSIUS:.4g} degrees C)" for key, t in found.items())
    yield f'plain numbers are degrees C, and these look like kelvin: {listed}; if so, give the unit, as in "1373 K"'


def _list_temperatures(model: Model) -> Iterator[tuple[str, float]]:
    """Yield the temperatures [degrees C] of bodies, tools and surroundings that a case gives, by their keys."""
    heat = model.heat
    if heat is None:
        for material in model.materials:
            if material.heating is not None:
                yield f"materials.{material.name}.heating.start", material.heating.start
        return
    names = [body.name for body in model.bodies] or ["workpiece"]
    for name, start in zip(names, heat.initial, strict=False):
        yield "heat.initial_temperature" if name == "workpiece" else f"bodies.{name}.initial_temperature", start
    for name, tool in heat.tools.items():
        yield f"tools.{name}.heat.temperature", tool.temperature
    if heat.surroundings is not None:
        yield "heat.surroundings.ambient", heat.surroundings.ambient
    for index, stage in enumerate(model.stages):
        if stage.heat is None:
            continue
        for row, convection in enumerate(stage.heat.convections):
            yield f"stages.{index}.convection.{row}.ambient", float(convection.ambient[0, -1])
        for row, radiation in enumerate(stage.heat.radiations):
            yield f"stages.{index}.radiation.{row}.ambient", float(radiation.ambient[0, -1])
        for row, held in enumerate(stage.heat.temperatures):
            yield f"stages.{index}.temperature.{row}.value", float(held.value[0, -1])


def _is_room(key: str) -> bool:
    return key.endswith(".ambient")


def _is_room_in_kelvin(temperature: float, hottest: float) -> bool:
    """Return whether surroundings have a workshop's temperature in kelvin, not a furnace's in degrees C."""
    is_room = COLDEST_ROOM <= temperature - ZERO_CELSIUS <= HOTTEST_ROOM
    return is_room and (not _is_step(temperature) or temperature < hottest - COOLER)


def _is_round_in_kelvin(temperature: float, step: float = ROUND) -> bool:
    """Return whether a number is round once it is taken for kelvin, but not as it is."""
    above = temperature >= ZERO_CELSIUS + COLDEST_ROOM
    return (
        above
        and not _is_step(temperature)
        and any(_is_step(temperature - zero, step) for zero in (273.0, ZERO_CELSIUS))
    )


def _is_step(temperature: float, step: float = ROUND) -> bool:
    return abs(temperature - step * round(temperature / step)) < WITHIN
