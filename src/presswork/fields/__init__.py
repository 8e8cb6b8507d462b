# SPDX-License-Identifier: Apache-2.0
"""What the state means to an engineer: the quantities of the results."""
