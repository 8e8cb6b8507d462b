# SPDX-License-Identifier: Apache-2.0
"""Contact of solids in the plane with rigid tools."""
