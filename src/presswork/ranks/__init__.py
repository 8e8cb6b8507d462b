# SPDX-License-Identifier: Apache-2.0
"""One run on several processes (ranks) that `mpiexec` starts: who holds what, and what they tell each other.

Only world.py imports MPI, and only in a process that mpiexec has started.
"""
