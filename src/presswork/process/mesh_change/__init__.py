# SPDX-License-Identifier: Apache-2.0
"""What a change of the mesh is made of: its reasons, how the mesh is made, and how the state is carried to it."""
