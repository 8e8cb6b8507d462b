# SPDX-License-Identifier: Apache-2.0
"""Contact of solids and sheets in space with rigid tools."""
