# SPDX-License-Identifier: Apache-2.0
"""Stress of a tool's body after a run: its mesh, the loads that the workpiece hands over, elasticity, safety."""
