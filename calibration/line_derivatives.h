#pragma once

#include <array>
#include <cstddef>

namespace gonio::calibration {

/// A number of each of up to four lines, which are worked on side by side.
inline constexpr std::size_t kLineLanes = 4;
struct alignas(kLineLanes * sizeof(double)) LineLanes : std::array<double, kLineLanes> {};

/// A point of a scan among its neighbours on several lines, a line a lane.
struct LineNodes {
  static constexpr std::size_t kAtMost = 5;  ///< nodes of a line: the point itself and four neighbours

  LineLanes size{};                     ///< how many nodes the line has, the point itself one of them; 0: no line
  std::array<LineLanes, kAtMost> x{};   ///< [node]: from the point, whose own is 0; no two at one place
  std::array<LineLanes, kAtMost> y{};   ///< [node]: what is differentiated
  std::array<LineLanes, kAtMost> u2{};  ///< [node]: variance of y
  LineLanes is_logarithm{};             ///< 1 where y = ln f: then second derivatives are f'' / f = y'' + y'^2
};

/// What the lines of one point say, each in units of its own y and x.
struct LineDerivatives {
  LineLanes first{};
  LineLanes first_missed{};
  LineLanes second{};
  LineLanes second_missed{};
  LineLanes second_noise2{};  ///< variance
  /// Squares of the third and the fourth derivative, less the noise in them: of lines with all nodes.
  LineLanes third2{};
  LineLanes fourth2{};
};

/// First and second derivatives at the point, of polynomials through it and 1, 2, .. of its neighbours:
///   P_p = P_(p-1) + y[x_0 .. x_p] prod_(m<p) (x - x_m), x_0 = 0 (Newton's form), so that at 0
///   P_p' = P_(p-1)' + y[..] prod_(1<=m<p) (-x_m),
///   P_p'' = P_(p-1)'' + 2 y[..] sum_(1<=m<p) prod_(n != m) (-x_n),
/// and y[x_0 .. x_p] = sum_j y_j / prod_(m != j) (x_j - x_m) (Abramowitz and Stegun 1964, 25.2.26). Of the orders the
/// one whose noise^2 + missed^2 is least; what order p misses is the larger of what it differs by from its neighbours
/// (direction_slopes.h). Without enough nodes: 0, and nothing missed. The same bits on any processor.
void differentiate(const LineNodes& nodes, LineDerivatives& found);

}  // namespace gonio::calibration
