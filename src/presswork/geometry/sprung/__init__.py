# SPDX-License-Identifier: Apache-2.0
"""A sheet as formed and after springback: places of it in sections and below points, turn, twist, walls, gauge."""
