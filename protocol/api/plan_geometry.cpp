#include "protocol/api/plan_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "protocol/api/point_list.h"
#include "protocol/api/toml_values.h"

namespace gonio::api {

namespace {

constexpr double kMostPoints = 1e7;
constexpr std::size_t kMostParts = 1000;
constexpr int kMostRepeats = 1000;
constexpr NumberRange kTheta{.least = 0.0, .most = 90.0, .unit = "deg"};
constexpr NumberRange kPhi{.least = -360.0, .most = 360.0, .unit = "deg"};
constexpr NumberRange kSpacing{.least = 0.01, .most = 90.0, .unit = "deg"};
constexpr NumberRange kWavelength{.least = 100.0, .most = 20'000.0, .unit = "nm"};
constexpr std::array<std::string_view, 5> kShapes{"theta_r_deg", "points", "rings", "cone", "region"};

std::vector<Angle> read_angles(TomlReader& table, std::string_view key, NumberRange range) {
  std::vector<Angle> angles;
  for (const double value : read_values(table, key, range)) angles.push_back(degrees(value));
  return angles;
}

bool has(TomlReader& table, std::string_view key) {
  return table.kind(key) != TomlKind::Absent;
}

// Two numbers, the first not above the second.
std::array<Angle, 2> read_span(TomlReader& table, std::string_view key, NumberRange range) {
  const std::vector<double> ends = table.numbers(key, range);
  if (table.has_failed()) return {};
  if (ends.size() != 2 || ends[0] > ends[1]) {
    table.fail(key, ErrorCode::InvalidInput, fmt::format("{} values, or in the wrong order", ends.size()),
               "two values: from, to");
    return {};
  }
  return {degrees(ends[0]), degrees(ends[1])};
}

RingsShape read_rings(TomlReader table) {
  constexpr int kMostRings = 1000;
  constexpr int kMostAround = 100'000;
  RingsShape rings;
  rings.rings = static_cast<int>(table.integer("gauss", 1, kMostRings));
  rings.around = static_cast<int>(table.integer("around", 1, kMostAround));
  rings.is_half = table.flag_or("half", false);
  const auto to = table.optional_number("to_deg", {.least = 0.1, .most = 90.0, .unit = "deg"});
  if (to) rings.to = degrees(*to);
  return rings;
}

Angle read_half_angle(TomlReader& table) {
  return degrees(table.number("half_angle_deg", {.least = 0.01, .most = 180.0, .unit = "deg"}));
}

ConeShape read_cone(TomlReader table) {
  constexpr std::array<std::string_view, 2> kAbout{"specular", "retro"};
  ConeShape cone;
  cone.about = static_cast<ConeShape::About>(table.choice("about", kAbout));
  cone.half_angle = read_half_angle(table);
  cone.finest = degrees(table.number("finest_deg", kSpacing));
  cone.coarsest = degrees(table.number("coarsest_deg", kSpacing));
  if (cone.coarsest < cone.finest) {
    table.fail("coarsest_deg", ErrorCode::InvalidInput, fmt::format("value {} deg", in_degrees(cone.coarsest)),
               fmt::format("at least finest_deg = {} deg", in_degrees(cone.finest)));
  }
  return cone;
}

// A cap about a direction, or a box of angles.
void read_region(TomlReader table, PlanPart& part) {
  const Angle spacing = degrees(table.number("spacing_deg", kSpacing));
  if (has(table, "half_angle_deg")) {
    part.shape = ConeShape{.about = ConeShape::About::Direction,
                           .theta = degrees(table.number("theta_r_deg", kTheta)),
                           .phi = degrees(table.number("phi_r_deg", kPhi)),
                           .half_angle = read_half_angle(table),
                           .finest = spacing,
                           .coarsest = spacing};
    return;
  }
  const auto theta = read_span(table, "theta_r_deg", kTheta);
  const auto phi = read_span(table, "phi_r_deg", kPhi);
  part.shape = BoxShape{theta[0], theta[1], phi[0], phi[1], spacing};
}

class GeometryReader {
 public:
  GeometryReader(const std::map<std::string, std::string>& files, Plan& plan, Result<void>& listed)
      : files_(files), plan_(plan), listed_(listed) {}

  void read(TomlReader geometry) {
    plan_.is_reciprocal = geometry.flag_or("reciprocal", false);
    if (has(geometry, "relative_azimuth")) plan_.relative_azimuth = geometry.flag_or("relative_azimuth", true);
    PlanPart first = lists_of(geometry, {.phi_i = {Angle{}}});
    std::vector<TomlReader> more = geometry.tables("parts");
    if (more.size() > kMostParts) {
      geometry.fail("parts", ErrorCode::InvalidInput, fmt::format("{} parts", more.size()),
                    fmt::format("at most {}", kMostParts));
      return;
    }
    const bool is_default_only = !more.empty() && shapes_in(geometry) == 0;
    if (!is_default_only) take(geometry, "geometry", first);
    for (TomlReader& table : more) take(table, "geometry.parts", lists_of(table, first));
    keep_product_apart();
  }

 private:
  // What a part has of its own, and otherwise from [geometry].
  static PlanPart lists_of(TomlReader& table, const PlanPart& otherwise) {
    PlanPart part{.theta_i = otherwise.theta_i,
                  .phi_i = otherwise.phi_i,
                  .wavelengths = otherwise.wavelengths,
                  .repeats = otherwise.repeats};
    if (has(table, "theta_i_deg")) part.theta_i = read_angles(table, "theta_i_deg", kTheta);
    if (has(table, "phi_i_deg")) part.phi_i = read_angles(table, "phi_i_deg", kPhi);
    if (has(table, "wavelength_nm")) {
      part.wavelengths.clear();
      for (const double value : read_values(table, "wavelength_nm", kWavelength)) {
        part.wavelengths.push_back(nanometres(value));
      }
    }
    part.repeats = static_cast<int>(table.integer_or("repeats", part.repeats, 1, kMostRepeats));
    return part;
  }

  static std::ptrdiff_t shapes_in(TomlReader& table) {
    return std::ranges::count_if(kShapes, [&table](std::string_view key) { return has(table, key); });
  }

  void take(TomlReader& table, std::string_view name, PlanPart part) {
    if (shapes_in(table) > 1) {
      table.fail(name == "geometry" ? "parts" : "theta_i_deg", ErrorCode::InvalidInput, "several shapes in one part",
                 "one of theta_r_deg with phi_r_deg, points, rings, cone, region; more of them as [[geometry.parts]]");
      return;
    }
    part.where = table.location("theta_i_deg");
    part.where.field = name;
    read_shape(table, part);
    const auto* list = std::get_if<ListShape>(&part.shape);
    if (list == nullptr && part.theta_i.empty()) (void)table.numbers("theta_i_deg", kTheta);  // says that it is missing
    const bool needs_wavelength =
        list == nullptr || std::ranges::any_of(list->points, [](const ListedPoint& p) { return !p.wavelength; });
    if (needs_wavelength && part.wavelengths.empty()) (void)table.numbers("wavelength_nm", kWavelength);
    refuse_too_many(table, part);
    plan_.parts.push_back(std::move(part));
  }

  void read_shape(TomlReader& table, PlanPart& part) {
    if (has(table, "points")) {
      part.shape = read_list(table);
    } else if (has(table, "rings")) {
      part.shape = read_rings(table.table("rings"));
    } else if (has(table, "cone")) {
      part.shape = read_cone(table.table("cone"));
    } else if (has(table, "region")) {
      read_region(table.table("region"), part);
    } else {
      part.shape = ProductShape{.theta_r = read_angles(table, "theta_r_deg", kTheta),
                                .phi_r = read_angles(table, "phi_r_deg", kPhi)};
    }
  }

  ListShape read_list(TomlReader& table) {
    const std::string name = table.text("points");
    const auto found = files_.find(name);
    if (found == files_.end()) {
      table.fail("points", ErrorCode::InvalidInput, fmt::format("no file \"{}\" came with the plan", name),
                 "the name of a file that is sent with the plan, as gonioctl does");
      return {};
    }
    Result<ListShape> list = parse_point_list(found->second, name);
    if (list) return std::move(*list);
    if (listed_) listed_ = failure(list.error());
    return {};
  }

  static void refuse_too_many(TomlReader& table, const PlanPart& part) {
    const auto* product = std::get_if<ProductShape>(&part.shape);
    if (product == nullptr) return;
    double points = part.repeats;
    for (const std::size_t n : {part.theta_i.size(), part.phi_i.size(), product->theta_r.size(), product->phi_r.size(),
                                part.wavelengths.size()}) {
      points *= static_cast<double>(n);
    }
    if (points <= kMostPoints) return;
    table.fail("theta_i_deg", ErrorCode::InvalidInput, fmt::format("the lists make {:.0f} points", points),
               fmt::format("at most {:.0f} points", kMostPoints));
  }

  // The product of [geometry] itself is the plan's own lists.
  void keep_product_apart() {
    if (plan_.parts.empty() || plan_.parts.front().where.field != "geometry") return;
    const auto* product = std::get_if<ProductShape>(&plan_.parts.front().shape);
    if (product == nullptr) return;
    PlanPart& part = plan_.parts.front();
    plan_.theta_r = product->theta_r;
    plan_.phi_r = product->phi_r;
    plan_.theta_i = std::move(part.theta_i);
    plan_.phi_i = std::move(part.phi_i);
    plan_.wavelengths = std::move(part.wavelengths);
    plan_.repeats = part.repeats;
    plan_.parts.erase(plan_.parts.begin());
  }

  const std::map<std::string, std::string>& files_;
  Plan& plan_;
  Result<void>& listed_;
};

}  // namespace

void read_geometry(TomlReader geometry, const std::map<std::string, std::string>& files, Plan& plan,
                   Result<void>& listed) {
  GeometryReader(files, plan, listed).read(std::move(geometry));
}

}  // namespace gonio::api
