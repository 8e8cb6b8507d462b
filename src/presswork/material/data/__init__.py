# SPDX-License-Identifier: Apache-2.0
"""The material files that ship with presswork."""
