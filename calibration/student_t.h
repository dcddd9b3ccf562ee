#pragma once

namespace gonio::calibration {

/// What holds 95.45 % of Student's t, for `degrees_of_freedom` > 0 (not necessarily whole) by the distribution itself:
/// to the last digits, in some 10 microseconds.
[[nodiscard]] double exact_student_factor(double degrees_of_freedom);

/// The same to 1e-9, in some 10 nanoseconds where there is at least one degree of freedom: above 200 by a series in
/// their reciprocal (Abramowitz and Stegun 1964, 26.7.5), down to 1 between nodes that are worked out exactly, once.
/// Threads: any.
[[nodiscard]] double student_factor(double degrees_of_freedom);

}  // namespace gonio::calibration
