// SPDX-License-Identifier: Apache-2.0
#include "material/elastic_plastic_update.hpp"

namespace presswork {

template bool update(const SolidLaw&, const LawInput<6, double>&, const double*, double*, double (*)[6]);
template Mask<Pack> update(const SolidLaw&, const LawInput<6, Pack>&, const Pack*, Pack*, Pack (*)[6]);
template void update_points(const SolidLaw&, std::size_t, const double*, double, const double*, const double*, double*,
                            double*, double*, double*, std::uint8_t*, bool);
template void differentiate_points(const SolidLaw&, std::size_t, const double*, double, const double*, const double*,
                                   const double*, const double*, double*);

}  // namespace presswork
