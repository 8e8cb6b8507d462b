# SPDX-License-Identifier: Apache-2.0
"""The pictures that `presswork plot` writes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast

import numpy as np

from presswork.fields.formability_fields import FORMABILITY_FIELDS
from presswork.fields.surface_defects import SURFACE_FIELDS
from presswork.formability import PATH_MARGINS, POLAR
from presswork.post.draw_in import write_draw_in
from presswork.post.section import write_section
from presswork.post.springback import find_formed_step
from presswork.results import Result, ResultError
from presswork.results.folder import PLOTS, refuse_link
from presswork.view.crack_mark import find_judged_damage
from presswork.view.mirror import Mirror
from presswork.view.plots.blank_plot import plot_blank
from presswork.view.plots.die_plot import plot_dies, plot_parts
from presswork.view.plots.die_stress_plot import plot_die_stress
from presswork.view.plots.flow_lines_plot import flow_panel_size, has_remeshed, is_section, plot_flow_lines
from presswork.view.plots.forming_limit_plot import plot_forming_limit
from presswork.view.plots.history_plot import (
    find_dies,
    find_energies,
    find_moved_sets,
    find_moving_tools,
    find_turning_tools,
    plot_energies,
    plot_history,
    plot_stress_strain,
    stress_strain,
)
from presswork.view.plots.interface_plot import plot_interface
from presswork.view.plots.marked_points_plot import find_points, plot_points
from presswork.view.plots.mesh_plot import panel_size, plot_mesh, plot_mesh_and_contours
from presswork.view.plots.operation_plot import list_operations, plot_operation
from presswork.view.plots.outline_plot import plot_outline
from presswork.view.plots.press_plot import has_ram, plot_ram
from presswork.view.plots.section_plot import is_drawn_in, plot_draw_in, plot_section
from presswork.view.plots.shell_plot import plot_shell
from presswork.view.plots.springback_plot import plot_springback
from presswork.view.plots.temperature_plot import find_widest_step, has_temperatures, plot_temperatures
from presswork.view.plots.wear_plot import find_worn_tools, plot_wear
from presswork.view.style import bare_figure, create_folder, is_released, require_matplotlib, save_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIELDS = ("effective_stress", "equivalent_plastic_strain")
SHELL_FIELDS = (*FIELDS, "thickness_strain", "major_strain_top", "minor_strain_top")
STAMPING_FIELDS = (
    "thickness_strain", "equivalent_plastic_strain", "thinning", "formability_zone", POLAR, *SURFACE_FIELDS,
)  # fmt: skip
"""Zones and margin if the run knows a forming limit."""
OF_FORMABILITY = (*FORMABILITY_FIELDS, *PATH_MARGINS)
NOT_ALWAYS = (*OF_FORMABILITY, *SURFACE_FIELDS)
"""Fields that results of other materials, or older ones, do not have."""
ONESTEP_FIELDS = ("thickness_strain", "equivalent_plastic_strain", "thinning", "formability_zone")
SPRINGBACK_FIELDS = ("springback", "deviation")
"""Displacement of springback; distance from the shape in the tools."""
MICROSTRUCTURE = ("grain_size", "recrystallised_fraction")
HEATED_FIELDS = ("temperature", "martensite", "hardness")
"""Fields of a sheet with a temperature, and of one that transforms."""
TEMPERATURE = "temperature"
"""Field of a solid that plastic work heats."""
NODAL_TEMPERATURE = "nodal_temperature"
"""Field of bodies that conduct heat."""


def plot_all(
    result: Result,
    out_dir: Path | str | None = None,
    fields: Sequence[str] | None = None,
    steps: Literal["last"] | Sequence[int] = "last",
    *,
    mirror: Mirror = "",
    sections: Sequence[tuple[float, float, float]] = (),
    flow_lines: bool | None = None,
) -> list[Path]:
    """Write the pictures of a run as PNG and return their paths.

    For each field and step: contours beside the mesh, and the mesh coloured by the field; for a shell or a solid in
    space one picture in space. For each moving tool: force against stroke, and one more for each operation where stages
    place tools anew; without one, for each set that is moved: reaction against displacement, and nominal stress against
    nominal strain. For each tool in contact: contact stress along the contact surface, in space on the tool. For
    dynamics and stampings: energies against time; for a stamping the section along x, the outline from above with the
    draw-in in every direction, also as CSV, draw-in against stroke, and the whole part, mirrored by its symmetry
    planes. For a sheet with a forming limit: the forming limit diagram. For a press: force and speed of the ram over
    stroke and time. For a tool that wears: where, and how deep. `fields` are by default FIELDS, and TEMPERATURE if it
    was saved, of a shell SHELL_FIELDS, of a stamping STAMPING_FIELDS, of a one-step run ONESTEP_FIELDS, of heat alone
    NODAL_TEMPERATURE, at the last step and at the one with the widest range, and damage that has a critical value, and
    MICROSTRUCTURE; `out_dir` is the folder "plots" in the output folder. sections: x, y of where a section begins [mm],
    and its angle from x [degree]; each is drawn, and its thickness written as CSV. flow_lines: whether to draw the
    grain flow of a section; None: of one that got a new mesh in the run. Raises ResultError for an unknown field or
    step, and for sections of what is no sheet, before anything is written.
    """
    require_matplotlib()
    from matplotlib import rc_context

    if out_dir is None:
        refuse_link(result.folder / PLOTS)
    with result.kept_open(), rc_context({"axes.titley": 1.0}):  # so that no axes looks for room above their ticks
        return _plot_all(result, result.folder / PLOTS if out_dir is None else Path(out_dir), fields, steps, mirror,
                         sections, flow_lines)  # fmt: skip


def _plot_all(
    result: Result,
    folder: Path,
    fields: Sequence[str] | None,
    steps: Literal["last"] | Sequence[int],
    mirror: Mirror,
    sections: Sequence[tuple[float, float, float]],
    flow_lines: bool | None,
) -> list[Path]:
    """Write the pictures, as in plot_all."""
    chosen = [-1] if steps == "last" else list(steps)
    if steps == "last" and FIELDS[0] not in result.field_names and NODAL_TEMPERATURE in result.field_names:
        chosen = sorted({find_widest_step(result), len(result.times) - 1})
    if fields is None:
        fields = [name for name in default_fields(result) if name in result.field_names or name not in NOT_ALWAYS]
        fields = [name for name in fields if name in OF_FORMABILITY or _is_nonzero(result, name, chosen)]
    for step in chosen:
        for field in fields:
            result.field(field, step)
    if sections and not result.is_shell:
        raise ResultError(f"{result.folder} holds no sheet that a section could cut")
    if flow_lines and not is_section(result):
        raise ResultError(f"{result.folder} holds no section with grain flow; the page of the run draws lines in space")
    create_folder(folder)
    paths: list[Path] = []
    if (result.is_stamping or result.is_onestep) and not mirror:
        mirror = cast(Mirror, result.info.get("symmetry", ""))
    for step in (step % len(result.times) for step in chosen):
        paths += _plot_stamping(result, step, folder) if result.is_stamping else []
        for section in sections:
            paths.append(_draw_section(result, section, step, folder))
        if result.formability.curve is not None:
            figure = plot_forming_limit(result, step, figure=bare_figure())
            figure.set_size_inches(7.0, 5.2)
            paths.append(save_picture(figure, folder / f"forming_limit_{step:03d}.png"))
        if is_section(result) and has_remeshed(result) if flow_lines is None else flow_lines:
            paths.append(save_picture(_draw_flow_lines(result, step, mirror), folder / f"flow_lines_{step:03d}.png"))
        for field in fields:
            paths += _plot_field(result, field, step, mirror, folder)
        if result.is_space_solid and "contact_traction" in result.field_names:
            whole = mirror or cast(Mirror, result.info.get("symmetry", ""))
            for tool in result.tools_at_work(step):
                figure = plot_die_stress(result, tool, step, mirror=whole, figure=bare_figure())
                paths.append(save_picture(figure, folder / f"die_stress_{tool}_{step:03d}.png"))
    if result.is_onestep:
        return [*paths, save_picture(plot_blank(result, mirror=mirror, figure=bare_figure()), folder / "blank.png")]
    return [*paths, *_plot_histories(result, folder), *_plot_interfaces(result, folder, steps)]


def _plot_stamping(result: Result, step: int, folder: Path) -> list[Path]:
    """Write section, outline and draw-in of a stamping at a step, and how it has sprung."""
    figure = plot_section(result, 0.0, step, figure=bare_figure())
    figure.set_size_inches(7.0, 6.0)
    paths = [save_picture(figure, folder / f"section_{step:03d}.png")]
    paths.append(save_picture(plot_outline(result, step, figure=bare_figure()), folder / f"outline_{step:03d}.png"))
    write_draw_in(result, folder / f"draw_in_{step:03d}.csv", step)
    if is_released(result, step) and _has_formed_step(result, step):
        figure = plot_springback(result, 0.0, step, figure=bare_figure())
        figure.set_size_inches(7.4, 4.8)
        paths.append(save_picture(figure, folder / f"springback_section_{step:03d}.png"))
    return paths


def _plot_field(result: Result, field: str, step: int, mirror: Mirror, folder: Path) -> list[Path]:
    """Write a field at a step: of a section on its mesh and as contours."""
    if result.is_shell or result.is_space_solid:
        figure = plot_shell(result, field, step, mirror=mirror, figure=bare_figure())
        kind = "shell" if result.is_shell else "solid"
        return [save_picture(figure, folder / f"{kind}_{field}_{step:03d}.png")]
    contours = plot_mesh_and_contours(result, field, step, mirror=mirror, figure=bare_figure())
    return [
        save_picture(contours, folder / f"contours_{field}_{step:03d}.png"),
        save_picture(_draw_mesh(result, field, step, mirror), folder / f"mesh_{field}_{step:03d}.png"),
    ]


def _plot_histories(result: Result, folder: Path) -> list[Path]:
    """Write the curves of the history."""
    paths = [*_plot_forces(result, folder), *_plot_energies(result, folder), *_plot_temperatures(result, folder)]
    if find_points(result.history) and len(result.history["time"]):
        paths.append(save_picture(plot_points(result, bare_figure()), folder / "points.png"))
    for die in find_dies(result.history):
        figure = bare_figure()
        plot_history(result, y=f"{die}.fill", ax=figure.subplots())
        paths.append(save_picture(figure, folder / f"fill_{die}.png"))
    if has_ram(result.history):
        figure = bare_figure()
        figure.set_size_inches(9.6, 4.2)
        paths.append(save_picture(plot_ram(result, figure), folder / "press.png"))
    for tool in find_worn_tools(result):
        paths.append(save_picture(plot_wear(result, tool), folder / f"wear_{tool}.png"))
    if result.surfaces and len(result.times) > 1 and is_drawn_in(result):
        paths.append(save_picture(plot_draw_in(result, figure=bare_figure()), folder / "draw_in.png"))
    return paths


def default_fields(result: Result) -> Sequence[str]:
    """Return the fields that plot_all draws of such a result."""
    more = [*find_judged_damage(result), *(name for name in MICROSTRUCTURE if name in result.field_names)]
    if result.is_stamping:
        others = (*SPRINGBACK_FIELDS, *HEATED_FIELDS)
        return (*STAMPING_FIELDS, *(name for name in others if name in result.field_names), *more)
    if result.is_onestep:
        return ONESTEP_FIELDS
    if result.is_shell:
        return (*SHELL_FIELDS, *more)
    fields = FIELDS if FIELDS[0] in result.field_names else ()
    temperature = NODAL_TEMPERATURE if NODAL_TEMPERATURE in result.field_names else TEMPERATURE
    return (*fields, *(name for name in (temperature,) if name in result.field_names), *more)


def _is_nonzero(result: Result, field: str, steps: Sequence[int]) -> bool:
    """Return whether a field is anything but zero throughout, as plastic strain is in an elastic sheet."""
    return any(bool(result.field(field, step).any()) for step in steps)


def _has_formed_step(result: Result, step: int) -> bool:
    """Return whether a step before springback was saved on the same mesh."""
    try:
        find_formed_step(result, step)
    except ResultError:
        return False
    return True


def _draw_section(result: Result, section: tuple[float, float, float], step: int, folder: Path) -> Path:
    """Draw one section, and write its thickness beside the picture."""
    x, y, angle = section
    path = folder / f"section_{x:g}_{y:g}_{angle:g}_{step:03d}.png"
    figure = plot_section(result, angle, step, start=(x, y), figure=bare_figure())
    figure.set_size_inches(7.0, 6.0)
    write_section(result, path.with_suffix(".csv"), float(np.radians(angle)), step, start=(x, y))
    return save_picture(figure, path)


def _plot_forces(result: Result, folder: Path) -> list[Path]:
    """Write force against stroke, if a tool has moved; force and torque against angle, if one has turned; beside tools
    the reaction of every set that is moved; else these together, and nominal stress against nominal strain.
    """
    turning = find_turning_tools(result.history)
    if not (turning or find_moving_tools(result.history)):
        return _plot_reactions(result, folder)
    figure = bare_figure()
    plot_history(result, ax=figure.subplots())
    paths = [save_picture(figure, folder / ("force_angle.png" if turning else "force_stroke.png"))]
    for operation in list_operations(result):
        figure = bare_figure()
        plot_operation(result, operation, figure.subplots())
        paths.append(save_picture(figure, folder / f"force_stroke_{operation.file_name}.png"))
    for tool in turning:
        figure = bare_figure()
        plot_history(result, y=f"{tool}.torque", ax=figure.subplots())
        paths.append(save_picture(figure, folder / f"torque_{tool}.png"))
    for _, reaction in find_moved_sets(result.history):
        figure = bare_figure()
        plot_history(result, y=reaction, ax=figure.subplots())
        paths.append(save_picture(figure, folder / f"{reaction.replace('.', '_')}.png"))
    return paths


def _plot_reactions(result: Result, folder: Path) -> list[Path]:
    """Write what moved sets take, and the curve of a tension test."""
    if not find_moved_sets(result.history):
        return []
    figure = bare_figure()
    plot_history(result, ax=figure.subplots())
    paths = [save_picture(figure, folder / "force_displacement.png")]
    for name in stress_strain(result):
        figure = bare_figure()
        plot_stress_strain(result, name, ax=figure.subplots())
        paths.append(save_picture(figure, folder / f"stress_strain_{name}.png"))
    return paths


def _plot_energies(result: Result, folder: Path) -> list[Path]:
    """Write the energies against time, if a run has them and has come as far as its first row."""
    history = result.history
    if not find_energies(history) or len(history["time"]) == 0:
        return []
    figure = bare_figure()
    plot_energies(result, figure.subplots())
    return [save_picture(figure, folder / "energies.png")]


def _plot_temperatures(result: Result, folder: Path) -> list[Path]:
    """Write the temperatures against time, if a run has computed them."""
    if not has_temperatures(result.history):
        return []
    figure = bare_figure()
    plot_temperatures(result, figure.subplots())
    paths = [save_picture(figure, folder / "temperature_time.png")]
    if result.dies():
        step = len(result.times) - 1
        paths.append(save_picture(plot_dies(result, figure=bare_figure()), folder / f"dies_{step:03d}.png"))
    if "part" in result.history:
        paths.append(save_picture(plot_parts(result, bare_figure()), folder / "parts.png"))
    return paths


def _plot_interfaces(result: Result, folder: Path, steps: Literal["last"] | Sequence[int]) -> list[Path]:
    """Write the contact stress of every tool that the body touches, if it was saved, at these steps or at six."""
    if not {"contact_pressure", "contact_shear"} <= set(result.field_names):
        return []
    chosen = None if steps == "last" else steps
    figures = {tool: plot_interface(result, tool, chosen, figure=bare_figure()) for tool in result.tools}
    return [
        save_picture(figure, folder / f"interface_{tool}.png")
        for tool, figure in figures.items()
        if figure.axes[0].lines
    ]


def _draw_flow_lines(result: Result, step: int, mirror: Mirror) -> Figure:
    """Draw the grain flow."""
    figure = bare_figure()
    figure.set_size_inches(*flow_panel_size(result, step, mirror))
    plot_flow_lines(result, step, figure.subplots(), mirror=mirror)
    return figure


def _draw_mesh(result: Result, field: str, step: int, mirror: Mirror) -> Figure:
    """Draw the mesh coloured by a field."""
    figure = bare_figure()
    figure.set_size_inches(*panel_size(result, step, mirror))
    plot_mesh(result, field, step, figure.subplots(), mirror=mirror)
    return figure
