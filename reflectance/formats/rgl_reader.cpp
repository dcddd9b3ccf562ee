#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "reflectance/formats/bilinear_warp.h"
#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/tensor_file.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::Vector;

constexpr double kHalfPi = 0.5 * std::numbers::pi;

double theta_to_u(double theta) {
  return std::sqrt(theta / kHalfPi);
}
double phi_to_v(double phi) {
  const double v = phi / (2.0 * std::numbers::pi) + 0.5;
  return v - std::floor(v);
}

class RglReader {
 public:
  RglReader(Tensors tensors, std::string file, std::size_t most_points)
      : tensors_(std::move(tensors)), file_(std::move(file)), most_points_(most_points) {}

  Result<MeasuredBrdf> read() {
    GONIO_TRY(take_fields());
    GONIO_TRY(check_values());
    take_channels();
    is_isotropic_ = phi_i_->values.size() <= 2;
    if (is_isotropic_) brdf_.metadata.symmetry = reflectance::TableSymmetry::Turn;
    const std::size_t azimuths = is_isotropic_ ? 1 : phi_i_->values.size();
    for (std::size_t p = 0; p < azimuths; ++p)
      for (std::size_t t = 0; t < theta_i_->values.size(); ++t) GONIO_TRY(read_incidence(p, t));
    GONIO_TRY(check(brdf_, file_));
    return std::move(brdf_);
  }

 private:
  Error error(std::string field, std::string seen, std::string limit) const {
    return {.code = ErrorCode::InvalidInput,
            .tried = "read it as RGL tensor file",
            .seen = std::move(seen),
            .limit = std::move(limit),
            .where = InputLocation{file_, 0, std::move(field)}};
  }

  Result<const Tensor*> field(std::string_view name, std::size_t dimensions) const {
    const auto at = tensors_.find(name);
    if (at == tensors_.end()) return failure(error(std::string(name), "it is absent", "required"));
    if (at->second.shape.size() == dimensions && !at->second.values.empty()) return &at->second;
    return failure(error(std::string(name), fmt::format("shape [{}]", fmt::join(at->second.shape, ", ")),
                         fmt::format("{} dimensions, none of them 0", dimensions)));
  }

  Result<void> take(const Tensor*& place, std::string_view name, std::size_t dimensions) {
    const Result<const Tensor*> found = field(name, dimensions);
    if (!found) return failure(found.error());
    place = *found;
    return {};
  }

  Result<void> take_fields() {
    GONIO_TRY(take(theta_i_, "theta_i", 1));
    GONIO_TRY(take(phi_i_, "phi_i", 1));
    GONIO_TRY(take(ndf_, "ndf", 2));
    GONIO_TRY(take(sigma_, "sigma", 2));
    GONIO_TRY(take(vndf_, "vndf", 4));
    is_colour_ = tensors_.contains("rgb");
    GONIO_TRY(take(values_, is_colour_ ? "rgb" : "spectra", 5));
    if (!is_colour_) GONIO_TRY(take(wavelengths_, "wavelengths", 1));
    const std::vector<std::size_t>& shape = values_->shape;
    const std::size_t channels = is_colour_ ? 3 : wavelengths_->values.size();
    const bool fits = shape[0] == phi_i_->values.size() && shape[1] == theta_i_->values.size() &&
                      shape[2] == channels && vndf_->shape[0] == shape[0] && vndf_->shape[1] == shape[1];
    const bool is_table = shape[3] >= 2 && shape[4] >= 2 && vndf_->shape[2] >= 2 && vndf_->shape[3] >= 2 &&
                          ndf_->shape[0] >= 2 && ndf_->shape[1] >= 2 && sigma_->shape[0] >= 2 && sigma_->shape[1] >= 2;
    if (fits && is_table) return {};
    return failure(error(is_colour_ ? "rgb" : "spectra", fmt::format("shape [{}]", fmt::join(shape, ", ")),
                         fmt::format("[{}, {}, {}, at least 2, at least 2], and vndf alike", phi_i_->values.size(),
                                     theta_i_->values.size(), channels)));
  }

  Result<void> check_values() const {
    constexpr double kRounding = 1e-6;  // floats of pi/2
    for (const double theta : theta_i_->values)
      if (!(theta >= 0.0 && theta <= kHalfPi + kRounding))
        return failure(error("theta_i", fmt::format("{} rad", theta), "0 to pi/2"));
    for (const double phi : phi_i_->values)
      if (!std::isfinite(phi)) return failure(error("phi_i", fmt::format("{} rad", phi), "a finite number"));
    for (const Tensor* tensor : {ndf_, sigma_, vndf_})
      for (const double value : tensor->values)
        if (!(value >= 0.0) || !std::isfinite(value))
          return failure(error(tensor == vndf_ ? "vndf" : "ndf, sigma", fmt::format("{}", value), "at least 0"));
    for (const double value : values_->values)
      if (!std::isfinite(value)) return failure(error("spectra", fmt::format("{}", value), "a finite number"));
    return {};
  }

  void take_channels() {
    if (is_colour_) brdf_.channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}};
    const std::size_t count = values_->shape[2];
    if (!is_colour_) {
      channel_step_ = std::clamp<std::size_t>((values_->values.size() + most_points_ - 1) / most_points_, 1, count);
      for (std::size_t c = 0; c < count; c += channel_step_)
        brdf_.channels.push_back(channel_at(wavelengths_->values[c]));
    }
    if (channel_step_ > 1)
      brdf_.metadata.remarks.emplace_back(
          "left out", fmt::format("{} of {} wavelengths: the file has {} values, of which {} are read at most",
                                  count - brdf_.channels.size(), count, values_->values.size(), most_points_));
    const auto text = tensors_.find("description");
    if (text == tensors_.end()) return;
    for (const double c : text->second.values)
      brdf_.metadata.sample += c >= 32.0 && c <= 255.0 ? static_cast<char>(static_cast<unsigned char>(c)) : ' ';
  }

  std::span<const double> slice(const Tensor& tensor, std::size_t index) const {
    const std::size_t size = tensor.shape[tensor.shape.size() - 2] * tensor.shape.back();
    return std::span(tensor.values).subspan(index * size, size);
  }

  // The mean of the normals' distribution over what the light sees, as the file's formula has it.
  double scale_at(const BilinearWarp& ndf, const BilinearWarp& sigma, SquarePoint m, double theta_i,
                  double phi_i) const {
    const double seen = sigma.at({.u = theta_to_u(theta_i), .v = phi_to_v(phi_i)});
    return seen > 0.0 ? ndf.at(m) / (4.0 * seen) : 0.0;
  }

  Result<void> read_incidence(std::size_t p, std::size_t t) {
    const std::size_t first = p * theta_i_->values.size() + t;
    const double theta_i = std::min(theta_i_->values[t], kHalfPi);
    const double phi_i = is_isotropic_ ? 0.0 : phi_i_->values[p];
    const Direction i = Direction::from_angles(radians(theta_i), radians(phi_i));
    const BilinearWarp vndf(vndf_->shape[2], vndf_->shape[3], slice(*vndf_, first));
    const BilinearWarp ndf(ndf_->shape[0], ndf_->shape[1], ndf_->values);
    const BilinearWarp sigma(sigma_->shape[0], sigma_->shape[1], sigma_->values);
    const std::size_t rows = values_->shape[3];
    const std::size_t columns = values_->shape[4];
    // The first and the last row are one azimuth.
    for (std::size_t y = 0; y + 1 < rows; ++y) {
      for (std::size_t x = 0; x < columns; ++x) {
        const SquarePoint m = vndf.warped({.u = static_cast<double>(x) / static_cast<double>(columns - 1),
                                           .v = static_cast<double>(y) / static_cast<double>(rows - 1)});
        const double phi_m = (2.0 * m.v - 1.0) * std::numbers::pi + (is_isotropic_ ? phi_i : 0.0);
        const Direction normal =
            Direction::from_angles(radians(std::min(kHalfPi * m.u * m.u, kHalfPi)), radians(phi_m));
        const double scale = scale_at(ndf, sigma, m, theta_i, is_isotropic_ ? 0.0 : phi_i);
        GONIO_TRY(add_points(i, normal.vector(), scale, first, y * columns + x));
      }
    }
    return {};
  }

  Result<void> add_points(const Direction& i, const Vector& normal, double scale, std::size_t first, std::size_t node) {
    constexpr double kLeastCosine = 0.0174524064372835;  // of 89 deg
    const Vector in = i.vector();
    const double twice = 2.0 * (in.x * normal.x + in.y * normal.y + in.z * normal.z);
    const Vector out{.x = twice * normal.x - in.x, .y = twice * normal.y - in.y, .z = twice * normal.z - in.z};
    if (out.z < kLeastCosine) return {};
    const Direction r = Direction::from_vector(out);
    BrdfPoint point{.theta_i_deg = std::min(in_degrees(i.theta()), 90.0),
                    .phi_i_deg = plain_azimuth_deg(in_degrees(i.phi())),
                    .theta_r_deg = in_degrees(r.theta()),
                    .phi_r_deg = plain_azimuth_deg(in_degrees(r.phi()))};
    for (std::size_t c = 0; c < brdf_.channels.size(); ++c) {
      if (brdf_.points.size() == most_points_)
        return failure(error("spectra", "more points", fmt::format("{}", most_points_)));
      point.channel = static_cast<std::uint32_t>(c);
      point.f_per_sr = slice(*values_, first * values_->shape[2] + c * channel_step_)[node] * scale / out.z;
      brdf_.points.push_back(point);
    }
    return {};
  }

  Tensors tensors_;
  std::string file_;
  std::size_t most_points_;
  const Tensor* theta_i_ = nullptr;
  const Tensor* phi_i_ = nullptr;
  const Tensor* ndf_ = nullptr;
  const Tensor* sigma_ = nullptr;
  const Tensor* vndf_ = nullptr;
  const Tensor* values_ = nullptr;
  const Tensor* wavelengths_ = nullptr;
  bool is_colour_ = false;
  bool is_isotropic_ = false;
  std::size_t channel_step_ = 1;  ///< between the wavelengths that are read
  MeasuredBrdf brdf_;
};

}  // namespace

Result<MeasuredBrdf> read_rgl(std::string_view bytes, const std::string& file, std::size_t most_points) {
  Result<Tensors> tensors = read_tensors(bytes, file);
  if (!tensors) return failure(tensors.error());
  return RglReader(*std::move(tensors), file, most_points).read();
}

}  // namespace gonio::formats
