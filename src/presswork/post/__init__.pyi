# SPDX-License-Identifier: Apache-2.0
from .contact_force import integrate_contact_force
from .die_fill import DieFill, measure_die_fill
from .die_stress import DieStress, find_die_stress
from .draw_in import measure_draw_in_around, write_draw_in
from .flange import FlangeFit, fit_flange
from .formability import judge_cells, judge_part
from .interface import Interface, order_along_boundary, trace_interface
from .neutral_radius import NeutralRadius, find_neutral_radius
from .nodal import average_to_nodes, cell_areas
from .outline import OutlineLoop, find_outline, trace_outline
from .section import cut_sheet, cut_tool, measure_draw_in, write_section
from .skin import find_skin
from .tool_profile import distance_to_profile, trace_profile
from .verdict import Line, RunVerdict, judge_result, judge_summary

__all__ = [
    "DieFill",
    "DieStress",
    "FlangeFit",
    "Interface",
    "Line",
    "NeutralRadius",
    "OutlineLoop",
    "RunVerdict",
    "average_to_nodes",
    "cell_areas",
    "cut_sheet",
    "cut_tool",
    "distance_to_profile",
    "find_die_stress",
    "find_neutral_radius",
    "find_outline",
    "find_skin",
    "fit_flange",
    "integrate_contact_force",
    "judge_cells",
    "judge_part",
    "judge_result",
    "judge_summary",
    "measure_die_fill",
    "measure_draw_in",
    "measure_draw_in_around",
    "order_along_boundary",
    "trace_interface",
    "trace_outline",
    "trace_profile",
    "write_draw_in",
    "write_section",
]
