// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/hanging.hpp"

#include <algorithm>
#include <cmath>

namespace presswork::explicit_dynamics {

namespace {

double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

}  // namespace

template <class Real>
void HangingNodes<Real>::set(Nodes& nodes, std::vector<HangingNode> hanging) {
  const int n_nodes = nodes.n;
  std::vector<char> hangs(hanging.empty() ? 0 : n_nodes, 0);
  auto check = [&](int node) {
    if (node < 0 || node >= n_nodes) throw std::invalid_argument("a hanging node names a node that is not there");
  };
  for (const HangingNode& h : hanging) {
    check(h.node), check(h.end[0]), check(h.end[1]);
    for (int node : h.across) check(node);
    hangs[h.node] = 1;
  }
  std::vector<std::vector<int>> entries(n_nodes);
  for (std::size_t i = 0; i < hanging.size(); ++i)
    for (int k = 0; k < 2; ++k) {
      if (hangs[hanging[i].end[k]]) throw std::invalid_argument("the end of a hanging node's side hangs itself");
      entries[hanging[i].end[k]].push_back(static_cast<int>(2 * i) + k);
    }
  end_.clear(), end_entry_.clear(), end_start_.assign(1, 0);
  for (int node = 0; node < n_nodes; ++node) {
    if (entries[node].empty()) continue;
    end_.push_back(node);
    end_entry_.insert(end_entry_.end(), entries[node].begin(), entries[node].end());
    end_start_.push_back(static_cast<int>(end_entry_.size()));
  }
  hanging_ = std::move(hanging), hangs_ = std::move(hangs), nodes.follows = hangs_;
  side_.assign(hanging_.size(), {}), given_.assign(hanging_.size(), {});
}

template <class Real>
void HangingNodes<Real>::share_masses(std::vector<double>& sum) {
  for (const HangingNode& h : hanging_) {
    double* own = &sum[2 * std::size_t(h.node)];
    for (int node : h.end) {
      sum[2 * std::size_t(node)] += 0.5 * own[0];
      sum[2 * std::size_t(node) + 1] += 2.0 * own[1];
    }
    own[0] = own[1] = 0.0;
  }
}

template <class Real>
void HangingNodes<Real>::measure(const Nodes& nodes, int first, int last) {
  auto at = [&](int node) { return nodes.position.data() + std::size_t(Nodes::position_stride) * node; };
  for (int s = first; s < last; ++s) {
    const HangingNode& h = hanging_[s];
    Side& side = side_[s];
    const double *x1 = at(h.end[0]), *x2 = at(h.end[1]), *xm = at(h.node);
    double across[3];
    for (int i = 0; i < 3; ++i) {
      side.along[i] = x2[i] - x1[i];
      side.height[i] = xm[i] - 0.5 * (x1[i] + x2[i]);
      across[i] = (at(h.across[0])[i] + at(h.across[1])[i]) - (at(h.across[2])[i] + at(h.across[3])[i]);
    }
    cross(side.along, across, side.normal);
    const double over = 1.0 / std::sqrt(dot(side.normal, side.normal));
    for (double& x : side.normal) x *= over;
  }
}

template <class Real>
double HangingNodes<Real>::carry(Nodes& nodes, double dt, int first, int last) const {
  auto motion = [&](int node) { return nodes.motion.data() + std::size_t(Nodes::motion_stride) * node; };
  double fastest = 0.0;
  for (int s = first; s < last; ++s) {
    const HangingNode& h = hanging_[s];
    const Side& side = side_[s];
    const Real *one = motion(h.end[0]), *two = motion(h.end[1]);
    double turn[3], bend[3], lift[3], sag[3];
    for (int i = 0; i < 3; ++i) {
      turn[i] = 0.5 * (double(one[3 + i]) + double(two[3 + i]));
      bend[i] = double(one[3 + i]) - double(two[3 + i]);
    }
    cross(turn, side.height, lift), cross(bend, side.along, sag);
    const double deflection = 0.125 * dot(side.normal, sag);
    Real* to = motion(h.node);
    double* x = nodes.position.data() + std::size_t(Nodes::position_stride) * h.node;
    double squared = 0.0;
    for (int i = 0; i < 3; ++i) {
      to[i] = static_cast<Real>(0.5 * (double(one[i]) + double(two[i])) + lift[i] + deflection * side.normal[i]);
      to[3 + i] = static_cast<Real>(turn[i]);
      x[i] += dt * to[i];
      squared += double(to[i]) * to[i];
    }
    fastest = std::max(fastest, squared);
  }
  return fastest;
}

template <class Real>
void HangingNodes<Real>::take_forces(Nodes& nodes, int first, int last) {
  measure(nodes, first, last);
  for (int s = first; s < last; ++s) {
    const Side& side = side_[s];
    Real* own = nodes.internal_force.data() + row_at(hanging_[s].node);
    const double f[3] = {own[0], own[1], own[2]};
    double lifted[3], lever[3];
    cross(side.height, f, lifted), cross(side.along, side.normal, lever);
    const double sag = 0.125 * dot(f, side.normal);
    Given& given = given_[s];
    for (int i = 0; i < 3; ++i) {
      given.force[i] = 0.5 * f[i];
      const double shared = 0.5 * (own[3 + i] + lifted[i]);
      given.moment[0][i] = shared + sag * lever[i], given.moment[1][i] = shared - sag * lever[i];
    }
    for (int i = 0; i < freedoms; ++i) own[i] = Real(0);
  }
}

template <class Real>
void HangingNodes<Real>::give_forces(Nodes& nodes, int first, int last) const {
  for (int e = first; e < last; ++e) {
    double sum[freedoms] = {};
    for (int s = end_start_[e]; s < end_start_[e + 1]; ++s) {
      const Given& given = given_[end_entry_[s] / 2];
      for (int i = 0; i < 3; ++i) sum[i] += given.force[i], sum[3 + i] += given.moment[end_entry_[s] % 2][i];
    }
    Real* to = nodes.internal_force.data() + row_at(end_[e]);
    for (int i = 0; i < freedoms; ++i) to[i] += static_cast<Real>(sum[i]);
  }
}

template class HangingNodes<double>;
template class HangingNodes<float>;

}  // namespace presswork::explicit_dynamics
