# SPDX-License-Identifier: Apache-2.0
"""Deep drawing, panels, rails, press lines, hot stamping and the blank of a part."""

from __future__ import annotations

from math import sqrt

from presswork.server.opened_folder import RefusedError
from presswork.server.processes.metals import SHEETS
from presswork.server.processes.questions import SURFACES, Answers, Ask, Data, Process, Question, whole

_GROUP = "Sheet metal"
_MATERIAL = Question("Material", (Ask("material", "Material", "material", SHEETS[0], SHEETS),))
_ROUND = Question(
    "Blank", (Ask("diameter", "Diameter", "length", 100), Ask("thickness", "Thickness", "length", 1)), "round"
)
_PUNCH = Question("Punch", (Ask("punch", "Diameter", "length", 50), Ask("edge", "Edge radius", "length", 6)))
_PARTS = ("stl", "msh", "inp", "vtk", "unv")
_GAP = 1.2
"""Gap between punch and die in thicknesses."""


def _depth(default: float) -> Question:
    return Question("Depth", (Ask("depth", "Depth of the part", "length", default),))


def _holder(default: float) -> Question:
    return Question("Blank holder", (Ask("force", "Force on the whole part", "force", default),))


def _set_round_tools(tools: Data, answers: Answers) -> None:
    punch, thickness = answers.number("punch"), answers.number("thickness")
    opening = punch + 2.0 * _GAP * thickness
    if opening >= answers.number("diameter"):
        raise RefusedError("Diameter of the blank: must be above the die's opening, which is the punch and two gaps")
    tools["punch"] |= {"diameter": whole(punch), "edge_radius": whole(answers.number("edge"))}
    tools["die"] |= {"diameter": whole(opening), "edge_radius": whole(min(7.0 * thickness, 0.2 * punch))}
    tools["holder"]["diameter"] = whole(opening)


def _set_blank(data: Data, answers: Answers, size: float) -> None:
    thickness = answers.number("thickness")
    data["blank"] |= {"thickness": whole(thickness), "material": answers.text("material")}
    data["blank"]["element_size"] = whole(min(size / 40.0, max(0.4 * answers.number("edge"), thickness)))


def fill_cup(data: Data, answers: Answers) -> None:
    """Set up a round cup."""
    diameter = answers.number("diameter")
    _set_blank(data, answers, diameter)
    data["blank"]["diameter"] = whole(diameter)
    _set_round_tools(data["tools"], answers)
    stage = data["stages"][0]["tools"]
    stage["punch"]["stroke"] = whole(answers.number("depth"))
    stage["holder"]["force"] = f"{whole(answers.number('force') / 1000.0)} kN"


def fill_press_line(data: Data, answers: Answers) -> None:
    """Set up a cup that is drawn, trimmed and pierced."""
    diameter, punch, edge = (answers.number(key) for key in ("diameter", "punch", "edge"))
    _set_blank(data, answers, diameter)
    data["blank"]["diameter"] = whole(diameter)
    draw, pierce = data["operations"]
    _set_round_tools(draw["tools"], answers)
    flat, rim, hole = punch - 2.0 * edge - 2.0, answers.number("rim"), answers.number("hole")
    opening = draw["tools"]["die"]["diameter"]
    if hole >= flat:
        raise RefusedError(f"Hole: the bottom is level only within {flat:g} mm")
    if not opening < rim < diameter:
        raise RefusedError(f"Rim: must lie between the die's opening ({opening:g} mm) and the blank ({diameter:g} mm)")
    depth = answers.number("depth")
    if rim**2 + 4.0 * punch * max(depth - edge, 0.0) > diameter**2:
        most = sqrt(max(diameter**2 - 4.0 * punch * max(depth - edge, 0.0), 0.0))
        raise RefusedError(f"Rim: of this blank about {most:.0f} mm are left at that depth; make the blank larger")
    draw["stages"][0]["tools"]["punch"]["stroke"] = whole(depth)
    draw["trim"]["rim"]["diameter"] = whole(rim)
    for name in ("pad", "post"):
        pierce["tools"][name]["outer_diameter"] = whole(flat)
    pierce["trim"]["hole"]["diameter"] = whole(hole)


def fill_panel(data: Data, answers: Answers) -> None:
    """Set up a drawing with tools from files."""
    length, width = answers.number("length"), answers.number("width")
    data["blank"] |= {
        "size": [whole(length), whole(width)],
        "thickness": whole(answers.number("thickness")),
        "element_size": whole(max(length, width) / 40.0),
        "material": answers.text("material"),
    }
    stage = data["stages"][0]["tools"]
    for name in ("punch", "die"):
        data["tools"][name]["path"] = answers.text(name)
    stage["punch"]["stroke"] = whole(answers.number("depth"))
    if answers.text("holder"):
        data["tools"]["holder"] = {"kind": "holder", "shape": "file", "path": answers.text("holder"), "mu": 0.1}
        stage["holder"] = {"force": f"{whole(answers.number('force') / 1000.0)} kN"}


def fill_rail(data: Data, answers: Answers) -> None:
    """Set up a hat channel that is drawn and springs back."""
    length, width, thickness = (answers.number(key) for key in ("length", "width", "thickness"))
    punch, edge = answers.number("punch"), answers.number("edge")
    opening = punch + 2.25 * thickness
    if opening >= length:
        raise RefusedError("Length of the blank: must be above the die's opening, which is the punch and two gaps")
    size = max(0.2 * edge, 0.5 * thickness)
    data["blank"] |= {
        "size": [whole(length), whole(width)],
        "thickness": whole(thickness),
        "element_size": [whole(size), whole(max(3.5 * size, 0.1 * width))],
        "material": answers.text("material"),
    }
    tools = data["tools"]
    tools["punch"] |= {"width": whole(punch), "edge_radius": whole(edge)}
    tools["die"] |= {"width": whole(opening), "edge_radius": whole(edge)}
    tools["holder"]["width"] = whole(opening)
    stage = data["stages"][0]["tools"]
    stage["punch"]["stroke"] = whole(answers.number("depth"))
    stage["holder"]["force"] = f"{whole(answers.number('force') / 1000.0)} kN"


def fill_hot_stamping(data: Data, answers: Answers) -> None:
    """Set up a hat that is formed hot and quenched in its tools."""
    length, thickness = answers.number("length"), answers.number("thickness")
    punch, edge = answers.number("punch"), answers.number("edge")
    opening = punch + 2.2 * thickness
    if opening >= length:
        raise RefusedError("Length of the blank: must be above the die's opening, which is the punch and two gaps")
    size = max(edge / 6.0, 0.5 * thickness)
    data["blank"] |= {
        "size": [whole(length), whole(4.0 * size)],
        "thickness": whole(thickness),
        "element_size": [whole(size), whole(2.0 * size)],
    }
    tools = data["tools"]
    tools["punch"] |= {"width": whole(punch), "edge_radius": whole(edge)}
    tools["die"] |= {"width": whole(opening), "edge_radius": whole(edge)}
    data["heat"]["initial_temperature"] = whole(answers.number("temperature"))
    _, form, quench, _ = data["stages"]
    form["tools"]["punch"]["stroke"] = whole(answers.number("depth"))
    quench["dwell"]["duration"] = whole(answers.number("quench"))


def fill_one_step(data: Data, answers: Answers) -> None:
    """Set up the blank of a part."""
    data["part"] |= {"path": answers.text("part"), "draw_direction": answers.text("direction")}
    data["blank"] = {"material": answers.text("material"), "thickness": whole(answers.number("thickness"))}
    data["process"] = {"holder_force": f"{whole(answers.number('force') / 1000.0)} kN"}


PROCESSES = (
    Process(
        "cylindrical_cup", _GROUP, "Cylindrical cup", "Drawn from a round blank by punch, die and blank holder",
        (_ROUND, _MATERIAL, _PUNCH, _depth(20), _holder(15)), fill_cup,
    ),
    Process(
        "tools_from_files", _GROUP, "Panel from CAD", "Punch, die and blank holder from STL or STEP",
        (
            Question(
                "Blank",
                (
                    Ask("length", "Length along x", "length", 200),
                    Ask("width", "Width along y", "length", 200),
                    Ask("thickness", "Thickness", "length", 1),
                ),
            ),
            _MATERIAL,
            Question(
                "Tools",
                (
                    Ask("punch", "Punch", "file", "", SURFACES),
                    Ask("die", "Die", "file", "", SURFACES),
                    Ask("holder", "Blank holder", "file", "", SURFACES, is_needed=False),
                ),
                "surfaces in one coordinate system; the punch moves along -z",
            ),
            _depth(30),
            _holder(50),
        ),
        fill_panel,
    ),
    Process(
        "rail", _GROUP, "Rail with springback", "A hat channel is drawn and springs open",
        (
            Question(
                "Blank",
                (
                    Ask("length", "Length across the rail", "length", 260),
                    Ask("width", "Width", "length", 35),
                    Ask("thickness", "Thickness", "length", 0.8),
                ),
            ),
            _MATERIAL,
            Question("Punch", (Ask("punch", "Width", "length", 50), Ask("edge", "Edge radius", "length", 5))),
            _depth(60),
            _holder(10),
        ),
        fill_rail,
    ),
    Process(
        "cup_line", _GROUP, "Press line", "A cup drawn, trimmed and pierced, with springback after each operation",
        (
            _ROUND,
            _MATERIAL,
            _PUNCH,
            _depth(16),
            Question(
                "Cuts", (Ask("rim", "Rim trimmed to", "length", 86), Ask("hole", "Hole", "length", 22)), "diameters"
            ),
        ),
        fill_press_line,
    ),
    Process(
        "hot_stamping", _GROUP, "Hot stamping", "A hat of 22MnB5, formed hot and quenched between its tools",
        (
            Question(
                "Blank",
                (Ask("length", "Length across", "length", 170), Ask("thickness", "Thickness", "length", 1.5)),
            ),
            Question("Furnace", (Ask("temperature", "Temperature", "temperature", 950),)),
            Question("Punch", (Ask("punch", "Width", "length", 60), Ask("edge", "Edge radius", "length", 6))),
            _depth(30),
            Question("Quench", (Ask("quench", "Time between the closed tools", "time", 10),)),
        ),
        fill_hot_stamping,
    ),
    Process(
        "one_step", _GROUP, "Blank of a part", "One step from the finished part back to its flat blank",
        (
            Question("Part", (Ask("part", "Mid-surface", "file", "", _PARTS),), "flange included"),
            Question("Sheet", (Ask("thickness", "Thickness", "length", 1),)),
            _MATERIAL,
            Question(
                "Punch", (Ask("direction", "Moves along", "choice", "-z", ("-z", "z", "-y", "y", "-x", "x")),)
            ),
            Question("Blank holder", (Ask("force", "Force", "force", 10, above=-1.0),)),
        ),
        fill_one_step,
    ),
)  # fmt: skip
