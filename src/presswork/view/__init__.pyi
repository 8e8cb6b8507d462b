# SPDX-License-Identifier: Apache-2.0
from .all_plots import FIELDS, SHELL_FIELDS, plot_all
from .animation import animate
from .die_stress_plot import plot_die_stress
from .flow_lines_plot import plot_flow_lines
from .forming_limit_plot import plot_forming_limit
from .history_plot import plot_history, plot_stress_strain
from .interface_plot import plot_interface
from .mesh_plot import plot_contours, plot_mesh, plot_mesh_and_contours
from .outline_plot import plot_outline

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
