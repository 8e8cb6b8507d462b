// SPDX-License-Identifier: Apache-2.0
// A material law from a shared library with Abaqus's interface UMAT (Abaqus User Subroutines Reference, "UMAT").
//
// The routine is called as Abaqus/Standard calls it, shear strains engineering:
//   plane stress (shells)           NDI 2, NSHR 1, NTENS 3: 11, 22, 12, in the lamina frame, which turns with the
//                                   material, so that DROT is one
//   plane strain, axisymmetry       NDI 3, NSHR 1, NTENS 4: 11, 22, 33, 12
//   space                           NDI 3, NSHR 3, NTENS 6: 11, 22, 33, 12, 13, 23; the last two the other way round in
//                                   all arrays of presswork, which `call` sees to
// Stress and STRAN come already turned by DROT, DSTRAN is the increment's strain in the turned axes, DFGRD0 and DFGRD1
// are of the whole deformation; tensors among the state variables the routine turns itself. There is no field variable
// and no creep of time steps: PREDEF and what belongs to it are zero, as are TEMP and DTEMP where no heat is computed.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "material/history_part.hpp"

namespace presswork {

extern "C" using UmatFunction = void (*)(
    double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd, double* rpl, double* ddsddt,
    double* drplde, double* drpldt, const double* stran, const double* dstran, const double* time, const double* dtime,
    const double* temp, const double* dtemp, const double* predef, const double* dpred, const char* cmname,
    const int* ndi, const int* nshr, const int* ntens, const int* nstatv, const double* props, const int* nprops,
    const double* coords, const double* drot, double* pnewdt, const double* celent, const double* dfgrd0,
    const double* dfgrd1, const int* noel, const int* npt, const int* layer, const int* kspt, const int* jstep,
    const int* kinc, std::size_t cmname_length);

// What DDSDDE is the derivative of.
enum class UmatJacobian : int {
  stress_increment = 0,   // d(stress increment)/d(strain increment), of laws that add up increments
  jaumann_kirchhoff = 1,  // Jaumann rate of Kirchhoff stress over J by rate of deformation, of laws of the whole F
};

// How a call ended.
enum class LawStatus : int {
  done = 0,
  smaller = 1,     // PNEWDT below one
  not_finite = 2,  // a stress, state variable or tangent is not a number
  overrun = 3,     // wrote beyond its state variables
  stopped = 4,     // called XIT
  no_stress = 5,   // of a law of our own: found no stress on the yield surface
  components = 6,  // wrote more stresses than NTENS: it is not written for so few
};

// Where and when a call is made.
struct UmatPlace {
  double coordinates[3] = {0.0, 0.0, 0.0};  // [mm]
  double length = 1.0;                      // of the cell [mm]
  int cell = 1, point = 1;                  // from 1
  int section_point = 1;                    // of a shell, from 1 at the bottom
  int stage = 1, increment = 1;             // from 1
  double time[2] = {0.0, 0.0};              // of stage and process when the increment begins [s]
  double dt = 1.0;                          // [s]
  double temperature[2] = {0.0, 0.0};       // when the increment begins, and its change [degrees C]
};

// One point of N components in one increment, in the order of law.hpp; matrices by columns. Stress and tangent [MPa].
struct UmatPoint {
  static constexpr int most = 6;
  double stress[most];                   // both
  double strain[most], increment[most];  // in
  double rotation[9];                    // in
  double F_n[9], F[9];                   // in
  double energy[3];                      // both: elastic, plastic, creep, per volume
  double tangent[most * most];           // out: (N, N)
  double step_factor;                    // out: PNEWDT
  double heat;                           // out: RPL, generated per volume and time [MPa/s]
};

class Umat {
 public:
  // Opens the library and finds umat_. Throws std::runtime_error that says what is missing.
  Umat(const std::string& library, const std::vector<double>& properties, int n_state, UmatJacobian jacobian,
       bool thread_safe, int plastic_strain);

  // A routine of our own that is written as one: gtn.hpp, from 4 components on. May be called from several threads.
  static Umat make_gtn(const std::vector<double>& properties);

  // Of 3, 4 or 6 components. `state` has n_state values. On anything but done, the point is not to be used. One call at
  // a time unless several threads may.
  LawStatus call(int components, const UmatPlace& place, UmatPoint& point, double* state) const;

  int n_state = 0;
  UmatJacobian jacobian = UmatJacobian::stress_increment;
  bool thread_safe = true;  // may be called from several threads at once
  int plastic_strain = 1;   // which state variable is the equivalent plastic strain, from 1; 0: none
  History state;            // the n_state values by name, as the library declares them (user_law.hpp); else one part

 private:
  Umat() = default;
  std::shared_ptr<void> library_;
  std::shared_ptr<std::mutex> one_at_a_time_ = std::make_shared<std::mutex>();
  UmatFunction function_ = nullptr;
  std::vector<double> properties_;  // and numbers behind them that are none, so that reading too far shows
  int n_properties_ = 0;
};

}  // namespace presswork
