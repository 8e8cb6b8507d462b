# SPDX-License-Identifier: Apache-2.0
"""Lengths in another unit and temperatures in kelvin are told before anything is computed, with the unit that fits."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model, read_case
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.examples import copy_example
from presswork.geometry.swept_tool import draw_block, triangulate
from presswork.mesh.files.stl_file import pack_stl
from presswork.model import Triangulation
from tests.unit.case.round_cup import CUP, changed
from tests.unit.case.test_resistance import AXIS, BOX, DOWN_IN_SPACE, QUARTER, STEEL, flat, line, plane_case, space_case

UNITS = {"mm": 1.0, "cm": 10.0, "inch": 25.4, "m": 1e3}
SEEDS = range(3)


def build(case: Any, caplog: pytest.LogCaptureFixture) -> str:
    caplog.clear()
    with caplog.at_level(logging.WARNING, logger="presswork"):
        build_model(case, run_user_code=False)
    return caplog.text


def write_block(folder: Path, scale: float, half: tuple[float, float], height: float) -> str:
    """Write the surface of a block whose lower end is at z = 0, in units of 1/scale mm."""
    points, triangles = triangulate(draw_block(half, 1.0, height, 0.5), 0.05)
    points = points - [0.0, 0.0, points[:, 2].min()]
    path = folder / f"block_{scale:g}.stl"
    path.write_bytes(pack_stl("tool", Triangulation(points / scale, triangles, True)))
    return str(path)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("unit", ["cm", "inch", "m"])
def test_an_stl_in_another_unit_is_told_with_its_unit_in_space(
    unit: str, seed: int, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """A block a little larger than the workpiece, quarter of 20 x 24 x 15 mm, written in the unit or read in it."""
    rng = np.random.default_rng(seed)
    half = (float(rng.uniform(11, 18)), float(rng.uniform(13, 18)))
    height = float(rng.uniform(5, 20))

    def ask(written: float, read: str | None) -> str:
        punch = {"shape": "file", "path": write_block(tmp_path, written, half, height), "contact": "sticking"}
        punch |= {"position": "touch"} | ({"unit": read} if read else {})
        case = space_case(BOX, {"punch": punch, "anvil": flat(0, 1)}, QUARTER, DOWN_IN_SPACE)
        try:
            return build(case, caplog)
        except CaseError as error:
            return str(error)

    assert "times the workpiece" not in ask(1.0, None)
    assert "times the workpiece" not in ask(UNITS[unit], unit)
    small, large = ask(UNITS[unit], None), ask(1.0, unit)
    assert f'unit = "{unit}"' in small or f'give its unit: "{unit}"' in small
    assert 'unit = "mm"' in large or '"mm"' in large


@pytest.mark.parametrize("seed", SEEDS)
def test_a_drawing_without_a_unit_is_told_with_the_unit_that_fits(
    seed: int, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    rng = np.random.default_rng(seed)
    unit = ["cm", "inch", "m"][seed % 3]
    width, slope = float(rng.uniform(15, 25)), float(rng.uniform(0.0, 2.0))
    drawing = ezdxf.new(units=0)
    corners = [(0.0, 15.0), (0.5 * width, 15.0), (width, 15.0 + slope)]
    drawing.modelspace().add_lwpolyline([(x / UNITS[unit], y / UNITS[unit]) for x, y in corners])
    drawing.saveas(tmp_path / "punch.dxf")
    punch = {"profile_file": str(tmp_path / "punch.dxf"), "contact": "sticking", "position": "touch"}

    def ask(**more: str) -> str:
        tools = {"punch": punch | more, "anvil": line(0)}
        try:
            return build(plane_case(tools, AXIS, {"punch": {"stroke": 5, "direction": [0, -1]}}), caplog)
        except CaseError:  # the tool is so small that it reaches no node
            return caplog.text

    assert f'With unit = "{unit}"' in ask()
    assert "times the workpiece" not in ask(unit=unit)


def stamping(folder: Path, scale: float = 1.0, **blank: Any) -> StampingCase:
    """A punch from a file, in units of 1/scale mm, over a drawn die."""
    sheet = {"shape": "circle", "diameter": 100, "thickness": 1, "element_size": 10} | blank
    path = write_block(folder, scale, (25.0, 25.0), 40.0)
    return StampingCase.model_validate(
        {
            "title": "t",
            "analysis": "stamping",
            "blank": sheet | {"material": "steel"},
            "materials": {"steel": STEEL},
            "tools": {
                "punch": {"kind": "punch", "shape": "file", "path": path, "position": [0, 0, 30]},
                "die": {"kind": "die", "shape": "round", "diameter": 80, "edge_radius": 5},
            },
            "stages": [{"name": "draw", "tools": {"punch": {"stroke": 40}}}],
        }
    )


def test_a_punch_twenty_times_the_blank_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    try:
        found = build(stamping(tmp_path, 1.0 / 25.4), caplog)
    except CaseError as error:
        found = str(error) + caplog.text
    assert "times the workpiece" in found or "see that punch and die fit" in found


@pytest.mark.parametrize("thickness", [0.0008, 0.003, 800.0])
def test_a_thickness_in_another_unit_is_told(
    thickness: float, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    try:
        found = build(stamping(tmp_path, thickness=thickness, diameter=150, element_size=30), caplog)
    except CaseError as error:
        found = str(error) + caplog.text
    assert "plain numbers are mm" in found.lower()


def hot(start: float, die: float, ambient: float) -> Case:
    heat = {"temperature": die, "conductance": 5}
    thermal = {"conductivity": 28, "specific_heat": 6.5e8}
    return plane_case(
        {"punch": line(15) | {"heat": heat}, "anvil": line(0) | {"heat": heat}},
        AXIS,
        {"punch": {"stroke": 5, "direction": [0, -1]}},
        stages=[{"name": "press", "duration": 1}],
        materials={"steel": {"library": "c45_hot", "density": 7.85e-9, "thermal": thermal}},
        heat={"initial_temperature": start, "surroundings": {"ambient": ambient, "emissivity": 0.8}},
        workpiece={"material": "steel", "mesh": {"size": [10, 15], "cells": [2, 3]}},
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_temperatures_in_kelvin_are_told_and_those_in_celsius_are_not(
    seed: int, caplog: pytest.LogCaptureFixture
) -> None:
    """The law's window is 820 to 1200 degrees C."""
    rng = np.random.default_rng(seed)
    start, die, room = float(rng.uniform(960, 1180)), float(rng.uniform(100, 400)), float(rng.uniform(16, 30))
    zero = 273.15
    assert "elvin" not in build(hot(start, die, room), caplog)
    assert f'"{start + zero:g} K" is' in build(hot(start + zero, die, room), caplog)
    assert "heat.surroundings.ambient" in build(hot(start, die, room + zero), caplog)
    assert "heat.surroundings.ambient" in build(hot(start + zero, die + zero, room + zero), caplog)


def test_round_temperatures_in_kelvin_are_told_by_themselves(caplog: pytest.LogCaptureFixture) -> None:
    found = build(hot(1373, 523, 20), caplog)
    assert "heat.initial_temperature = 1373 (1100 degrees C)" in found
    assert "tools.punch.heat.temperature = 523" in found
    assert "elvin" not in build(hot(1150, 328, 20), caplog)
    assert "tools.punch.heat.temperature = 323 (49.85 degrees C)" in build(hot(1150, 323, 20), caplog)
    assert "heat.initial_temperature = 1173 (899.9 degrees C)" in build(hot(1173, 200, 20), caplog)


def test_coefficients_of_heat_transfer_in_watts_per_square_metre_are_told(caplog: pytest.LogCaptureFixture) -> None:
    """1 N/(mm s K) is 1000 W/(m^2 K): air takes 0.005 to 0.25, dies 1 to 100 of it."""

    def ask(air: float | str, die: float | str) -> str:
        around = {"heat": {"surroundings": {"coefficient": air}}, "tools": {"punch": {"heat": {"conductance": die}}}}
        return build(merge(hot(1150, 200, 20), around), caplog)

    air = "heat.surroundings.coefficient: 10 N/(mm s K) is 10 kW/(m^2 K), more than air transfers"
    assert air in ask(10, 5)
    assert '"10 W/(m^2*K)"' in caplog.text
    assert "tools.punch.heat.conductance: 8000 N/(mm s K)" in ask(0.01, 8000)
    assert "tools.punch.heat.conductance" in ask(0.01, [[0, 900], [100, 8000]])
    assert "kW/(m^2 K)" not in ask("10 W/(m^2*K)", "8000 W/(m^2*K)")
    assert "kW/(m^2 K)" not in ask(0.25, 100)
    assert "kW/(m^2 K)" not in ask(0.0, 400)


def merge(case: Case, changes: dict[str, Any]) -> Case:
    """Return a case with other values of some keys."""

    def put(into: dict[str, Any], what: dict[str, Any]) -> dict[str, Any]:
        for key, value in what.items():
            into[key] = put(into[key], value) if isinstance(value, dict) else value
        return into

    return Case.model_validate(put(case.model_dump(exclude_unset=True), changes))


def test_a_quench_in_watts_per_square_metre_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = copy_example("billet_cooling", tmp_path)

    def ask(coefficient: str) -> str:
        caplog.clear()
        with caplog.at_level(logging.WARNING, logger="presswork"):
            build_model(read_case(path, [f"stages.2.convection.0.coefficient={coefficient}"]))
        return caplog.text

    assert "stages.2.convection.0.coefficient: 9000 N/(mm s K) is 9000 kW/(m^2 K), more than water that boils" in ask(
        "[[20, 3000], [300, 9000]]"
    )
    assert "boiling" not in ask("[[20, 3], [300, 12]]")


def test_a_stroke_through_the_anvil_is_refused_in_space(caplog: pytest.LogCaptureFixture) -> None:
    """The box is 15 mm high."""

    def case(stroke: float, **more: Any) -> SpaceCase:
        down = {"punch": {"stroke": stroke, "direction": [0, 0, -1]}}
        return space_case(BOX, {"punch": flat(15, -1), "anvil": flat(0, 1)}, QUARTER, down, **more)

    build_model(case(13.0))
    with pytest.raises(CaseError, match=r"after about 1[45][.\d]* of its 18 mm the tools close on the workpiece"):
        build_model(case(18.0))
    assert "the tools close on the workpiece" in build(case(18.0, limits={"stop": False}), caplog)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_closed_die_in_space_is_refused_where_its_room_ends(seed: int, tmp_path: Path) -> None:
    """A cup of known bore and a punch that fills it: the billet's volume is the room at a known stroke."""
    rng = np.random.default_rng(seed)
    bore, height = 10.5, 15.0
    radius = float(rng.uniform(8.0, 9.0))
    closes = height - height * (radius / bore) ** 2
    wall = {"shape": "round", "profile": [[0, 0], [bore, 0], [bore, 40]], "contact": "frictionless"}
    mesh = {"kind": "cylinder", "radius": radius, "height": height, "angle": 90, "cells": [4, 4, 4]}
    sides = {"y0": {"set": "first_plane", "fix": ["y"]}, "x0": {"set": "last_plane", "fix": ["x"]}}

    def case(stroke: float) -> SpaceCase:
        down = {"punch": {"stroke": stroke, "direction": [0, 0, -1]}}
        return space_case(mesh, {"punch": flat(height, -1), "cup": wall}, sides, down)

    build_model(case(0.7 * closes))
    with pytest.raises(CaseError, match="the tools close on the workpiece"):
        build_model(case(closes + 0.25 * (height - closes)))


def test_a_binder_of_which_a_line_leaves_nothing_is_told_with_the_unit_of_its_file(tmp_path: Path) -> None:
    """A face of 120 mm written in inches is 4.72 "mm" wide: nothing of it lies outside of a circle of 60 mm."""
    path = write_block(tmp_path, 25.4, (60.0, 60.0), 10.0)
    cut = {"shape": "circle", "diameter": 60, "keep": "outside"}
    case = changed(CUP, ("tools.holder", {"kind": "holder", "shape": "file", "path": path, "cut": cut}))
    with pytest.raises(CaseError, match=r"tools\.holder\.cut.*outside of the line.*unit = \"inch\""):
        build_model(StampingCase.model_validate(case))
    case["tools"]["holder"]["unit"] = "inch"
    build_model(StampingCase.model_validate(case))
