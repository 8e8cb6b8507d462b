# SPDX-License-Identifier: Apache-2.0
"""One run on several processes (ranks) that `mpiexec` starts: which rank holds what, and what they exchange.

Only world.py imports MPI, and only in a process that mpiexec has started.
"""
