# SPDX-License-Identifier: Apache-2.0
"""Files of every kind, changed at random, read in a process of their own: refused in words or taken, never a crash."""
