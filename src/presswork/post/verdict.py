# SPDX-License-Identifier: Apache-2.0
"""The verdict on a run: a line for each thing that an engineer decides by, with figure, limit and place.

Lines come from the summary, which holds what observers found. Page, printed summary and scripts show the same lines.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from presswork.model import FEW_OUTSIDE, FULL_DIE
from presswork.results import Result

State = Literal["ok", "risk", "fail", "figure"]
"""`figure`: a number without a limit to judge it by."""
ROUND_OFF = 1e-9
"""Measure below which there is none."""
_WORST: tuple[State, ...] = ("fail", "risk", "ok", "figure")
_FIELDS = {"penetration": "gap", "hydrostatic_stress": "hydrostatic_stress", "mean_pressure": "hydrostatic_stress"}
_NAMES = {
    "penetration": "depth of tools in the workpiece",
    "hydrostatic_stress": "hydrostatic stress over flow stress",
    "mean_pressure": "mean pressure over flow stress",
}

Summary = Mapping[str, Any]


@dataclass(frozen=True)
class Line:
    """One thing that was judged."""

    name: str
    state: State
    figure: str
    """Number with its unit, or a few words."""
    limit: str = ""
    """What it is judged by; empty if nothing is known."""
    note: str = ""
    """When, what it means, or the remedy."""
    field: str = ""
    """Field of the results that shows it."""
    at_mm: tuple[float, ...] = ()
    """Place on the deformed part [mm]."""
    time_s: float | None = None
    """When; None: at the end."""


@dataclass(frozen=True)
class RunVerdict:
    """All lines, the worst first, and the state of the worst."""

    state: State
    lines: tuple[Line, ...]

    def to_data(self) -> dict[str, Any]:
        """Return plain values for a page."""
        return asdict(self)

    def text(self) -> str:
        """Return the state with the lines that are not OK.

        >>> RunVerdict("ok", (Line("laps", "ok", "none"),)).text()
        'result: OK, of 1 check'
        """
        count = sum(line.state != "figure" for line in self.lines)
        head = "OK" if self.state == "ok" else self.state
        bad = [line for line in self.lines if line.state in ("fail", "risk") and not line.name.startswith("warning")]
        rest = "".join(f"\n  {line.state}: {describe_line(line)}" for line in bad)
        return f"result: {head}, of {count} check{'' if count == 1 else 's'}{rest}"


def describe_line(line: Line) -> str:
    """Return a line as text.

    >>> describe_line(Line("force of punch", "fail", "12 kN", "10 kN", "at 3 mm"))
    'force of punch 12 kN (limit 10 kN), at 3 mm'
    """
    limit = f" (limit {line.limit})" if line.limit else ""
    place = f"at ({', '.join(f'{x:.4g}' for x in line.at_mm)}) mm" if line.at_mm else ""
    return ", ".join(part for part in (f"{line.name} {line.figure}{limit}", place, line.note) if part)


def judge_result(result: Result) -> RunVerdict:
    """Return the verdict on a run, finished or not; without a summary there is nothing to judge yet."""
    return judge_summary(result.summary, result.formability.safety_margin, result.mesh.points.shape[1])


def judge_summary(summary: Summary, safety_margin: float = 0.1, dimension: int = 3) -> RunVerdict:
    """Return the verdict by what summary.json holds.

    safety_margin: part of the forming limit held in reserve; dimension: of places.
    """
    judges = (
        _judge_end,
        _judge_forces,
        _judge_presses,
        _judge_pressures,
        _judge_die_fill,
        _judge_laps,
        _judge_contact_pressure,
        _judge_wear,
        _judge_cracks,
        _judge_separation,
        lambda found: _judge_forming_limit(found, safety_margin),
        _judge_thinning,
        _judge_welds,
        _judge_joints,
        _judge_wrinkles,
        _judge_springback,
        _judge_windows,
        _judge_limits,
        _judge_warnings,
    )
    lines = [line for judge in judges for line in judge(summary)] if summary else []
    lines = [replace(line, at_mm=tuple(line.at_mm[:dimension])) for line in lines]
    lines.sort(key=lambda line: _WORST.index(line.state))
    return RunVerdict(lines[0].state if lines else "figure", tuple(lines))


def _number(value: float) -> str:
    return f"{value:.4g}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"


def _when(instant: Mapping[str, Any]) -> str:
    """Return stage and strokes of an instant in words.

    >>> _when({"stage": "draw", "strokes_mm": {"punch": 12.0}, "time_s": 1.0})
    'in draw, punch at 12 mm'
    """
    moved = ", ".join(f"{tool} at {stroke:.4g} mm" for tool, stroke in instant.get("strokes_mm", {}).items())
    return ", ".join(part for part in (f"in {instant['stage']}" if instant.get("stage") else "", moved) if part)


def _join(*parts: str) -> str:
    return "; ".join(part for part in parts if part)


def _against(value: float, limit: float | None) -> State:
    return "figure" if limit is None else "fail" if value > limit else "ok"


# --- one function a line ---------------------------------------------------------------------------------------------


def _judge_end(summary: Summary) -> Iterator[Line]:
    """Judge how the run ended, and whether anything was formed."""
    status, done = summary.get("status", "completed"), summary.get("fraction_computed", 1.0)
    if status != "completed":
        state: State = "fail" if status == "gave_up" else "risk"
        yield Line(
            "run", state, f"{status.replace('_', ' ')} after {_percent(done)}", "100 %", summary.get("reason", "")
        )
    elif worst := summary.get("verdict"):
        yield Line("run", "fail", "nothing was formed", "", str(worst).partition(": ")[2])
    else:
        yield Line("run", "ok", "completed", "", summary.get("ended_by", ""))


def _judge_forces(summary: Summary) -> Iterator[Line]:
    """Judge the largest force of each tool that moves by that of the press."""
    limit = summary.get("equipment", {}).get("force_n")
    for tool, largest in summary.get("largest_forces", {}).items():
        if tool in largest["strokes_mm"]:
            force = abs(largest["force_n"])
            shown = "" if limit is None else f"{_number(1e-3 * limit)} kN"
            figure, note = f"{_number(1e-3 * force)} kN", _when(largest)
            yield Line(f"force of {tool}", _against(force, limit), figure, shown, note, time_s=largest["time_s"])
    if "punch_force_kN" in summary:
        force = 1e3 * summary["punch_force_kN"]
        yield Line("force of the punch", _against(force, limit), f"{_number(1e-3 * force)} kN")


def _judge_presses(summary: Summary) -> Iterator[Line]:
    """Judge force and energy of the ram in each stage by what its press is rated at."""
    for entry in summary.get("press", []):
        near, where = entry.get("nearest_to_rating", {}), f"in {entry['stage']}"
        if "rated_there_kN" in near:
            force, borne = near["force_kN"], near["rated_there_kN"]
            above = f"{_number(near['above_bottom_mm'])} mm above bottom" if "above_bottom_mm" in near else ""
            note = ", ".join(part for part in (where, above) if part)
            name, figure, limit = f"force of press {entry['press']}", f"{_number(force)} kN", f"{_number(borne)} kN"
            yield Line(name, _against(force, borne), figure, limit, note, time_s=near["time_s"])
        if "rated_energy_kJ" in near:
            spent, given = entry["energy_spent_kJ"], near["rated_energy_kJ"]
            name, figure, limit = f"energy of press {entry['press']}", f"{_number(spent)} kJ", f"{_number(given)} kJ"
            yield Line(name, _against(spent, given), figure, limit, where)


def _judge_pressures(summary: Summary) -> Iterator[Line]:
    """Judge that no pressure on the sheet has passed its maximum, beyond which a given pressure bursts the sheet."""
    for name, found in summary.get("sheet_pressures", {}).items():
        figure, note = f"{_number(found['largest_mpa'])} MPa", f"in {found['stage']}"
        if found["passed"]:
            note += (
                f", at a height of {_number(found['height_mm'])} mm of {_number(found['largest_height_mm'])} mm: "
                "beyond it a pressure that is given, and not a volume, bursts the sheet"
            )
        state: State = "risk" if found["passed"] else "figure"
        yield Line(f"largest pressure of {name}", state, figure, "", note, "thinning", time_s=found["time_s"])


def _judge_die_fill(summary: Summary) -> Iterator[Line]:
    """Judge how far each die is filled; flash is a figure, and so is the groove of a die that joins sheets."""
    for die, fill in summary.get("die_fill", {}).items():
        gap, filled, place = fill["largest_gap_mm"], fill["wall_filled"], tuple(fill.get("largest_gap_at_mm") or ())
        open_at = "" if gap is None else f"widest gap {_number(gap)} mm"
        is_joint = "joints" in summary
        state: State = "figure" if is_joint else "ok" if filled >= FULL_DIE else "fail"
        limit, field = "" if is_joint else f"at least {100 * FULL_DIE:.0f} %", "gap"
        yield Line(f"fill of {die}", state, _percent(filled), limit, open_at, field, place)
        if fill.get("flash_thickness_mm") is not None:
            yield Line(f"flash at {die}", "figure", f"{_number(fill['flash_thickness_mm'])} mm thick")


def _judge_welds(summary: Summary) -> Iterator[Line]:
    """Give how far weld lines have moved: a figure."""
    for name, found in summary.get("weld_lines", {}).items():
        into, out = found["into_zone"], found["out_of_zone"]
        most = max(into, out, key=lambda one: abs(one["mm"]))
        note = f"{_number(max(0.0, into['mm']))} mm into the zone, {_number(max(0.0, -out['mm']))} mm out of it"
        moved = f"moved by {_number(abs(most['mm']))} mm"
        yield Line(f"weld line of {name}", "figure", moved, "", note, "zone", tuple(most["place"]))


def _judge_joints(summary: Summary) -> Iterator[Line]:
    """Judge that sheets joined by forming hold each other."""
    for name, found in summary.get("joints", {}).items():
        note = f"neck {_number(found['neck_mm'])} mm, bottom {_number(found['bottom_mm'])} mm"
        state: State = "figure" if found["interlock_mm"] > 0.0 else "fail"
        yield Line(f"interlock of {name}", state, f"{_number(found['interlock_mm'])} mm", "", note)


def _judge_laps(summary: Summary) -> Iterator[Line]:
    """Judge that the surface has not folded onto itself."""
    if "laps" not in summary:
        return
    if not summary["laps"]:
        yield Line("laps", "ok", "none")
    for lap in summary["laps"]:
        place = tuple(lap[key] for key in ("x_mm", "y_mm", "z_mm") if key in lap)
        extent = f"{_number(lap['length_mm'])} mm long" if "length_mm" in lap else f"{_number(lap['area_mm2'])} mm2"
        yield Line("lap", "fail", extent, "none", "", "lap", place)


def _judge_contact_pressure(summary: Summary) -> Iterator[Line]:
    """Judge the largest contact pressure by what the tools bear."""
    largest = summary.get("fields", {}).get("contact_pressure", {}).get("largest")
    if not largest or not largest["value"]:
        return
    limit, at = summary.get("equipment", {}).get("contact_pressure_mpa"), tuple(largest["at_mm"])
    figure, shown = f"{_number(largest['value'])} MPa", "" if limit is None else f"{_number(limit)} MPa"
    state, name = _against(largest["value"], limit), "contact pressure on tools"
    yield Line(name, state, figure, shown, "", "contact_pressure", at, largest["time_s"])


def _judge_wear(summary: Summary) -> Iterator[Line]:
    """Judge the wear of tools by the depth that they may lose."""
    for tool, found in summary.get("wear", {}).items():
        figure, limit = f"{_number(found['deepest_mm'])} mm after {found['parts']} parts", found.get("limit_mm")
        until = found.get("parts_until_limit")
        note = "" if until is None else f"the limit is reached after {until} parts"
        state = _against(found["deepest_mm"], limit)
        shown = "" if limit is None else f"{_number(limit)} mm"
        yield Line(f"wear of {tool}", state, figure, shown, note, at_mm=tuple(found["deepest_at_mm"]))


def _judge_cracks(summary: Summary) -> Iterator[Line]:
    """Judge damage by its critical value, where the material gives one."""
    for name, known in ({} if "separation" in summary else summary.get("damage", {})).items():
        first, most, critical = known.get("first_exceeded"), known["largest_mean"], known["critical"]
        word, shown = name.removeprefix("damage_").replace("_", " "), "" if critical is None else _number(critical)
        worst = first or most
        state: State = "fail" if first else "figure" if critical is None else "ok"
        note = ("first crack " if first else "") + _when(worst)
        figure, at = _number(worst["value"]), tuple(worst["at_mm"])
        yield Line(
            f"damage, {word}" if critical is None else f"cracks by {word}",
            state,
            figure,
            shown,
            note,
            name,
            at,
            worst["time_s"],
        )


def _judge_separation(summary: Summary) -> Iterator[Line]:
    """Judge whether a body that is to part has parted, and show the zones of its edges."""
    found = summary.get("separation")
    if found is None:
        return
    parted, first = found.get("parted"), found.get("first_crack")
    if first:
        time, note = first["time_s"], f"{found['cracks']} in all"
        yield Line("first crack", "figure", f"punch at {first['stroke_mm']:.4g} mm", "", note, time_s=time)
    when = parted["time_s"] if parted else None
    note = f"punch at {parted['stroke_mm']:.4g} mm" if parted else "the stroke is too short, or no crack goes through"
    state: State = "ok" if parted else "risk"
    yield Line("separation", state, f"{found['pieces']} pieces", "at least 2", note, time_s=when)
    if "work_J" in found:
        yield Line("work until it has parted", "figure", f"{found['work_J']:.4g} J", "", "")
    for edge in found.get("edges", []):
        for zone in ("rollover", "sheared", "fracture", "burr"):
            share = edge[f"{zone}_mm"] / edge["thickness_mm"]
            yield Line(f"{zone} of the {edge['piece']}", "figure", _percent(share), "", f"{edge[f'{zone}_mm']:.3g} mm")


def _judge_forming_limit(summary: Summary, margin: float) -> Iterator[Line]:
    """Judge the least margin to the forming limit, by strains at the end and along their paths."""
    found = summary.get("formability", {})
    for key, word in (("least_margin", "at the end"), ("least_margin_polar", "along the path")):
        least = found.get(key)
        if not least:
            continue
        value, at = least["value"], tuple(least["place"])
        state: State = "fail" if value < 0.0 else "risk" if value < margin else "ok"
        crack = summary.get("first_crack") if value < 0.0 else None
        note = f"first crack {_when(crack)}" if crack else ""
        field = "forming_limit_margin" + key.removeprefix("least_margin")
        name, limit = f"margin to the forming limit {word}", f"at least {_percent(margin)}"
        yield Line(name, state, _percent(value), limit, note, field, at)


def _judge_thinning(summary: Summary) -> Iterator[Line]:
    """Judge thinning by the limit of the run, which is that of a sheet that has torn."""
    worst = summary.get("formability", {}).get("largest_thinning_percent")
    if not worst:
        return
    limit, at = summary.get("limits", {}).get("thinning", {}).get("limit"), tuple(worst["place"])
    state: State = "fail" if limit is not None and worst["value"] > 100.0 * limit else "figure"
    shown = _percent(limit) if state == "fail" else ""
    estimate = summary["formability"].get("one_step_thinning_percent")
    note = "" if estimate is None else f"one step estimated {estimate:.1f} %"
    yield Line("thinning", state, f"{worst['value']:.1f} %", shown, note, "thinning", at)


def _judge_wrinkles(summary: Summary) -> Iterator[Line]:
    """Judge that a sheet does not fold; the height of its waves is a figure."""
    found = summary.get("formability", {})
    if fold := found.get("largest_fold_ratio"):
        state: State = "fail" if found["folds"] else "ok"
        at = tuple(fold["place"]) if found["folds"] else ()
        yield Line("folds of the sheet", state, str(found["folds"]), "none", "", "fold_ratio", at)
    if wrinkles := summary.get("wrinkles"):
        yield Line("height of wrinkles", "figure", f"{_number(wrinkles['height_mm'])} mm", field="wrinkling_indicator")


def _judge_springback(summary: Summary) -> Iterator[Line]:
    """Judge springback by its tolerance."""
    found = summary.get("springback")
    if not found:
        return
    if judged := found.get("tolerance"):
        low, high = judged["band_mm"]
        state: State = "ok" if low <= judged["worst_mm"] <= high else "fail"
        at, limit = judged["at_mm"], f"{_number(low)} to {_number(high)} mm"
        note = f"{_percent(judged['share_within'])} of the part within"
        yield Line("springback", state, f"{_number(judged['worst_mm'])} mm", limit, note, "springback", tuple(at))
    else:
        at, figure = found.get("at_mm", ()), f"{_number(found['largest_mm'])} mm"
        yield Line("springback", "figure", figure, "", "", "springback", tuple(at))
    for name, point in found.get("gauge", {}).get("points", {}).items():
        within: State = "figure" if "within" not in point else "ok" if point["within"] else "fail"
        yield Line(f"deviation at {name}", within, f"{_number(point['deviation_mm'])} mm", field="springback")


def _judge_windows(summary: Summary) -> Iterator[Line]:
    """Judge the strain, rate and temperature at which the flow stress was used by the window that it was fitted in."""
    units, words = {"temperature": " °C", "rate": " 1/s"}, {"rate": "strain rate"}
    fields = {"temperature": "temperature", "strain": "equivalent_plastic_strain"}
    for material, windows in summary.get("law_windows", {}).items():
        for quantity, found in windows.items():
            below = 0.0 if quantity == "strain" else found["share_below"]  # metal that begins to yield is below it
            share, unit = below + found["share_above"], units.get(quantity, "")
            (low, high), (least, most) = found["window"], found["reached"]
            figure, limit = (f"{_number(a)} to {_number(b)}{unit}" for a, b in ((least, most), (low, high)))
            note = f"{100.0 * share:.3g} % of points and increments outside" if share else ""
            name = f"{words.get(quantity, quantity)} in the law of {material}"
            yield Line(name, "risk" if share >= FEW_OUTSIDE else "ok", figure, limit, note, fields.get(quantity, ""))


def _judge_limits(summary: Summary) -> Iterator[Line]:
    """Judge the measures beyond which a state is no longer physics."""
    for name, word in _NAMES.items():
        if known := summary.get("limits", {}).get(name):
            state, largest = _against(known["largest"], known["limit"]), known["largest"]
            figure = "none" if abs(largest) < ROUND_OFF else f"{largest:.3g}"
            fact = _join("" if state == "ok" else known["fact"], _when(known))
            yield Line(word, state, figure, _number(known["limit"]), fact, _FIELDS[name], (), known["time_s"])


def _judge_warnings(summary: Summary) -> Iterator[Line]:
    """Repeat the warnings of the run."""
    warnings = summary.get("warnings") or []
    if not warnings and summary.get("status") == "completed":
        yield Line("warnings of the run", "ok", "none")
    for warning in warnings:
        if warning != summary.get("verdict"):
            yield Line("warning", "risk", "", "", warning)
