# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about heat: thermal properties, films, contacts, time steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from presswork import model
from presswork.model import FloatArray


def describe_thermal(thermal: model.Thermal) -> str:
    """Describe what a material conducts and stores."""
    text = (
        f"conductivity {_describe_table(thermal.conductivity, 1.0, 'W/(m K)')}, specific heat "
        f"{_describe_table(thermal.specific_heat, 1e-6, 'J/(kg K)')}, density {thermal.density * 1e12:g} kg/m3"
    )
    if thermal.latent_heat:
        start, end = thermal.transformation
        text += f", latent heat {thermal.latent_heat * 1e-9:g} kJ/kg from {start:g} to {end:g} °C"
    return text


def describe_heat(problem: model.Model, heat: model.Heat) -> Iterator[str]:
    """Describe initial temperatures, contacts, stages and time steps, a line per fact."""
    for material in problem.materials:
        if material.thermal is not None:
            yield f"material {material.name}: {describe_thermal(material.thermal)}"
    names = [body.name for body in problem.bodies] or ["workpiece"]
    yield f"at the start: {', '.join(f'{n} {t:g} °C' for n, t in zip(names, heat.initial, strict=True))}"
    for contact in heat.contacts:
        first, second = (names[i] for i in contact.between)
        yield f"contact {contact.name}: {first} with {second}, {contact.conductance[0, 1] * 1e3:g} W/(m2 K)"
    for number, stage in enumerate(problem.stages, 1):
        yield f'stage {number} "{stage.name}", {stage.duration:g} s:'
        films = stage.heat or model.HeatStage()
        yield from (f"  {line}" for line in describe_films(films, [contact.name for contact in heat.contacts]))
    if heat.fixed_step is not None:
        yield f"time steps: {heat.fixed_step:g} of each stage, whatever their errors"
    else:
        yield (
            f"time steps: first {heat.initial_step:g} of a stage, at most {heat.max_step:g}; each may add an error of "
            f"{heat.tolerance:g} K"
        )


def describe_heat_of_forming(problem: model.Model, heat: model.Heat) -> Iterator[str]:
    """Describe the heat of a body as it is formed."""
    for material in problem.materials:
        if material.thermal is not None:
            yield f"heat of {material.name}: {describe_thermal(material.thermal)}"
    names = [body.name for body in problem.bodies] or ["workpiece"]
    start = ", ".join(f"{n} {t:g} °C" for n, t in zip(names, heat.initial, strict=True))
    yield f"at the start {start}; {heat.plastic_fraction:g} of the plastic work becomes heat"
    for contact in heat.contacts:
        conductance = _describe_table(contact.conductance, 1e3, "W/(m2 K)", "MPa")
        yield f"heat passes between bodies at {contact.name}, {conductance}{_describe_gap(contact.gap)}"
    for name, tool in heat.tools.items():
        conductance = _describe_table(tool.conductance, 1e3, "W/(m2 K)", "MPa")
        stays = "" if tool.steel is None else ", which warms up behind the nodes that touch it"
        yield f"heat passes into {name} at {tool.temperature:g} °C{stays}, {conductance}{_describe_gap(tool.gap)}"
    around = heat.surroundings
    if around is not None:
        yield (
            f"free surfaces: emissivity {around.emissivity:g}, {1e3 * around.coefficient:g} W/(m2 K) to "
            f"{around.ambient:g} °C"
        )
    for stage in problem.stages:
        yield from (f"stage {stage.name}: {line}" for line in (describe_films(stage.heat) if stage.heat else ()))


def describe_films(stage: model.HeatStage, contacts: Sequence[str] = ()) -> Iterator[str]:
    """Describe what heats and cools in a stage; contacts: names of those that conduct."""
    for entry in stage.temperatures:
        yield f"{entry.node_set} is held at {_describe_table(entry.value, 1.0, '°C', 's')}"
    for flux in stage.fluxes:
        yield f"{_describe_table(flux.value, 1.0, 'kW/m2', 's')} flows into {flux.side_set}"
    for film in stage.convections:
        coefficient = _describe_table(film.coefficient, 1e3, "W/(m2 K)")
        yield f"convection on {film.side_set}, {coefficient} to {_describe_table(film.ambient, 1.0, '°C', 's')}"
    for radiation in stage.radiations:
        ambient = _describe_table(radiation.ambient, 1.0, "°C", "s")
        yield f"radiation on {radiation.side_set}, emissivity {radiation.emissivity:g}, to {ambient}"
    if stage == model.HeatStage():
        apart = f" apart from {', '.join(contacts)}" if contacts else ""
        yield f"all surfaces{apart} are insulated"


def _describe_table(table: FloatArray, factor: float, unit: str, by: str = "°C") -> str:
    """Describe a value, or the range of a table and of what it depends on."""
    arguments, values = table.T
    if len(table) == 1:
        return f"{factor * values[0]:g} {unit}"
    return f"{factor * values.min():g} to {factor * values.max():g} {unit} ({arguments[0]:g} to {arguments[-1]:g} {by})"


def _describe_gap(gap: float) -> str:
    return f", falling to nothing across a gap of {gap:g} mm" if gap > 0.0 else ""
