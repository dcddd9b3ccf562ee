// Reference standards as people see them.
#include <fmt/format.h>

#include "cli/views.h"

namespace gonio::cli {
namespace {

std::string range_text(const api::ReferenceReport& reference) {
  if (reference.from_nm == reference.to_nm) return fmt::format("{:g}", reference.from_nm);
  return fmt::format("{:g} to {:g}", reference.from_nm, reference.to_nm);
}

std::string gap_text(const api::ReferenceReport& reference) {
  constexpr double kPerCent = 100.0;
  return fmt::format("{} (exchanged directions differ by up to {:.2g} %)", reference.table,
                     kPerCent * reference.largest_gap);
}

std::string mode_text(const api::ShapeModeReport& mode) {
  std::string text = fmt::format("{}, u {:g} %", mode.kind, 100.0 * mode.u);
  if (mode.width_deg) text += fmt::format(", {:g} deg wide", *mode.width_deg);
  return text;
}

}  // namespace

Table view(const api::ReferenceList& references) {
  Table table{.header = {"serial", "material", "certificate", "expires", "geometry", "nm", "table", "file", "error"},
              .rows = {}};
  for (const api::ReferenceReport& reference : references.references) {
    const bool is_good = !reference.error;
    table.rows.push_back({reference.serial, reference.material, reference.certificate_date, reference.expires,
                          reference.geometry, is_good ? range_text(reference) : "", reference.table, reference.file,
                          is_good ? "" : describe(*reference.error)});
  }
  return table;
}

Table view(const api::ReferenceReport& reference) {
  Table table{.header = {}, .rows = {{}}};
  const auto add = [&](std::string name, std::string value) {
    table.header.push_back(std::move(name));
    table.rows[0].push_back(std::move(value));
  };
  add("serial", reference.serial);
  add("material", reference.material);
  add("file", reference.file);
  add("became", reference.note);
  add("certificate",
      fmt::format("{}, of {}, to {}", reference.geometry, reference.certificate_date, reference.expires));
  add("wavelengths_nm", range_text(reference));
  for (const api::CertificateEntryReport& entry : reference.entries) {
    add(fmt::format("rho_at_{:g}_nm", entry.wavelength_nm),
        fmt::format("{:g} +- {:.2g} (k = {:g})", entry.reflectance, reference.coverage_factor * entry.u,
                    reference.coverage_factor));
  }
  if (reference.entries.size() > 1) add("correlation_of_entries", number_text(reference.correlation, 3));
  add("shape_to_deg",
      fmt::format("theta_i {:g}, theta_r {:g}", reference.last_theta_i_deg, reference.last_theta_r_deg));
  if (reference.u_integral > 0.0) add("u_of_its_integral", fmt::format("{:g} %", 100.0 * reference.u_integral));
  for (const api::ShapeModeReport& mode : reference.modes) add("mode_" + mode.name, mode_text(mode));
  add("table", gap_text(reference));
  return table;
}

}  // namespace gonio::cli
