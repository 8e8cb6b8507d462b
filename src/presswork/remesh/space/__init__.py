# SPDX-License-Identifier: Apache-2.0
"""New meshes for a deforming body of tetrahedra: its skin, its inside, and where the new skin lies on the old one."""
