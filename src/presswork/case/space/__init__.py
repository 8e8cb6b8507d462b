# SPDX-License-Identifier: Apache-2.0
"""The case of a solid in space, and the builders that turn it into the Model."""
