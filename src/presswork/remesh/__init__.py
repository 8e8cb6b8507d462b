# SPDX-License-Identifier: Apache-2.0
"""New meshes for a deforming section: its boundary, its inside, and what the old mesh knew carried to the new one."""
