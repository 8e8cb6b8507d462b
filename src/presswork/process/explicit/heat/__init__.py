# SPDX-License-Identifier: Apache-2.0
"""Heat in explicit runs: it flows once an interval, of sheets and of solids."""
