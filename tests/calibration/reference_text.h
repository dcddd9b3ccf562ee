#pragma once

#include <functional>
#include <string>
#include <vector>

namespace gonio::calibration {

/// Writes the text of a reference/*.toml, part by part, so that a test can bend one part.
struct ReferenceText {
  std::string standard = "serial = \"SRT-1\"\nmaterial = \"test\"\n";
  std::string certificate =
      "date = 2025-11-03\nexpires = 2027-11-03\ngeometry = \"8/h\"\nspecular = \"included\"\ncoverage_factor = 2.0\n"
      "uncertainty_kind = \"absolute\"\n";
  std::string entries = "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = 0.99\nuncertainty = 0.006\n";
  std::vector<double> theta_deg = {0, 15, 30, 45, 60, 75, 90};
  std::vector<double> phi_deg = {0, 60, 120, 180};
  std::function<double(double theta_i_deg, double theta_r_deg, double phi_deg)> shape = [](double, double, double) {
    return 1.0;
  };
  std::vector<double> wavelengths_nm;  ///< with them `spectral_shape` counts, and `shape` does not
  std::function<double(double nm, double theta_i_deg, double theta_r_deg, double phi_deg)> spectral_shape;
  std::string shape_extra = "u_integral = 0.001\n";
  std::string modes;

  [[nodiscard]] std::string text() const {
    std::string values;
    const auto add = [&](const auto& one_shape) {
      for (const double i : theta_deg) {
        for (const double r : theta_deg) {
          for (const double p : phi_deg) values += std::to_string(one_shape(i, r, p)) + ", ";
        }
      }
    };
    if (wavelengths_nm.empty()) add(shape);
    for (const double nm : wavelengths_nm) {
      add([&](double i, double r, double p) { return spectral_shape(nm, i, r, p); });
    }
    const auto list = [](const std::vector<double>& numbers) {
      std::string joined = "[";
      for (const double number : numbers) joined += std::to_string(number) + ", ";
      return joined + "]\n";
    };
    return "[standard]\n" + standard + "[certificate]\n" + certificate + entries +
           "[shape]\ntheta_i_deg = " + list(theta_deg) + "theta_r_deg = " + list(theta_deg) +
           "phi_deg = " + list(phi_deg) + (wavelengths_nm.empty() ? "" : "wavelengths_nm = " + list(wavelengths_nm)) +
           "values = [" + values + "]\n" + shape_extra + modes;
  }
};

}  // namespace gonio::calibration
