#include "reflectance/formats/csv_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reflectance/formats/csv_names.h"
#include "reflectance/formats/sidecar_json.h"
#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

struct NumberColumn {
  std::string_view name;
  double BrdfPoint::*field;
  bool is_needed;
};
constexpr std::array kNumberColumns{NumberColumn{"theta_i_deg", &BrdfPoint::theta_i_deg, true},
                                    NumberColumn{"phi_i_deg", &BrdfPoint::phi_i_deg, true},
                                    NumberColumn{"theta_r_deg", &BrdfPoint::theta_r_deg, true},
                                    NumberColumn{"phi_r_deg", &BrdfPoint::phi_r_deg, true},
                                    NumberColumn{"f_per_sr", &BrdfPoint::f_per_sr, true},
                                    NumberColumn{"U_per_sr", &BrdfPoint::U_per_sr, false},
                                    NumberColumn{"k", &BrdfPoint::k, false},
                                    NumberColumn{"u_shared_per_sr", &BrdfPoint::u_shared_per_sr, false}};
constexpr std::string_view kChannelColumn = "channel";
constexpr std::string_view kWavelengthColumn = "wavelength_nm";
constexpr std::string_view kFlagsColumn = "flags";

std::string flags_text(const MeasuredBrdf& brdf, std::uint32_t flags) {
  std::string text;
  for (std::size_t bit = 0; bit < brdf.flag_names.size(); ++bit) {
    if (((flags >> static_cast<unsigned>(bit)) & 1U) == 0) continue;
    if (!text.empty()) text += '|';
    text += brdf.flag_names[bit];
  }
  return text;
}

class CsvReader {
 public:
  CsvReader(std::string_view csv, const Sidecar* sidecar, const std::string& file)
      : lines_(csv, "CSV", file), sidecar_(sidecar) {
    if (sidecar != nullptr) brdf_ = sidecar->brdf;
  }

  Result<MeasuredBrdf> read() {
    GONIO_TRY(read_names());
    while (const std::optional<std::string_view> line = lines_.next_filled()) GONIO_TRY(read_row(*line));
    GONIO_TRY(lines_.check_end());
    if (sidecar_ != nullptr && brdf_.points.size() != sidecar_->points)
      return failure(lines_.error("", fmt::format("{} points", brdf_.points.size()),
                                  fmt::format("{}, as its sidecar says", sidecar_->points)));
    if (brdf_.channels.empty()) brdf_.channels.push_back({});
    GONIO_TRY(check(brdf_, lines_.file()));
    return std::move(brdf_);
  }

 private:
  Result<void> read_names() {
    std::optional<std::string_view> line = lines_.next_filled();
    if (line && is_separator_line(*line)) line = lines_.next_filled();
    if (!line) return failure(lines_.error("", "an empty file", "a row of column names"));
    separator_ = csv_separator(*line);
    is_closed_ = line->ends_with(separator_);
    for (const std::string_view cell : cells_of(*line)) GONIO_TRY(read_name(unquoted(cell)));
    for (const NumberColumn& column : kNumberColumns) {
      if (column.is_needed && std::ranges::count(names_, column.name) == 0)
        return failure(lines_.error(std::string(column.name), "the column is absent", "required"));
    }
    if (sidecar_ == nullptr || std::ranges::count(names_, kChannelColumn) == 1) return {};
    return failure(lines_.error(std::string(kChannelColumn), "the column is absent", "required beside a sidecar"));
  }

  Result<void> read_name(std::string_view said) {
    const std::optional<CsvColumn> column = csv_column(said);
    const std::string shown = one_line(said.substr(0, 40));
    if (!column)
      return failure(lines_.error(shown, "an unknown column",
                                  "theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, f_per_sr, U_per_sr, k, "
                                  "u_shared_per_sr, channel, wavelength_nm, flags"));
    if (!column->factor)
      return failure(lines_.error(shown, "a column without its unit", column->name + ", or another unit in brackets"));
    if (std::ranges::count(names_, column->name) > 0) return failure(lines_.error(shown, "the column stands twice"));
    names_.push_back(column->name);
    factors_.push_back(*column->factor);
    return {};
  }

  // Spreadsheets close rows with one more separator; then the names have one, too. Tabs at a row's end are blanks.
  std::vector<std::string_view> cells_of(std::string_view line) const {
    std::vector<std::string_view> cells = split(line, separator_);
    if (is_closed_ && trimmed(cells.back()).empty()) cells.pop_back();
    if (separator_ == '\t' && cells.size() + 1 == names_.size()) cells.emplace_back();
    return cells;
  }

  // Where commas do not part cells they may stand for the decimal point.
  Result<double> number(std::string_view cell, const std::string& name) const {
    std::string digits(unquoted(cell));
    const bool is_comma = separator_ != ',' && std::ranges::count(digits, ',') == 1;
    if (is_comma && digits.find('.') == std::string::npos) std::ranges::replace(digits, ',', '.');
    return lines_.number(digits, name);
  }

  Result<void> read_row(std::string_view line) {
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != names_.size())
      return failure(lines_.error("", fmt::format("{} cells", cells.size()), fmt::format("{}", names_.size())));
    BrdfPoint point;
    wavelength_nm_ = 0.0;
    for (std::size_t n = 0; n < cells.size(); ++n) GONIO_TRY(read_cell(n, cells[n], point));
    if (sidecar_ == nullptr) number_channel(point);
    brdf_.points.push_back(point);
    return {};
  }

  Result<void> read_cell(std::size_t n, std::string_view cell, BrdfPoint& point) {
    const std::string& name = names_[n];
    for (const NumberColumn& column : kNumberColumns) {
      if (column.name != name) continue;
      const Result<double> value = number(cell, name);
      if (!value) return failure(value.error());
      point.*column.field = factors_[n] * *value;
      return {};
    }
    if (name == kFlagsColumn) return read_flags(unquoted(cell), point);
    if (name == kChannelColumn) {
      const Result<std::size_t> index = lines_.whole(unquoted(cell), name, 0, kMostPoints);
      if (!index) return failure(index.error());
      point.channel = static_cast<std::uint32_t>(*index);
      return {};
    }
    if (sidecar_ != nullptr) return {};  // it knows the wavelengths, to the bit
    const Result<double> wavelength = unquoted(cell).empty() ? Result<double>(0.0) : number(cell, name);
    if (!wavelength) return failure(wavelength.error());
    wavelength_nm_ = factors_[n] * *wavelength;
    return {};
  }

  // A lone CSV's channels are what differs in its channel column, or in the wavelength.
  void number_channel(BrdfPoint& point) {
    const auto next = static_cast<std::uint32_t>(brdf_.channels.size());
    const auto [at, is_new] = channels_.try_emplace(std::pair(point.channel, wavelength_nm_), next);
    if (is_new) {
      const bool is_numbered = std::ranges::count(names_, kChannelColumn) > 0;
      brdf_.channels.push_back(wavelength_nm_ > 0.0 ? channel_at(wavelength_nm_)
                               : is_numbered        ? Channel{.name = fmt::format("channel {}", point.channel)}
                                                    : Channel{});
    }
    point.channel = at->second;
  }

  Result<void> read_flags(std::string_view cell, BrdfPoint& point) {
    if (cell.empty()) return {};
    constexpr std::size_t kMostFlagNames = 32;
    for (const std::string_view name : split(cell, '|')) {
      const auto at = std::ranges::find(brdf_.flag_names, name);
      const auto bit = static_cast<unsigned>(at - brdf_.flag_names.begin());
      if (at == brdf_.flag_names.end()) {
        if (sidecar_ != nullptr || brdf_.flag_names.size() == kMostFlagNames)
          return failure(
              lines_.error(std::string(kFlagsColumn), "an unknown flag", "those of the sidecar, at most 32"));
        brdf_.flag_names.emplace_back(name);
      }
      point.flags |= 1U << bit;
    }
    return {};
  }

  TextLines lines_;
  const Sidecar* sidecar_;
  char separator_ = ',';
  bool is_closed_ = false;                                              ///< rows end with one more separator
  std::vector<std::string> names_;                                      ///< ours, of the file's columns
  std::vector<double> factors_;                                         ///< into our units
  double wavelength_nm_ = 0.0;                                          ///< of the row that is read
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> channels_;  ///< by number and wavelength in the file
  MeasuredBrdf brdf_;
};

Result<void> check_flag_names(const MeasuredBrdf& brdf) {
  for (const std::string& name : brdf.flag_names) {
    if (!name.empty() && name.find_first_of(",|\r\n") == std::string::npos) continue;
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "write CSV",
                    .seen = fmt::format("the flag '{}'", name),
                    .limit = "a name without comma, bar and line's end"});
  }
  return {};
}

}  // namespace

Result<Export> write_csv(const MeasuredBrdf& brdf) {
  GONIO_TRY(check(brdf, "CSV"));
  GONIO_TRY(check_flag_names(brdf));
  std::string csv;
  constexpr std::size_t kUsualRow = 120;
  csv.reserve(brdf.points.size() * kUsualRow);
  for (const NumberColumn& column : kNumberColumns) csv.append(column.name).append(",");
  csv.append(kChannelColumn).append(",").append(kWavelengthColumn).append(",").append(kFlagsColumn).append("\n");
  for (const BrdfPoint& point : brdf.points) {
    for (const NumberColumn& column : kNumberColumns) csv.append(number_text(point.*column.field)).append(",");
    const double wavelength = brdf.channels[point.channel].wavelength_nm;
    csv.append(fmt::format("{},{},", point.channel, wavelength > 0.0 ? number_text(wavelength) : ""));
    csv.append(flags_text(brdf, point.flags)).append("\n");
  }
  Export written;
  written.files.push_back({.suffix = ".csv", .bytes = std::move(csv)});
  written.files.push_back({.suffix = ".json", .bytes = sidecar_json(brdf)});
  return written;
}

Result<MeasuredBrdf> read_csv(std::string_view csv, std::optional<std::string_view> sidecar, const std::string& file) {
  if (!sidecar) return CsvReader(csv, nullptr, file).read();
  const Result<Sidecar> beside = read_sidecar_json(*sidecar, file);
  if (!beside) return failure(beside.error());
  return CsvReader(csv, &*beside, file).read();
}

}  // namespace gonio::formats
