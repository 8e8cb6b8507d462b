# SPDX-License-Identifier: Apache-2.0
"""Meshes of hexahedra of bodies with an axis or with one outline at every height."""
