# SPDX-License-Identifier: Apache-2.0
"""Heat that surfaces exchange with tools and surroundings."""
