# SPDX-License-Identifier: Apache-2.0
"""Laws that follow the history of a material point: damage, grain size, phases."""
