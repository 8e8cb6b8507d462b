// SPDX-License-Identifier: Apache-2.0
#include "material/umat.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "material/gtn.hpp"

namespace presswork {

namespace {

constexpr int guard = 64;  // doubles behind the properties and the state variables
const double none = std::numeric_limits<double>::quiet_NaN();
constexpr double unwritten = 4.9e-320;  // behind stress and tangent: a number that no routine leaves by chance

struct Stopped {};

bool all_finite(const double* values, int n) {
  return std::all_of(values, values + n, [](double v) { return std::isfinite(v); });
}

bool is_all(double expected, const double* values, int n) {
  return std::all_of(values, values + n, [&](double v) { return std::memcmp(&v, &expected, sizeof v) == 0; });
}

// From xx, yy, zz, xy, yz, zx to Abaqus's order, and back.
void swap_last_shears(int n, double* values) {
  if (n == 6) std::swap(values[4], values[5]);
}

// Lets a library that is opened find xit_ and the others below, as it finds them in Abaqus.
void offer_utilities() {
  Dl_info self;
  if (dladdr(reinterpret_cast<void*>(&offer_utilities), &self) && self.dli_fname)
    dlopen(self.dli_fname, RTLD_NOW | RTLD_NOLOAD | RTLD_GLOBAL);
}

}  // namespace

Umat::Umat(const std::string& library, const std::vector<double>& properties, int n_state, UmatJacobian jacobian,
           bool thread_safe, int plastic_strain)
    : n_state(n_state),
      jacobian(jacobian),
      thread_safe(thread_safe),
      plastic_strain(plastic_strain),
      properties_(properties),
      n_properties_(static_cast<int>(properties.size())) {
  offer_utilities();
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) throw std::runtime_error(dlerror());
  library_ = std::shared_ptr<void>(handle, [](void* open) { dlclose(open); });
  function_ = reinterpret_cast<UmatFunction>(dlsym(handle, "umat_"));
  if (!function_) throw std::runtime_error("it has no routine UMAT (symbol umat_)");
  using Sizes = void (*)(int*, int*);
  if (auto sizes = reinterpret_cast<Sizes>(dlsym(handle, "umat_sizes_"))) {
    int n_props = 0, n_statev = 0;
    sizes(&n_props, &n_statev);
    if (n_props != n_properties_)
      throw std::runtime_error("it wants " + std::to_string(n_props) + " properties, not " +
                               std::to_string(n_properties_));
    if (n_statev != n_state)
      throw std::runtime_error("it wants " + std::to_string(n_statev) + " state variables, not " +
                               std::to_string(n_state));
  }
  state = n_state > 0 ? History{{"state_variables", n_state}} : History{};
  using Declared = const StatePart* (*)(int*);
  if (auto declare = reinterpret_cast<Declared>(dlsym(handle, "presswork_state"))) {
    int count = 0, values = 0;
    const StatePart* parts = declare(&count);
    state.clear();
    for (int i = 0; i < count; ++i) {
      state.push_back({parts[i].name, parts[i].size, parts[i].is_axes});
      values += parts[i].size;
    }
    if (values != n_state)
      throw std::runtime_error("its parts of the state have " + std::to_string(values) + " values, not " +
                               std::to_string(n_state));
  }
  properties_.insert(properties_.end(), guard, none);
}

namespace {

void call_gtn(double* stress, double* statev, double* ddsdde, double*, double*, double*, double*, double*, double*,
              double*, const double*, const double* dstran, const double*, const double* dtime, const double* temp,
              const double* dtemp, const double*, const double*, const char*, const int*, const int*, const int* ntens,
              const int*, const double* props, const int*, const double*, const double* drot, double* pnewdt,
              const double*, const double*, const double*, const int*, const int*, const int*, const int*, const int*,
              const int*, std::size_t) {
  double given[Gtn::n_properties + 1];
  std::copy_n(props, Gtn::n_properties, given);
  given[Gtn::n_properties] = *temp + *dtemp;
  user_law::call<Gtn>(*ntens, stress, statev, ddsdde, dstran, *dtime, given, drot, pnewdt);
}

}  // namespace

Umat Umat::make_gtn(const std::vector<double>& properties) {
  if (properties.size() != Gtn::n_properties) throw std::runtime_error("a law of pores has 20 properties");
  Umat made;
  made.n_state = Gtn::n_state;
  for (const StatePart& part : Gtn::state_parts) made.state.push_back({part.name, part.size, part.is_axes});
  made.function_ = &call_gtn;
  made.properties_ = properties;
  made.n_properties_ = Gtn::n_properties;
  made.properties_.insert(made.properties_.end(), guard, none);
  return made;
}

LawStatus Umat::call(int components, const UmatPlace& place, UmatPoint& p, double* state) const {
  std::unique_lock<std::mutex> turn(*one_at_a_time_, std::defer_lock);
  if (!thread_safe) turn.lock();
  thread_local std::vector<double> statev;
  statev.assign(state, state + n_state);
  statev.insert(statev.end(), guard, none);
  const int n = components;
  swap_last_shears(n, p.stress), swap_last_shears(n, p.strain), swap_last_shears(n, p.increment);
  std::fill(p.stress + n, p.stress + UmatPoint::most, unwritten);
  std::fill(p.tangent, p.tangent + n * n, 0.0);
  std::fill(p.tangent + n * n, p.tangent + UmatPoint::most * UmatPoint::most, unwritten);
  p.step_factor = 1.0;
  p.heat = 0.0;
  double drpldt = 0.0, ddsddt[UmatPoint::most] = {}, drplde[UmatPoint::most] = {};
  const double zero = 0.0;
  const int ndi = n == 3 ? 2 : 3, nshr = n - ndi, one = 1, step[4] = {place.stage, 1, 1, 0};
  char name[80];
  std::memset(name, ' ', sizeof name);
  std::memcpy(name, "PRESSWORK", 9);
  try {
    function_(p.stress, statev.data(), p.tangent, &p.energy[0], &p.energy[1], &p.energy[2], &p.heat, ddsddt, drplde,
              &drpldt, p.strain, p.increment, place.time, &place.dt, &place.temperature[0], &place.temperature[1],
              &zero, &zero, name, &ndi, &nshr, &n, &n_state, properties_.data(), &n_properties_, place.coordinates,
              p.rotation, &p.step_factor, &place.length, p.F_n, p.F, &place.cell, &place.point, &one,
              &place.section_point, step, &place.increment, sizeof name);
  } catch (const Stopped&) {
    return LawStatus::stopped;
  }
  if (!is_all(none, statev.data() + n_state, guard)) return LawStatus::overrun;
  if (!is_all(unwritten, p.stress + n, UmatPoint::most - n)) return LawStatus::components;
  if (!is_all(unwritten, p.tangent + n * n, UmatPoint::most * UmatPoint::most - n * n)) return LawStatus::components;
  if (p.step_factor < 1.0) return LawStatus::smaller;
  if (!std::isfinite(p.heat) || !all_finite(p.stress, n) || !all_finite(p.tangent, n * n) ||
      !all_finite(statev.data(), n_state))
    return LawStatus::not_finite;
  swap_last_shears(n, p.stress);
  for (int column = 0; column < n; ++column) swap_last_shears(n, p.tangent + n * column);
  if (n == 6) std::swap_ranges(p.tangent + 24, p.tangent + 30, p.tangent + 30);
  std::copy_n(statev.data(), n_state, state);
  return LawStatus::done;
}

}  // namespace presswork

// Abaqus's utility routines that a UMAT may call.
#define PRESSWORK_UTILITY extern "C" __attribute__((visibility("default")))

// Stops the analysis. Passes through the routine's own frames back to Umat::call.
PRESSWORK_UTILITY void xit_() { throw presswork::Stopped{}; }

// Writes a message; kind -3 stops. The numbers and words that its format names are not filled in.
PRESSWORK_UTILITY void stdb_abqerr_(const int* kind, const char* text, const int*, const double*, const char*,
                                    std::size_t length, std::size_t) {
  std::fprintf(stderr, "UMAT: %.*s\n", static_cast<int>(length), text);
  if (*kind == -3) xit_();
}

// Mean stress and von Mises stress.
PRESSWORK_UTILITY void sinv_(const double* stress, double* mean, double* mises, const int* ndi, const int* nshr) {
  double trace = 0.0, square = 0.0;
  for (int i = 0; i < *ndi; ++i) trace += stress[i];
  for (int i = 0; i < 3; ++i) {
    const double deviator = (i < *ndi ? stress[i] : 0.0) - trace / 3.0;
    square += deviator * deviator;
  }
  for (int i = 0; i < *nshr; ++i) square += 2.0 * stress[*ndi + i] * stress[*ndi + i];
  *mean = trace / 3.0;
  *mises = std::sqrt(1.5 * square);
}

// R s R^T of a stress (kind 1) or of a strain with engineering shears (kind 2); R by columns.
PRESSWORK_UTILITY void rotsig_(const double* s, const double* R, double* turned, const int* kind, const int* ndi,
                               const int* nshr) {
  const int at[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  const double share = *kind == 2 ? 0.5 : 1.0;
  double full[3][3] = {};
  for (int i = 0; i < *ndi; ++i) full[i][i] = s[i];
  for (int k = 0; k < *nshr; ++k) full[at[k][0]][at[k][1]] = full[at[k][1]][at[k][0]] = share * s[*ndi + k];
  auto component = [&](int i, int j) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) sum += R[i + 3 * k] * full[k][l] * R[j + 3 * l];
    return sum;
  };
  for (int i = 0; i < *ndi; ++i) turned[i] = component(i, i);
  for (int k = 0; k < *nshr; ++k) turned[*ndi + k] = component(at[k][0], at[k][1]) / share;
}
