# SPDX-License-Identifier: Apache-2.0
"""Contact of bodies with each other and with themselves."""
