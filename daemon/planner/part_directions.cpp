#include "daemon/planner/part_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "daemon/planner/gauss_rings.h"

namespace gonio::daemon {

namespace {

using api::ConeShape;

constexpr Angle kHalfTurn = degrees(180.0);
constexpr Angle kHorizon = degrees(90.0);

// A micro-degree is below what any axis resolves; directions that are the same then look the same.
Angle rounded(Angle a) {
  return degrees(std::round(in_degrees(a) * 1e6) / 1e6);
}

// The number of even steps, none above `spacing`, that fill a width.
int steps_in(double width, double spacing) {
  return static_cast<int>(std::ceil(width / spacing - 1e-9));
}

// Even azimuths of a ring that are a part of all, from few to all: by strides that divide the one before. Half a ring's
// stand in the middle of their sectors, also those of fewer and wider ones: odd factors only.
class RingLevels {
 public:
  RingLevels(int around, bool is_half) : is_half_(is_half) {
    constexpr int kFewest = 3;
    for (int stride = 1, rest = around; rest >= kFewest;) {
      strides_.push_back(stride);
      int factor = is_half ? 3 : 2;
      while (factor <= rest && rest % factor != 0) factor += is_half ? 2 : 1;
      if (factor > rest) break;
      stride *= factor;
      rest /= factor;
    }
    if (strides_.empty()) strides_.push_back(1);
    std::ranges::reverse(strides_);
  }
  [[nodiscard]] int level_of(int azimuth) const {
    const auto stands = [&](int stride) { return azimuth % stride == (is_half_ ? (stride - 1) / 2 : 0); };
    return static_cast<int>(std::ranges::find_if(strides_, stands) - strides_.begin());
  }

 private:
  bool is_half_;
  std::vector<int> strides_;  // the widest first; the last is 1
};

struct Direction {
  Angle theta;
  Angle phi;
};

// The direction at an angle `alpha` from (theta, phi), towards larger theta for beta = 0.
Direction beside(Direction peak, double alpha, double beta) {
  const double t = peak.theta.si();
  const double along = std::sin(alpha) * std::cos(beta);
  const double across = std::sin(alpha) * std::sin(beta);
  const double x = std::sin(t) * std::cos(alpha) + std::cos(t) * along;
  const double z = std::cos(t) * std::cos(alpha) - std::sin(t) * along;
  return {radians(std::atan2(std::hypot(x, across), z)), peak.phi + radians(std::atan2(across, x))};
}

class Directions {
 public:
  Directions(const api::PlanPart& part, const Instrument& instrument, bool is_relative, const TakeDirection& take)
      : part_(part), instrument_(instrument), is_relative_(is_relative), take_(take) {}

  Result<void> run() {
    if (const auto* list = std::get_if<api::ListShape>(&part_.shape)) return take_list(*list);
    for (const Angle theta_i : part_.theta_i) {
      for (const Angle phi_i : part_.phi_i) {
        theta_i_ = theta_i;
        phi_i_ = phi_i;
        GONIO_TRY(std::visit([this](const auto& shape) { return this->take_shape(shape); }, part_.shape));
      }
    }
    return {};
  }

 private:
  Result<void> give(Direction r, bool may_be_out_of_reach = false, int level = -1) {
    return take_({.geometry = {.theta_i = theta_i_, .phi_i = phi_i_, .theta_r = r.theta, .phi_r = r.phi},
                  .may_be_out_of_reach = may_be_out_of_reach,
                  .level = level});
  }
  [[nodiscard]] Angle as_meant(Angle phi_r) const { return is_relative_ ? phi_r + phi_i_ : phi_r; }

  Result<void> take_list(const api::ListShape& list) {
    for (const api::ListedPoint& point : list.points) {
      phi_i_ = point.phi_i;
      GONIO_TRY(take_({.geometry = {.theta_i = point.theta_i,
                                    .phi_i = point.phi_i,
                                    .theta_r = point.theta_r,
                                    .phi_r = as_meant(point.phi_r)},
                       .wavelength = point.wavelength,
                       .line = point.line}));
    }
    return {};
  }
  Result<void> take_shape(const api::ListShape& list) { return take_list(list); }

  Result<void> take_shape(const api::ProductShape& product) {
    for (const Angle theta_r : product.theta_r) {
      for (const Angle phi_r : product.phi_r) GONIO_TRY(give({theta_r, as_meant(phi_r)}));
    }
    return {};
  }

  Result<void> take_shape(const api::RingsShape& rings) {
    Angle to = kHorizon;
    if (rings.to) {
      to = *rings.to;
    } else if (instrument_.stage.kinematics.kind == drivers::KinematicsKind::Arms) {
      to = std::min(to, degrees(instrument_.stage.axis(stage::Axis::ThetaR).high));
    } else {
      return failure({.code = ErrorCode::InvalidInput,
                      .device = "plan",
                      .tried = "lay rings as far as the arm reaches",
                      .seen = "this stage turns its sample: its reach depends on the direction",
                      .limit = "rings with to_deg",
                      .where = InputLocation{part_.where.file, part_.where.line, part_.where.field + ".rings.to_deg"}});
    }
    const Angle step = (rings.is_half ? 1.0 : 2.0) * kHalfTurn / rings.around;
    const RingLevels levels(rings.around, rings.is_half);
    for (const GaussRing& ring : gauss_rings(rings.rings, to)) {
      for (int k = 0; k < rings.around; ++k) {
        GONIO_TRY(give({rounded(ring.theta), as_meant(rounded((k + 0.5) * step))}, false, levels.level_of(k)));
      }
    }
    return {};
  }

  Result<void> take_shape(const ConeShape& cone) {
    Direction peak{theta_i_, phi_i_};
    if (cone.about == ConeShape::About::Specular) peak.phi = phi_i_ + kHalfTurn;
    if (cone.about == ConeShape::About::Direction) peak = {cone.theta, as_meant(cone.phi)};
    GONIO_TRY(give(peak, true));
    const auto spacing_at = [&cone](Angle alpha) {
      return cone.finest + (cone.coarsest - cone.finest) * (alpha / cone.half_angle);
    };
    for (Angle alpha = cone.finest; alpha <= cone.half_angle; alpha += spacing_at(alpha)) {
      constexpr int kFewestAround = 6;
      const double circle = 2.0 * std::numbers::pi * std::sin(alpha.si());
      const int around = std::max(kFewestAround, steps_in(circle, spacing_at(alpha).si()));
      for (int k = 0; k < around; ++k) {
        const Direction r = beside(peak, alpha.si(), 2.0 * std::numbers::pi * k / around);
        if (r.theta <= kHorizon) GONIO_TRY(give({rounded(r.theta), rounded(r.phi)}, true));
      }
    }
    return {};
  }

  Result<void> take_shape(const api::BoxShape& box) {
    const int rows = steps_in((box.theta_high - box.theta_low).si(), box.spacing.si());
    for (int row = 0; row <= rows; ++row) {
      const Angle theta = box.theta_low + (box.theta_high - box.theta_low) * (rows == 0 ? 0.0 : row * 1.0 / rows);
      const int columns = steps_in((box.phi_high - box.phi_low).si() * std::sin(theta.si()), box.spacing.si());
      for (int column = 0; column <= columns; ++column) {
        const double part = columns == 0 ? 0.0 : column * 1.0 / columns;
        GONIO_TRY(give({rounded(theta), as_meant(rounded(box.phi_low + (box.phi_high - box.phi_low) * part))}));
      }
    }
    return {};
  }

  const api::PlanPart& part_;
  const Instrument& instrument_;
  bool is_relative_;
  const TakeDirection& take_;
  Angle theta_i_;
  Angle phi_i_;
};

}  // namespace

Result<void> for_each_direction(const api::PlanPart& part, const Instrument& instrument, bool is_relative,
                                const TakeDirection& take) {
  return Directions(part, instrument, is_relative, take).run();
}

}  // namespace gonio::daemon
