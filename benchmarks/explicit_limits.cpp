// SPDX-License-Identifier: Apache-2.0
// Operations that the explicit loop's shell takes, counted; its time with nothing to load; and the times of the CPU's
// vector operations. benchmarks/explicit_limits.py builds and runs it.
//
// One square of 1 mm, 0.8 mm thick, stretched equally in both directions by 3e-5 a cycle, five Gauss points, von Mises
// with Swift's hardening, every point plastic, physical stabilisation.
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "element/shell4_stabilized.hpp"

using namespace presswork;

namespace {

struct Counted {
  double v;
  Counted() = default;
  Counted(double x) : v(x) {}
};
long adds = 0, multiplies = 0, divides = 0, roots = 0, choices = 0;

Counted operator+(Counted a, Counted b) { return ++adds, a.v + b.v; }
Counted operator-(Counted a, Counted b) { return ++adds, a.v - b.v; }
Counted operator-(Counted a) { return -a.v; }  // goes into the next operation
Counted operator*(Counted a, Counted b) { return ++multiplies, a.v * b.v; }
Counted operator/(Counted a, Counted b) { return ++divides, a.v / b.v; }
Counted& operator+=(Counted& a, Counted b) { return a = a + b; }
Counted& operator-=(Counted& a, Counted b) { return a = a - b; }
Counted& operator*=(Counted& a, Counted b) { return a = a * b; }
bool operator<(Counted a, Counted b) { return ++choices, a.v < b.v; }
bool operator>(Counted a, Counted b) { return ++choices, a.v > b.v; }
Counted select(bool m, Counted a, Counted b) { return ++choices, m ? a : b; }
Counted square_root(Counted a) { return ++roots, std::sqrt(a.v); }
double value_of(Counted a) { return a.v; }

constexpr int points = 5;
constexpr double step = 3e-5;  // strain of a cycle

template <class T>
struct Shell {
  T x[4][3], v[4][3], w[4][3], state[shell4::head_rows + points * FastMises::rows()], force[24];

  Shell() {
    constexpr double corner[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    for (auto& s : state) s = T(0.0);
    state[shell4::thickness] = T(0.8);
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 3; ++i) x[a][i] = v[a][i] = T(i < 2 ? corner[a][i] : 0.0), w[a][i] = T(0.0);
    state[shell4::reference] = state[shell4::reference + 3] = T(1.0);  // sides along x and y
  }
  [[gnu::noinline]] void advance(const FastMises& law, const LayerRule& rule) {
    for (int a = 0; a < 4; ++a)
      for (int j = 0; j < 2; ++j) x[a][j] = T(value_of_lane(x[a][j]) + step * value_of_lane(v[a][j]));
    shell4::advance_stabilized(law, rule, LayerConditions<T>{step}, x, v, w, static_cast<const T*>(nullptr), state,
                               LayersInRow<T>{state + shell4::head_rows, FastMises::rows()}, force);
  }
  double plastic_strain() const { return value_of_lane(state[shell4::head_rows + 3]); }

 private:
  static double value_of_lane(Counted a) { return a.v; }
  static double value_of_lane(Pack a) { return a[0]; }
};

// CPU time, which other processes disturb least [s].
double now() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

// Least time of one call [ns], of nine times n calls.
template <class F>
[[gnu::always_inline]] inline double least(int n, F call) {
  double best = 1e300;
  for (int r = 0; r < 9; ++r) {
    const double started = now();
    for (int i = 0; i < n; ++i) call();
    best = std::min(best, 1e9 * (now() - started) / n);
  }
  return best;
}

// Time of one vector operation among eight that do not wait for each other, odd ones and even ones [ns].
template <class Odd, class Even>
double least_of_operations(Odd odd, Even even) {
  Pack a(1.0), b(1.1), c(1.2), d(1.3), e(1.4), f(1.5), g(1.6), h(1.7);  // in registers, which an array would not be
  const auto replace = [](Pack& x, const auto& operation) {
    x = operation(x);
    asm volatile("" : "+v"(x.v));  // neither folded nor left out
  };
  const double time = least(100'000, [&] {
    replace(a, odd), replace(b, even), replace(c, odd), replace(d, even);
    replace(e, odd), replace(f, even), replace(g, odd), replace(h, even);
  });
  return time / 8;
}

}  // namespace

int main() {
  const HardeningTable table(Hardening{hardening::Swift{565.0, 0.007, 0.26}});
  const FastMises law{{207e3, 0.3, table.view()}};
  const LayerRule rule{
      5,
      {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640},
      {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, 0.1184634425280945}};

  Shell<Counted> counted;
  for (int k = 0; k < 300; ++k) counted.advance(law, rule);  // into the plastic range
  adds = multiplies = divides = roots = choices = 0;
  const double before = counted.plastic_strain();
  counted.advance(law, rule);
  if (!(counted.plastic_strain() - before > step)) return std::fprintf(stderr, "the shell does not flow\n"), 1;
  std::printf("adds %ld\nmultiplies %ld\ndivides %ld\nroots %ld\nchoices %ld\n", adds, multiplies, divides, roots,
              choices);

  Shell<Pack> pack;
  for (int k = 0; k < 300; ++k) pack.advance(law, rule);
  std::printf("kernel %.2f\n", least(2000, [&] { pack.advance(law, rule); }) / pack_width);
  std::printf("lanes %d\n", pack_width);
  const Pack factor(0.999999), term(1e-6);
  const auto fused = [&](Pack x) { return x * factor + term; };
  const auto multiply = [&](Pack x) { return x * factor; };
  const auto add = [&](Pack x) { return x + term; };
  const auto divide = [&](Pack x) { return term / x; };
  const auto root = [](Pack x) { return square_root(x); };
  std::printf("fused %.4f\n", least_of_operations(fused, fused));
  std::printf("single %.4f\n", least_of_operations(multiply, add));
  std::printf("divide %.4f\n", least_of_operations(divide, divide));
  std::printf("root %.4f\n", least_of_operations(root, root));
}
