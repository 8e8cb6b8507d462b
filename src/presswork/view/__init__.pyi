# SPDX-License-Identifier: Apache-2.0
from .all_plots import FIELDS, SHELL_FIELDS, plot_all
from .animation import animate
from .plots.die_stress_plot import plot_die_stress
from .plots.flow_lines_plot import plot_flow_lines
from .plots.forming_limit_plot import plot_forming_limit
from .plots.history_plot import plot_history, plot_stress_strain
from .plots.interface_plot import plot_interface
from .plots.mesh_plot import plot_contours, plot_mesh, plot_mesh_and_contours
from .plots.outline_plot import plot_outline

__all__ = [
    "FIELDS",
    "SHELL_FIELDS",
    "animate",
    "plot_all",
    "plot_contours",
    "plot_die_stress",
    "plot_flow_lines",
    "plot_forming_limit",
    "plot_history",
    "plot_interface",
    "plot_mesh",
    "plot_mesh_and_contours",
    "plot_outline",
    "plot_stress_strain",
]
