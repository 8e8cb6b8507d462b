# SPDX-License-Identifier: Apache-2.0
"""Tools in the plane in a case: profiles, drawings, placement."""
