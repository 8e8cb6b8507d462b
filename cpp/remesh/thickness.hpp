// SPDX-License-Identifier: Apache-2.0
// How thick a body in space is beneath the faces of its skin.
#pragma once

namespace presswork {

// The distance along the normal of the nearest face that looks the other way, infinite beyond reach (n,) [mm].
//
// middle (n, 3) [mm] and normal (n, 3), outwards, of the faces; radius (n,) [mm]: of the circles round their middles
// that hold them. A face lies beneath another where their circles meet when looked at along the normal; it looks the
// other way where the cosine between the normals is below -opposite.
void measure_thickness(const double* middle, const double* normal, const double* radius, int n, double reach,
                       double opposite, double* thickness);

}  // namespace presswork
