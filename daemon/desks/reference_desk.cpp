#include "daemon/desks/reference_desk.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "calibration/import_reference.h"

namespace gonio::daemon {
namespace {

using calibration::ReferenceStandard;
using calibration::ShapeReport;

std::string geometry_word(calibration::CertificateGeometry geometry) {
  constexpr std::array<std::string_view, 3> kWords{"8/h", "h/8", "0/45"};
  return std::string(kWords[static_cast<std::size_t>(geometry)]);
}

std::string mode_word(calibration::ShapeModeKind kind) {
  constexpr std::array<std::string_view, 4> kWords{"limb", "forward", "sideways", "opposition"};
  return std::string(kWords[static_cast<std::size_t>(kind)]);
}

api::ReferenceReport report_of_standard(const ReferenceStandard& standard, const ShapeReport& shape,
                                        const std::string& file) {
  const calibration::Certificate& certificate = standard.certificate();
  Wavelength from = certificate.entries.front().wavelength;
  Wavelength to = certificate.entries.back().wavelength;
  if (standard.shapes().size() > 1) {
    from = std::max(from, standard.shapes().front().wavelength);
    to = std::min(to, standard.shapes().back().wavelength);
  }
  return {.serial = standard.serial(),
          .material = standard.material(),
          .file = file,
          .certificate_date = certificate.date,
          .expires = certificate.expires,
          .error = std::nullopt,
          .geometry = geometry_word(certificate.geometry),
          .from_nm = in_nanometres(from),
          .to_nm = in_nanometres(to),
          .last_theta_i_deg = in_degrees(standard.last_theta_i()),
          .last_theta_r_deg = in_degrees(standard.last_theta_r()),
          .table = std::string(verdict_name(shape.verdict)),
          .largest_gap = shape.largest_gap,
          .findings = shape.findings,
          .note = {},
          .entries = {},
          .modes = {},
          .text = {}};
}

void add_details(api::ReferenceReport& report, const ReferenceStandard& standard, const std::string& text) {
  report.coverage_factor = standard.certificate().coverage_factor;
  report.correlation = standard.certificate().correlation;
  report.u_integral = standard.u_integral();
  for (const calibration::CertificateEntry& entry : standard.certificate().entries) {
    report.entries.push_back({in_nanometres(entry.wavelength), entry.reflectance, entry.u});
  }
  for (const calibration::ShapeMode& mode : standard.modes()) {
    api::ShapeModeReport of_mode{mode.name, mode_word(mode.kind), mode.u, std::nullopt};
    if (mode.kind == calibration::ShapeModeKind::Opposition) of_mode.width_deg = in_degrees(mode.width);
    report.modes.push_back(std::move(of_mode));
  }
  report.text = text;
}

// The shelf says InvalidInput, for a plan that names it; here it was asked for by its name.
Result<ShelfEntry> found_on(const ReferenceShelf& shelf, const std::string& serial) {
  Result<ShelfEntry> entry = shelf.find(serial);
  if (entry || entry.error().where) return entry;
  Error error = entry.error();
  error.code = ErrorCode::NotFound;
  return failure(std::move(error));
}

Result<calibration::ImportedReference> imported(const api::ReferenceImport& request, const ReferenceShelf& shelf) {
  calibration::ReferenceSource source{.text = request.text,
                                      .file = request.file.empty() ? "reference.toml" : request.file,
                                      .shape_text = request.shape,
                                      .shape_file = request.shape_file.empty() ? "shape.csv" : request.shape_file};
  if (request.shape_of.empty()) return calibration::import_reference(source);
  const Result<ShelfEntry> other = found_on(shelf, request.shape_of);
  if (!other) return failure(other.error());
  source.shape_from = &*other->standard;
  return calibration::import_reference(source);
}

}  // namespace

api::ReferenceReport reference_report(const ShelfEntry& entry) {
  if (entry.standard) return report_of_standard(*entry.standard, entry.shape, entry.file);
  api::ReferenceReport report;
  report.file = entry.file;
  report.error = entry.standard.error();
  return report;
}

Result<api::ReferenceReport> reference_in_full(const ReferenceShelf& shelf, const std::string& serial) {
  const Result<ShelfEntry> entry = found_on(shelf, serial);
  if (!entry) return failure(entry.error());
  api::ReferenceReport report = reference_report(*entry);
  add_details(report, *entry->standard, entry->text);
  return report;
}

Result<api::ReferenceReport> check_import(const api::ReferenceImport& request, const ReferenceShelf& shelf) {
  const auto found = imported(request, shelf);
  if (!found) return failure(found.error());
  api::ReferenceReport report = report_of_standard(found->standard, found->shape, request.file);
  add_details(report, found->standard, found->text);
  return report;
}

Result<api::ReferenceReport> import_to_shelf(const api::ReferenceImport& request, const ReferenceShelf& shelf,
                                             UtcTime now) {
  const auto found = imported(request, shelf);
  if (!found) return failure(found.error());
  GONIO_TRY(calibration::demand_consistency(found->standard, found->shape));
  const Result<std::string> became = shelf.put(found->standard.serial(), found->text, request.replace, now);
  if (!became) return failure(became.error());
  Result<api::ReferenceReport> report = reference_in_full(shelf, found->standard.serial());
  if (report) report->note = *became;
  return report;
}

}  // namespace gonio::daemon
