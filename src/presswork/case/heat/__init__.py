# SPDX-License-Identifier: Apache-2.0
"""Heat in a case: thermal properties of materials, films, and the case of heating and cooling without forming."""
