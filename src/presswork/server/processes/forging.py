# SPDX-License-Identifier: Apache-2.0
"""Forging, extrusion, rolling, drawing of wire and shrink fits."""

from __future__ import annotations

from math import cos, degrees, radians, sqrt, tan

from presswork.server.opened_folder import RefusedError
from presswork.server.processes.metals import COLD, HOT, find_expansion, make_hot, set_cold
from presswork.server.processes.questions import CURVES, SURFACES, Answers, Ask, Data, Process, Question, whole

_GROUP = "Forging and other bulk forming"
_BILLET = Question(
    "Billet", (Ask("diameter", "Diameter", "length", 30), Ask("height", "Height", "length", 21.2)), "as it is cut"
)
_COLD = Question("Material", (Ask("material", "Material", "material", COLD[0], COLD),))
_HOT = Question(
    "Material",
    (Ask("material", "Material", "material", HOT[0], HOT), Ask("temperature", "Temperature", "temperature", 1200)),
    "as it leaves the furnace",
)
_STROKE = Question(
    "Stroke",
    (Ask("stroke", "Stroke of the upper die", "length", 5.6),),
    "from where it touches the billet; the editor plays it",
)


def _dies(endings: tuple[str, ...], form: str) -> Question:
    return Question(
        "Dies",
        (
            Ask("upper", "Upper die", "file", "", endings, is_needed=False),
            Ask("lower", "Lower die", "file", "", endings, is_needed=False),
        ),
        f"{form}; without a lower die both are alike; without any a hub with flange is forged",
    )


def divide(lengths: tuple[float, float], finest: float = 12.0, most: float = 40.0) -> list[int]:
    """Return how many cells two sides have: `finest` along the shorter one, at most `most` along the longer one."""
    edge = max(min(lengths) / finest, max(lengths) / most)
    return [max(round(length / edge), 2) for length in lengths]


def fill_dies(data: Data, answers: Answers) -> None:
    """Set up a billet between dies in the plane."""
    radius, height = 0.5 * answers.number("diameter"), answers.number("height")
    is_alike = not answers.text("lower")
    size = (radius, 0.5 * height if is_alike else height)
    data["workpiece"]["mesh"] = {"size": [whole(length) for length in size], "cells": divide(size)}
    upper = data["tools"]["upper_die"]
    if answers.text("upper"):
        del upper["profile"]
        data["tools"]["upper_die"] = upper = {"profile_file": answers.text("upper"), **upper}
    if not is_alike:
        lower = {key: value for key, value in upper.items() if not key.startswith("profile")}
        data["tools"]["lower_die"] = {"profile_file": answers.text("lower"), **lower}
        del data["boundary"]["parting_plane"]
    data["stages"][-1]["tools"]["upper_die"]["stroke"] = whole(answers.number("stroke"))


def fill_cold_dies(data: Data, answers: Answers) -> None:
    """Set up a cold billet between dies in the plane."""
    fill_dies(data, answers)
    set_cold(data, answers.text("material"))


def fill_hot_dies(data: Data, answers: Answers) -> None:
    """Set up a hot billet between dies in the plane."""
    fill_dies(data, answers)
    data["workpiece"]["material"] = answers.text("material")
    data["materials"] = {answers.text("material"): make_hot(answers.text("material"))}
    data["heat"]["initial_temperature"] = whole(answers.number("temperature"))


def fill_dies_in_space(data: Data, answers: Answers) -> None:
    """Set up a round billet between dies in space."""
    radius, height = 0.5 * answers.number("diameter"), answers.number("height")
    is_alike = not answers.text("lower")
    tall, size = (0.5 * height if is_alike else height), radius / 7.0
    angle = {"whole": 360, "half": 180, "quarter": 90}[answers.text("part")]
    mesh = data["workpiece"]["mesh"]
    cells = [7, max(round(angle / 11.25 / 2) * 2, 4), max(round(tall / (1.4 * size)), 3)]
    mesh |= {"radius": whole(radius), "height": whole(tall), "angle": angle, "cells": cells}
    boundary = data["boundary"]
    if angle == 180:
        boundary["last_plane"]["fix"] = ["y"]
    elif angle == 360:
        del boundary["first_plane"], boundary["last_plane"]
    upper = data["tools"]["upper_die"]
    if answers.text("upper"):
        del upper["profile"]
        upper |= {"shape": "file", "path": answers.text("upper")}
    if not is_alike:
        lower = {key: value for key, value in upper.items() if key not in ("profile", "shape", "path")}
        data["tools"]["lower_die"] = {"shape": "file", "path": answers.text("lower"), **lower}
        del boundary["parting_plane"]
    data["remesh"] |= {"size": whole(size), "smallest_size": whole(0.5 * size)}
    data["stages"][0]["tools"]["upper_die"]["stroke"] = whole(answers.number("stroke"))
    set_cold(data, answers.text("material"))


def draw_cone(before: float, after: float, angle: float, bearing: float) -> tuple[list[object], float]:
    """Return the profile of a conical die, and how high above its entry it begins; radii, lengths [mm], angle [rad]."""
    tall = (before - after) / tan(angle)
    corner = min(0.3 * before, min(0.35 * tall / cos(angle), 0.6 * bearing) / tan(0.5 * angle))
    above = 1.25 * corner * tan(0.5 * angle)
    end, relief = -tall - bearing, 0.05 * after
    points: list[object] = [
        [whole(before), whole(above)],
        {"to": [whole(before), 0], "radius": whole(corner)},
        {"to": [whole(after), whole(-tall)], "radius": whole(corner)},
        {"to": [whole(after), whole(end)], "radius": whole(min(0.2, 0.25 * bearing))},
        [whole(after + relief), whole(end - 2.0 * relief)],
        [whole(after + relief), whole(end - 8.0 * before)],
    ]
    return points, above


def fill_extrusion(data: Data, answers: Answers) -> None:
    """Set up a billet in its container above a conical die."""
    before, after = 0.5 * answers.number("diameter"), 0.5 * answers.number("product")
    length, stroke = answers.number("length"), answers.number("stroke")
    if after >= before:
        raise RefusedError("Product diameter: must be below that of the billet")
    if answers.number("angle") > 75.0:
        raise RefusedError("Half angle of the die: at most 75 degrees")
    if stroke >= length:
        raise RefusedError("Stroke: must be below the length of the billet")
    points, above = draw_cone(before, after, radians(answers.number("angle")), 0.25 * after)
    top = whole(above + length)
    set_cold(data, answers.text("material"))
    data["workpiece"] |= {
        "mesh": {
            "origin": [0, whole(above)],
            "size": [whole(before), whole(length)],
            "cells": divide((before, length)),
        },
    }
    tools = data["tools"]
    tools["ram"]["profile"] = [[0, top], [whole(1.1 * before), top]]
    tools["container"]["profile"] = [[whole(before), whole(2.0 * length + above)], [whole(before), whole(above)]]
    tools["die"]["profile"] = points
    data["stages"][0]["tools"]["ram"]["stroke"] = whole(stroke)


def fill_rolling(data: Data, answers: Answers) -> None:
    """Set up a strip before the gap of two rolls."""
    before, after = 0.5 * answers.number("before"), 0.5 * answers.number("after")
    radius, mu = 0.5 * answers.number("roll"), answers.number("mu")
    if after >= before:
        raise RefusedError("Thickness after: must be below that before")
    draught = before - after
    arc = sqrt(2.0 * radius * draught - draught**2) if draught < radius else radius
    if arc > mu * radius:
        most = f"at {mu:g} the rolls take in at most {mu**2 * radius:.3g} mm"
        raise RefusedError(f"Friction: {most}; they are to take {2.0 * draught:g} mm")
    length = max(4.5 * arc, 10.0 * before)
    start, cells = -1.006 * arc - length, 6
    set_cold(data, answers.text("material"))
    data["workpiece"] |= {
        "mesh": {
            "origin": [whole(start), 0],
            "size": [whole(length), whole(before)],
            "cells": [min(round(cells * length / before), 160), cells],
        },
    }
    top, middle = whole(after + 2.0 * radius), whole(after + radius)
    data["tools"]["roll"] |= {
        "profile": [
            [0, whole(after)],
            {"to": [0, top], "centre": [0, middle], "turn": "left"},
            {"to": [0, whole(after)], "centre": [0, middle], "turn": "left"},
        ],
        "mu": whole(mu),
    }
    data["tools"]["pusher"]["profile"] = [[whole(start), whole(-0.5 * before)], [whole(start), whole(1.5 * before)]]
    bite, roll = data["stages"]
    bite["tools"]["roll"]["turn"] = whole(round(degrees(0.29 * arc / radius), 3))
    bite["tools"]["pusher"]["move"] = [whole(round(0.3 * arc, 3)), 0]
    roll["tools"]["roll"]["turn"] = whole(round(degrees(0.78 * length / radius), 3))


def fill_wire(data: Data, answers: Answers) -> None:
    """Set up a wire before a conical die."""
    before, after = 0.5 * answers.number("before"), 0.5 * answers.number("after")
    if after >= before:
        raise RefusedError("Diameter after: must be below that before")
    if before > 1.3 * after:
        raise RefusedError("Diameter after: a wire tears that is drawn to less than 3/4 in one pass")
    slope, bearing = tan(radians(answers.number("angle"))), 0.45 * after
    entry, length = 1.2 * before, 8.0 * before
    nose = 1.4 * (before - after) / slope + 0.1 * before
    set_cold(data, answers.text("material"))
    data["workpiece"] |= {
        "mesh": {"origin": [0, whole(nose)], "size": [whole(before), whole(length)], "cells": [8, 64]},
    }
    data["tools"]["die"] |= {
        "profile": [
            [whole(entry), whole((entry - after) / slope)],
            {"to": [whole(after), 0], "radius": whole(0.4 * before)},
            {"to": [whole(after), whole(-bearing)], "radius": whole(0.1 * before)},
            [whole(entry), whole(-bearing - 0.3 * before)],
        ],
        "mu": whole(answers.number("mu")),
    }
    point, draw = data["stages"]
    point["displacement"][0]["value"] = whole(-(nose + bearing + 0.6 * before))
    draw["displacement"][0]["value"] = whole(-4.0 * before)


def fill_shrink_fit(data: Data, answers: Answers) -> None:
    """Set up a hot ring round a cold shaft."""
    shaft, outer, width = (answers.number(key) for key in ("shaft", "outer", "width"))
    name, temperature = answers.text("material"), answers.number("temperature")
    if outer <= 1.05 * shaft:
        raise RefusedError("Outer diameter: must be above that of the shaft")
    expansion, cold = find_expansion(name), shaft - answers.number("interference")
    larger = 1.0 + expansion * (temperature - 20.0)
    if cold * larger <= shaft:
        needed = 20.0 + (1.001 * shaft / cold - 1.0) / expansion
        raise RefusedError(f"Temperature: the ring goes over the shaft only above {needed:.0f} °C")
    bore, wall, half = 0.5 * cold * larger, 0.5 * (outer - cold) * larger, 0.5 * width
    data["workpiece"] |= {"material": name}
    data["workpiece"]["mesh"] = {
        "size": [whole(0.5 * shaft), whole(1.5 * half)],
        "cells": divide((0.5 * shaft, 1.5 * half), 14.0),
    }
    data["bodies"]["ring"] |= {
        "material": name,
        "initial_temperature": whole(temperature),
        "mesh": {
            "origin": [whole(bore), 0],
            "size": [whole(wall), whole(half)],
            "cells": divide((wall, half), 14.0),
        },
    }
    data["materials"] = {name: {**make_hot(name), "expansion": {"coefficient": expansion}}}


PROCESSES = (
    Process(
        "closed_die", _GROUP, "Closed die", "Cold, with flash; a section turned about the axis",
        (_BILLET, _COLD, _dies(CURVES, "half sections as DXF, STEP or points, x is the radius"), _STROKE),
        fill_cold_dies,
    ),
    Process(
        "closed_die_hot", _GROUP, "Closed die, hot", "From the furnace under a crank press; dies chill the metal",
        (_BILLET, _HOT, _dies(CURVES, "half sections as DXF, STEP or points, x is the radius"), _STROKE),
        fill_hot_dies,
    ),
    Process(
        "closed_die_3d", _GROUP, "Closed die in 3D", "Dies from STL or STEP; tetrahedra that get new meshes",
        (
            _BILLET,
            _COLD,
            _dies(SURFACES, "surfaces as STL or STEP, which close along z"),
            _STROKE,
            Question(
                "Computed",
                (Ask("part", "Part of the forging", "choice", "quarter", ("quarter", "half", "whole")),),
                "a quarter where x = 0 and y = 0 are symmetry planes, a half where y = 0 is one",
            ),
        ),
        fill_dies_in_space,
    ),
    Process(
        "extrusion", _GROUP, "Extrusion", "A billet is pressed through a conical die",
        (
            Question("Billet", (Ask("diameter", "Diameter", "length", 20), Ask("length", "Length", "length", 30))),
            _COLD,
            Question("Product", (Ask("product", "Product diameter", "length", 16),)),
            Question("Die", (Ask("angle", "Half angle", "angle", 15),)),
            Question("Stroke", (Ask("stroke", "Stroke of the ram", "length", 15),)),
        ),
        fill_extrusion,
    ),
    Process(
        "rolling", _GROUP, "Rolling", "A strip through the gap of two rolls",
        (
            Question("Strip", (Ask("before", "Thickness before", "length", 4), Ask("after", "after", "length", 3.2))),
            _COLD,
            Question("Rolls", (Ask("roll", "Diameter", "length", 200),)),
            Question("Friction", (Ask("mu", "Coefficient", "number", 0.15),)),
        ),
        fill_rolling,
    ),
    Process(
        "wire_drawing", _GROUP, "Wire drawing", "A wire through a conical die",
        (
            Question("Wire", (Ask("before", "Diameter before", "length", 10), Ask("after", "after", "length", 9))),
            _COLD,
            Question("Die", (Ask("angle", "Half angle", "angle", 8),)),
            Question("Friction", (Ask("mu", "Coefficient", "number", 0.06),)),
        ),
        fill_wire,
    ),
    Process(
        "shrink_fit", _GROUP, "Shrink fit", "A hot ring shrinks onto a shaft as it cools",
        (
            Question("Shaft", (Ask("shaft", "Diameter", "length", 40),)),
            Question("Ring", (Ask("outer", "Outer diameter", "length", 80), Ask("width", "Width", "length", 40))),
            Question("Interference", (Ask("interference", "On the diameter", "length", 0.08),)),
            Question("Heating", (Ask("temperature", "Temperature of the ring", "temperature", 300),)),
            Question("Material", (Ask("material", "Material of both", "material", "c45", ("c45", *COLD)),)),
        ),
        fill_shrink_fit,
    ),
)  # fmt: skip
