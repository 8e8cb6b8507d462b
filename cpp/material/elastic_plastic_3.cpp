// SPDX-License-Identifier: Apache-2.0
#include "material/elastic_plastic_update.hpp"

namespace presswork {

template bool update(const SheetLaw&, const LawInput<3, double>&, const double*, double*, double (*)[3]);
template Mask<Pack> update(const SheetLaw&, const LawInput<3, Pack>&, const Pack*, Pack*, Pack (*)[3]);
template void update_points(const SheetLaw&, std::size_t, const double*, double, const double*, const double*, double*,
                            double*, double*, double*, std::uint8_t*, bool);
template void differentiate_points(const SheetLaw&, std::size_t, const double*, double, const double*, const double*,
                                   const double*, const double*, double*);

}  // namespace presswork
