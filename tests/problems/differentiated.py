# SPDX-License-Identifier: Apache-2.0
"""Cases with derivatives in their history, and the same derivatives by central differences of whole runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case import build_model
from presswork.case.case_file import CaseFile
from presswork.model import FloatArray
from presswork.recorder import run_model
from presswork.results import Result
from presswork.results.history import name_derivative
from tests.problems.hot_strip import bent_strip

EXACT = {
    "initial_increment": 0.25,
    "max_increment": 0.25,
    "force_tolerance": 1e-12,
    "displacement_tolerance": 1e-11,
}
"""Settings of the solver with which runs of neighbours differ by their parameter alone."""
CALM = EXACT | {"max_iterations": 60, "force_tolerance": 1e-10, "displacement_tolerance": 1e-9}
"""The same for runs that would cut increments at other places."""
APART = 3e-4
"""Of a parameter: by how much whole runs differ."""


def upset_cylinder(**changes: Any) -> dict[str, Any]:
    """Return the data of a cylinder upset between platens with constant shear friction, without derivatives."""
    return {
        "title": "Upsetting with friction",
        "analysis": "axisymmetric",
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "origin": [0, 0], "size": [10, 15], "cells": [4, 6], "pattern": "quad"},
        },
        "materials": {
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "swift", "K": 700.0, "e0": 0.01, "n": 0.2},
            }
        },
        "tools": {"punch": {"profile": [[0, 15], [30, 15]], "contact": "shear", "m": 0.2}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle_plane": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "upset", "tools": {"punch": {"stroke": 1.2, "direction": [0, -1]}}}],
        "solver": EXACT,
        "output": {"steps": 1},
        **changes,
    }


def upset_block(element: str, friction: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of an eighth of a block in space, upset by a platen with a law of friction."""
    return {
        "title": "Block",
        "analysis": "solid",
        "workpiece": {
            "material": "steel",
            "element": element,
            "mesh": {"kind": "box", "size": [10, 10, 10], "cells": [2, 2, 2]},
        },
        "materials": upset_cylinder()["materials"],
        "tools": {"punch": {"shape": "plane", "position": [0, 0, 10], "normal": [0, 0, -1], **friction}},
        "boundary": {
            "x": {"set": "left", "fix": ["x"]},
            "y": {"set": "bottom", "fix": ["y"]},
            "z": {"set": "back", "fix": ["z"]},
        },
        "stages": [{"name": "upset", "tools": {"punch": {"stroke": 0.8, "direction": [0, 0, -1]}}}],
        "solver": EXACT,
        "output": {"steps": 1},
    }


def upset_with_floating_tools() -> dict[str, Any]:
    """Return the data of the same block, pushed by a force onto a plane that rests on a spring, which gives at once."""
    data = upset_block("hex8_fbar", {"contact": "coulomb", "mu": 0.1})
    spring = {"stiffness": 1.6e5, "preload": 2e3, "direction": [0, 0, -1]}
    low = {"shape": "plane", "normal": [0, 0, 1], "contact": "coulomb", "mu": 0.1, "spring": spring}
    held = {name: data["boundary"][name] for name in ("x", "y")}
    push = {"name": "push", "tools": {"punch": {"force": 1.8e5, "direction": [0, 0, -1]}}}
    return data | {"tools": data["tools"] | {"low": low}, "boundary": held, "stages": [push], "solver": CALM}


def upset_between_floating_tools() -> dict[str, Any]:
    """Return the data of the whole cylinder under the same kinds of tools."""
    data = upset_cylinder(solver=CALM)
    spring = {"stiffness": 2e5, "preload": 2e3, "direction": [0, -1]}
    low = {"profile": [[30, 0], [0, 0]], "contact": "shear", "m": 0.2, "spring": spring}
    push = {"name": "push", "tools": {"punch": {"force": 1.3e5, "direction": [0, -1]}}}
    return data | {
        "tools": data["tools"] | {"low": low},
        "boundary": {"axis": data["boundary"]["axis"]},
        "stages": [push],
    }


SOFT = {"young": 70e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 300.0, "e0": 0.01, "n": 0.2}}
EVEN = CALM | {"initial_increment": 0.125, "max_increment": 0.125, "target_iterations": 60}


def upset_two_bodies(friction: Mapping[str, Any], *, stroke: float = 1.2, **changes: Any) -> dict[str, Any]:
    """Return the data of a steel cylinder and a softer one on it, with a law of friction between them."""
    data = upset_cylinder(points={"rim": [9.5, 0.5], "core": [3.1, 4.2]}, solver=EVEN, **changes)
    steel, upper = ({"kind": "rectangle", "pattern": "quad", **mesh} for mesh in (
        {"origin": [0, 0], "size": [10, 8], "cells": [5, 4]}, {"origin": [0, 8], "size": [9, 7], "cells": [4, 4]}
    ))  # fmt: skip
    data["stages"][0]["tools"]["punch"]["stroke"] = stroke
    return data | {
        "workpiece": data["workpiece"] | {"mesh": steel},
        "bodies": {"upper": {"material": "soft", "element": "quad4_fbar", "mesh": upper}},
        "materials": data["materials"] | {"soft": SOFT},
        "contacts": {"joint": {"between": ["workpiece", "upper"], **friction}},
        "boundary": data["boundary"] | {"upper_axis": {"set": "upper.left", "fix": ["x"]}},
    }


def upset_two_blocks() -> dict[str, Any]:
    """Return the data of a steel block and a softer one on it in space, with Coulomb's friction between them."""
    friction = {"contact": "coulomb", "mu": 0.1}
    data = upset_block("hex8_fbar", friction)
    steel, upper = ({"kind": "box", **mesh} for mesh in (
        {"size": [10, 10, 5], "cells": [2, 2, 2]}, {"origin": [0, 0, 5], "size": [9, 9, 5], "cells": [3, 3, 2]}
    ))  # fmt: skip
    held = {"upper_x": {"set": "upper.left", "fix": ["x"]}, "upper_y": {"set": "upper.bottom", "fix": ["y"]}}
    return data | {
        "workpiece": data["workpiece"] | {"mesh": steel},
        "bodies": {"upper": {"material": "soft", "element": "hex8_fbar", "mesh": upper}},
        "materials": data["materials"] | {"soft": SOFT},
        "contacts": {"joint": {"between": ["workpiece", "upper"], **friction}},
        "boundary": data["boundary"] | held,
        "points": {"rim": [9.4, 8.7, 0.4], "top": [8.4, 7.3, 8.9]},
        "solver": EVEN,
    }


def twist_sector() -> dict[str, Any]:
    """Return the data of a quarter of a disc that a plane presses and twists: its cut faces move alike."""
    die = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "axis": [0, 0, 1]}
    return {
        "title": "Sector",
        "analysis": "solid",
        "workpiece": {
            "material": "steel",
            "mesh": {"kind": "cylinder", "radius": 10, "height": 8, "angle": 90, "cells": [3, 2, 3]},
        },
        "materials": upset_cylinder()["materials"],
        "tools": {"die": {**die, "contact": "coulomb", "mu": 0.3}},
        "boundary": {
            "base": {"set": "back", "fix": ["x", "y", "z"]},
            "cut": {"set": "last_plane", "cyclic": "first_plane"},
        },
        "stages": [{"name": "twist", "tools": {"die": {"stroke": 0.4, "direction": [0, 0, -1], "turn": 40}}}],
        "points": {"rim": [6, 6.5, 6]},
        "solver": EVEN | {"initial_increment": 0.25, "max_increment": 0.25, "force_tolerance": 1e-8},
        "output": {"steps": 1},
    }


HOT: dict[str, Any] = {
    "materials": {
        "steel": {
            "young": 150e3,
            "poisson": 0.3,
            "density": "7850 kg/m^3",
            "hardening": {"law": "swift", "K": 400.0, "e0": 0.01, "n": 0.2},
            "heating": {"melting": 1500, "exponent": 0.8, "reference": 20},
            "thermal": {"conductivity": 30, "specific_heat": "600 J/(kg*K)"},
        }
    },
    "heat": {
        "initial_temperature": 1000,
        "surroundings": {"ambient": 20, "emissivity": 0.8, "coefficient": 0.02},
        "plastic_fraction": 0.9,
        "max_change": 500,
        "tolerance": 0.05,
    },
    "solver": CALM | {"initial_increment": 0.125, "max_increment": 0.125, "target_iterations": 60},
}
"""Steel that softens as it warms; equilibrium and heat are found several times in an increment."""
COLD = {"temperature": 200, "conductance": 5.0}
"""Of a tool."""


def upset_hot(**changes: Any) -> dict[str, Any]:
    """Return the data of the cylinder of hot steel under a cold punch, without derivatives."""
    data = upset_cylinder(points={"core": [3.1, 4.2], "rim": [9.5, 0.5]}, **HOT)
    stage = {"name": "upset", "duration": 0.2, "tools": {"punch": {"stroke": 2.0, "direction": [0, -1]}}}
    tools = {"punch": {**data["tools"]["punch"], "m": 0.3, "heat": COLD}}
    return data | {"tools": tools, "stages": [stage]} | changes


def upset_hot_block() -> dict[str, Any]:
    """Return the data of the block in space of the same steel, with Coulomb's friction."""
    data = upset_block("hex8_fbar", {"contact": "coulomb", "mu": 0.1, "heat": COLD})
    data["stages"][0]["duration"] = 0.2
    return data | HOT | {"points": {"core": [3, 4, 4], "rim": [9.5, 9.5, 0.5]}}


def upset_in_press(press: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of the cylinder of a metal that feels the strain rate, upset by a press."""
    data = upset_cylinder(presses={"press": dict(press)}, solver=CALM)
    rate = {"law": "cowper_symonds", "D": 40.0, "q": 5.0}
    return data | {
        "materials": {"steel": data["materials"]["steel"] | {"rate": rate}},
        "stages": [data["stages"][0] | {"press": "press"}],
    }


def upset_until(press: Mapping[str, Any], *, blows: int = 0) -> dict[str, Any]:
    """Return the data of the cylinder upset by a press whose energy or limit of force ends the stage. blows: of it."""
    data = upset_cylinder(presses={"press": dict(press)}, points={"rim": [9.5, 0.5]})
    driven = {"name": "press", "blows": blows} if blows else "press"
    return data | {
        "solver": EVEN | {"force_tolerance": 1e-9},
        "stages": [data["stages"][0] | {"press": driven}],
    }


def with_inertia(data: Mapping[str, Any], duration: float) -> dict[str, Any]:
    """Return the data of a case of steel with inertia and damping, all of its stages of a duration [s]."""
    steel = data["materials"]["steel"] | {"density": "7850 kg/m^3"}
    return {
        **data,
        "materials": data["materials"] | {"steel": steel},
        "solver": data["solver"] | {"inertia": 1.0, "damping": 1000.0, "target_iterations": 60},
        "stages": [stage | {"duration": duration} for stage in data["stages"]],
    }


def bend_strip(hardening: Mapping[str, Any], *, angle: float = 20.0, points: int = 21) -> dict[str, Any]:
    """Return the data of a strip of shells that is bent to an angle [degrees] and springs back; points: of layers."""
    return {
        "title": "Strip",
        "analysis": "shell",
        "workpiece": {
            "material": "steel",
            "element": "shell4_mitc",
            "section": {"thickness": 1.0, "points": points},
            "mesh": {"kind": "rectangle", "size": [20, 4], "cells": [5, 1]},
        },
        "materials": {"steel": {"young": 200e3, "poisson": 0.0, "hardening": dict(hardening)}},
        "boundary": {"root": {"set": "left", "hold": "clamped"}},
        "stages": [
            {"name": "bend", "rotation": [{"set": "right", "axis": "y", "angle": angle}]},
            {"name": "release"},
        ],
        "points": {"tip": [20, 2, 0]},
        "solver": {
            **EXACT,
            "initial_increment": 0.125,
            "max_increment": 0.125,
            "force_tolerance": 1e-10,
            "max_iterations": 40,
        },
        "output": {"steps": 1},
    }


def bend_over_die(**changes: Any) -> dict[str, Any]:
    """Return the data of a strip that a punch bends into an open die by the implicit procedure, and that is let go."""
    return {
        "title": "Strip bent over a die",
        "analysis": "stamping",
        "procedure": "implicit",
        "blank": {
            "shape": "rectangle", "size": [44, 4], "thickness": 1.0, "element_size": [2.25, 2], "material": "steel",
            "symmetry": ["x", "y"], "points": 7,
        },
        "materials": {
            "steel": {"young": 206e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 565.0, "e0": 0.007, "n": 0.26}}
        },
        "tools": {
            "punch": {"kind": "punch", "shape": "strip", "width": 15, "edge_radius": 6, "mu": 0.1},
            "die": {"kind": "die", "shape": "strip", "width": 21, "edge_radius": 6, "mu": 0.1},
        },
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 3.0}}}],
        "springback": {"increments": 2},
        "points": {"tip": [22, 2, 0], "wall": [9, 1, 0]},
        "implicit": {
            "initial_increment": 0.05, "max_increment": 0.05, "max_iterations": 40, "force_tolerance": 1e-11,
            "displacement_tolerance": 1e-9,
        },
        "output": {"steps": 1},
        **changes,
    }  # fmt: skip


def bend_twice() -> dict[str, Any]:
    """Return the data of the strip that is bent, trimmed and let go, and bent further by a second operation."""
    data = bend_over_die()
    first = {
        "name": "bend",
        "tools": data["tools"],
        "stages": data["stages"],
        "trim": {"end": {"shape": "rectangle", "size": [36, 8]}},
        "springback": {"increments": 2},
    }
    second = {
        "name": "again",
        "tools": data["tools"],
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 2.5}}}],
        "springback": {"increments": 2},
    }
    rest = {key: value for key, value in data.items() if key not in ("tools", "stages", "springback", "points")}
    return rest | {"operations": [first, second]}


def stamp_hot() -> dict[str, Any]:
    """Return the data of a strip of hot steel that is carried to its tools, bent, quenched in them and let go."""
    data = bent_strip(
        ("procedure", "implicit"),
        ("points", {"wall": [5, 2, 0], "tip": [8, 2, 0]}),
        ("springback", {"increments": 2}),
        ("output", {"steps": 1}),
        ("tools.die.mu", 0.1),
        ("tools.die.heat.conductance", 2.0),
    )
    tight = {"max_iterations": 60, "force_tolerance": 1e-9, "displacement_tolerance": 1e-8}
    alike = {"initial_increment": 0.05, "max_increment": 0.05, "increment_tolerance": 0.9}  # in neighbouring runs
    return data | {"implicit": tight | alike}


def draw_under_holder() -> dict[str, Any]:
    """Return the data of the same strip, longer, drawn from under a holder that a force pushes."""
    data = bend_over_die(points={"tip": [30, 2, 0], "wall": [9, 1, 0]})
    holder = {"kind": "holder", "shape": "strip", "width": 20, "edge_radius": 6, "mu": 0.1}
    return data | {
        "blank": data["blank"] | {"size": [60, 4]},
        "tools": data["tools"] | {"die": data["tools"]["die"] | {"width": 20}, "holder": holder},
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 3.0}, "holder": {"force": 800.0}}}],
        "draw_in": {"end": 0.0, "corner": 3.0},
    }


def run_case(kind: type[CaseFile], data: Mapping[str, Any], folder: Path) -> Result:
    """Run a case to its end."""
    outcome = run_model(build_model(kind.model_validate(data)), folder)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def differentiate(
    kind: type[CaseFile],
    data: dict[str, Any],
    of: Sequence[str],
    by: Mapping[str, float],
    folder: Path,
    *,
    apart: Mapping[str, float] | None = None,
    within: float = np.inf,
) -> dict[str, dict[str, tuple[FloatArray, FloatArray]]]:
    """Return derivatives row by row: in the run, and by central differences of whole runs.

    by: keys of the case, with their values. apart: of the value of a key, by how much whole runs
    differ; without it APART. within: a difference farther off is taken over twice and half of that, too, and the
    nearest counts, since round-off grows with a shorter step and curvature with a longer one.
    """
    own = run_case(kind, {**data, "gradients": {"of": list(of), "by": list(by)}}, folder / "own").history
    found: dict[str, dict[str, tuple[FloatArray, FloatArray]]] = {}
    for key, value in by.items():
        change = (apart or {}).get(key, APART) * abs(value)
        found[key] = {}
        for step in (change, 2.0 * change, 0.5 * change):
            left = [name for name in of if name not in found[key] or largest_error(*found[key][name]) > within]
            if not left:
                break
            more, less = (
                run_case(kind, set_value(data, key, value + way), folder / f"{key}{way:+g}").history
                for way in (step, -step)
            )
            for name in left:
                both = np.asarray(own[name_derivative(name, key)]), (more[name] - less[name]) / (2.0 * step)
                found[key][name] = min(found[key].get(name, both), both, key=lambda pair: largest_error(*pair))
    return found


def set_value(data: Any, key: str, value: float) -> Any:
    """Return the data of a case with another value at a key."""
    name, _, rest = key.partition(".")
    if isinstance(data, Mapping):
        return {**data, name: set_value(data[name], rest, value) if rest else value}
    return [
        (set_value(each, rest, value) if rest else value) if i == int(name) else each for i, each in enumerate(data)
    ]


def largest_error(own: FloatArray, other: FloatArray) -> float:
    """Return the largest difference of two courses over the largest value of the second."""
    return float(np.abs(own - other).max() / np.abs(other).max())
