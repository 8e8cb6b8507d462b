# SPDX-License-Identifier: Apache-2.0
"""Materials in a case."""
