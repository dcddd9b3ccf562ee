#include "daemon/analysis/export_job.h"

#include "reflectance/formats/astm_file.h"
#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/format.h"
#include "reflectance/formats/klems_file.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/nexus_file.h"
#include "reflectance/formats/pab_file.h"
#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/surface_file.h"
#include "reflectance/formats/write_export.h"
#include "reflectance/formats/zemax_file.h"

namespace gonio::analysis {
namespace {

using formats::Export;
using formats::Format;
using formats::MeasuredBrdf;

template <class Write>
Result<Export> written_from_surfaces(const MeasuredBrdf& brdf, Write write) {
  const Result<formats::SurfaceFile> surfaces = formats::surfaces_of(brdf);
  if (!surfaces) return failure(surfaces.error());
  return write(*surfaces);
}

Error no_such_format(std::string_view format) {
  std::string known;
  for (const std::string_view name : api::kExportFormats) known.append(known.empty() ? "" : ", ").append(name);
  return {.code = ErrorCode::InvalidInput,
          .tried = "export",
          .seen = "format \"" + std::string(format) + "\"",
          .limit = known,
          .where = InputLocation{"", 0, "format"}};
}

}  // namespace

Result<Export> exported(const MeasuredBrdf& brdf, std::string_view name) {
  const auto format = name == "csv+json" ? std::optional(Format::Csv) : formats::format_from_name(name);
  if (!format || name == "csv") return failure(no_such_format(name));
  switch (*format) {
    case Format::Csv:
      return formats::write_csv(brdf);
    case Format::Bird:
      return formats::write_bird(brdf);
    case Format::Astm:
      return formats::write_astm(brdf);
    case Format::Pab:
      return formats::write_pab(brdf);
    case Format::Nexus:
      return formats::write_nexus(brdf);
    case Format::Zemax:
      return written_from_surfaces(brdf, [](const auto& file) { return formats::write_zemax(file); });
    case Format::Merl:
      return written_from_surfaces(brdf, [](const auto& file) { return formats::write_merl(file); });
    case Format::Ssdd:
      return written_from_surfaces(
          brdf, [&](const auto& file) { return formats::write_ssdd(file, formats::ssdd_axes_of(brdf)); });
    case Format::Klems:
      return written_from_surfaces(brdf, [](const auto& file) { return formats::write_klems(file); });
    case Format::Rgl:
      return written_from_surfaces(brdf, [](const auto& file) { return formats::write_rgl(file); });
    case Format::Alta:
      break;
  }
  return failure(no_such_format(name));
}

std::vector<api::AnalysisLoss> losses_of(const formats::Losses& losses) {
  std::vector<api::AnalysisLoss> told;
  for (const formats::Loss& loss : losses) {
    told.push_back({.kind = std::string(formats::loss_name(loss.kind)),
                    .values = static_cast<std::int64_t>(loss.values),
                    .what = loss.what});
  }
  return told;
}

Result<std::vector<api::AnalysisFile>> write_files(const std::string& folder, const std::string& stem,
                                                   const Export& written) {
  GONIO_TRY(formats::write_export(folder + "/" + stem, written));
  std::vector<api::AnalysisFile> files;
  for (const formats::OutputFile& file : written.files) {
    files.push_back({.name = stem + file.suffix, .bytes = std::ssize(file.bytes)});
  }
  return files;
}

}  // namespace gonio::analysis
