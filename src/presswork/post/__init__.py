# SPDX-License-Identifier: Apache-2.0
"""What is worked out from the results: nodal averages, the contact surface, tool profiles."""

from presswork.post.interface import Interface, order_along_boundary, trace_interface
from presswork.post.nodal import average_to_nodes, cell_areas, count_corners
from presswork.post.tool_profile import distance_to_profile, trace_profile

__all__ = [
    "Interface",
    "average_to_nodes",
    "cell_areas",
    "count_corners",
    "distance_to_profile",
    "order_along_boundary",
    "trace_interface",
    "trace_profile",
]
