# SPDX-License-Identifier: Apache-2.0
"""Tables of cases of steel at 1150 degrees C under a crank press."""

HOT_PRESS = """
[materials.steel]
library = "medium_carbon_steel_hot"
density = "7850 kg/m^3"
thermal = { conductivity = 30, specific_heat = "650 J/(kg*K)" }

[heat]
initial_temperature = "1150 °C"
surroundings = { ambient = 20, emissivity = 0.8, coefficient = "10 W/(m^2*K)" }

[presses.maxi]
kind = "crank"
stroke = 200
rpm = 90
rod_ratio = 0.12
"""
