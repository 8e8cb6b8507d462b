# SPDX-License-Identifier: Apache-2.0
"""What a recording remembers from its start to its end, through meshes, operations and resumption."""
