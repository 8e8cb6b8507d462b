# SPDX-License-Identifier: Apache-2.0
"""Pictures of the results, with matplotlib: pip install "presswork[plot]"."""

from presswork.view.all_plots import FIELDS, SHELL_FIELDS, plot_all
from presswork.view.forming_limit_plot import plot_forming_limit
from presswork.view.history_plot import plot_history
from presswork.view.interface_plot import plot_interface
from presswork.view.mesh_plot import plot_contours, plot_mesh, plot_mesh_and_contours
from presswork.view.outline_plot import plot_outline

__all__ = [
    "FIELDS",
    "SHELL_FIELDS",
    "plot_all",
    "plot_contours",
    "plot_forming_limit",
    "plot_history",
    "plot_interface",
    "plot_mesh",
    "plot_mesh_and_contours",
    "plot_outline",
]
