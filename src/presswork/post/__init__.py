# SPDX-License-Identifier: Apache-2.0
"""What is worked out from the results: nodal averages, the contact surface and its force, neutral radius, profiles."""

from presswork.post.contact_force import integrate_contact_force
from presswork.post.die_fill import DieFill, measure_die_fill
from presswork.post.draw_in import measure_draw_in_around, write_draw_in
from presswork.post.flange import FlangeFit, fit_flange
from presswork.post.formability import judge_cells, judge_part
from presswork.post.interface import Interface, order_along_boundary, trace_interface
from presswork.post.neutral_radius import NeutralRadius, find_neutral_radius
from presswork.post.nodal import average_to_nodes, cell_areas, count_corners
from presswork.post.outline import OutlineLoop, find_outline, trace_outline
from presswork.post.section import cut_sheet, cut_tool, measure_draw_in, write_section
from presswork.post.tool_profile import distance_to_profile, trace_profile

__all__ = [
    "DieFill",
    "FlangeFit",
    "Interface",
    "NeutralRadius",
    "OutlineLoop",
    "average_to_nodes",
    "cell_areas",
    "count_corners",
    "cut_sheet",
    "cut_tool",
    "distance_to_profile",
    "find_neutral_radius",
    "find_outline",
    "fit_flange",
    "integrate_contact_force",
    "judge_cells",
    "judge_part",
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
