// SPDX-License-Identifier: Apache-2.0
// An order of elimination for the nodes of a mesh in the plane that keeps a matrix's factors sparse.
//
// Nested dissection by coordinates: nodes are halved at the median across and along, what separates the halves comes
// last, and each half is treated alike (George 1973, SIAM J. Numer. Anal. 10). The separator is the least set of nodes
// that touches every edge between the halves, from a maximum matching of these edges (Koenig 1931). The order depends
// on coordinates and pattern alone. Assumption: edges join nodes that lie near each other.
#pragma once

#include <vector>

namespace presswork {

// The nodes in the order of elimination (n,). points (n, 2); indptr, indices: the pattern of a matrix whose rows are
// `freedoms` for each node, of which the entries behind the diagonal are used.
std::vector<int> dissect(const double* points, int n, const int* indptr, const int* indices, int freedoms);

}  // namespace presswork
