# SPDX-License-Identifier: Apache-2.0
"""Long runs against outside truth, and the programs that print their tables."""
