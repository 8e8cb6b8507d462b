// SPDX-License-Identifier: Apache-2.0
#include "material/elastic_plastic_update.hpp"

namespace presswork {

template bool update(const PlaneLaw&, const LawInput<4, double>&, const double*, double*, double (*)[4]);
template Mask<Pack> update(const PlaneLaw&, const LawInput<4, Pack>&, const Pack*, Pack*, Pack (*)[4]);
template void update_points(const PlaneLaw&, std::size_t, const double*, double, const double*, const double*, double*,
                            double*, double*, double*, std::uint8_t*, bool);
template void differentiate_points(const PlaneLaw&, std::size_t, const double*, double, const double*, const double*,
                                   const double*, const double*, double*);

}  // namespace presswork
