#include "calibration/reference_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <sstream>
#include <tuple>

#include "calibration/csv_lines.h"

namespace gonio::calibration {
namespace {

/// Writes TOML line by line.
class TomlLines {
 public:
  explicit TomlLines(std::string file) : file_(std::move(file)) {}
  void add(const std::string& line, int from_line = 0, std::string_view field = {}) {
    part_.text += line + '\n';
    part_.came_from.push_back({file_, from_line, std::string(field)});
  }
  [[nodiscard]] TomlPart take() { return std::move(part_); }

 private:
  std::string file_;
  TomlPart part_;
};

enum class NoteKind : std::uint8_t { Text, Number, Date };
struct NoteRule {
  std::string_view key;
  NoteKind kind = NoteKind::Text;
  bool is_of_standard = false;
};
constexpr std::array<NoteRule, 10> kCertificateNotes{{{"serial", NoteKind::Text, true},
                                                      {"material", NoteKind::Text, true},
                                                      {"date", NoteKind::Date},
                                                      {"expires", NoteKind::Date},
                                                      {"geometry", NoteKind::Text},
                                                      {"specular", NoteKind::Text},
                                                      {"specular_port_half_angle_deg", NoteKind::Number},
                                                      {"coverage_factor", NoteKind::Number},
                                                      {"uncertainty_kind", NoteKind::Text},
                                                      {"correlation", NoteKind::Number}}};
constexpr NoteRule kLongestGap{"longest_gap_nm", NoteKind::Number};

bool looks_like_a_date(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-dd";
  return text.size() == kForm.size() && std::ranges::equal(text, kForm, [](char c, char form) {
           return form == 'd' ? c >= '0' && c <= '9' : c == form;
         });
}

Result<std::string> value_of(const CsvLines& csv, const CsvNote& note, NoteKind kind) {
  if (kind == NoteKind::Text) return toml_text(note.value);
  if (kind == NoteKind::Date && looks_like_a_date(note.value)) return note.value;
  if (kind == NoteKind::Date) {
    return failure(csv.wrong(ErrorCode::InvalidInput, note.line, note.key,
                             fmt::format("\"{}\"", shown_text(note.value)), "a date as 2026-11-03"));
  }
  return csv.number(note.value, note.line, note.key).map([](double value) { return fmt::format("{}", value); });
}

/// The notes of a certificate, each at most once and known.
class CertificateNotes {
 public:
  explicit CertificateNotes(const CsvLines& csv) : csv_(csv) {}

  Result<void> read() {
    std::string known;
    for (const NoteRule& rule : kCertificateNotes) known += std::string(rule.key) + ", ";
    known += kLongestGap.key;
    for (const CsvNote& note : csv_.notes()) {
      const bool is_known = note.key == kLongestGap.key || rule_of(note.key) != nullptr;
      if (!is_known) {
        return failure(csv_.wrong(ErrorCode::UnknownKey, note.line, note.key,
                                  "there is no note \"" + note.key + "\" of a certificate", known));
      }
      if (!by_key_.emplace(note.key, &note).second) {
        return failure(
            csv_.wrong(ErrorCode::InvalidInput, note.line, note.key, "the note stands here twice", "each note once"));
      }
    }
    if (by_key_.contains("serial")) return {};
    return failure(csv_.wrong(ErrorCode::MissingKey, csv_.names_line(), "serial", "the serial number is missing",
                              "a line \"# serial: ...\" above the columns"));
  }

  Result<void> write(TomlLines& toml, bool of_standard) const {
    for (const NoteRule& rule : kCertificateNotes) {
      if (rule.is_of_standard == of_standard) GONIO_TRY(write_one(toml, rule));
    }
    return {};
  }
  Result<void> write_one(TomlLines& toml, const NoteRule& rule) const {
    const auto note = by_key_.find(rule.key);
    if (note == by_key_.end()) return {};
    const Result<std::string> value = value_of(csv_, *note->second, rule.kind);
    if (!value) return failure(value.error());
    toml.add(fmt::format("{} = {}", rule.key, *value), note->second->line, rule.key);
    return {};
  }

 private:
  static const NoteRule* rule_of(std::string_view key) {
    const auto* found = std::ranges::find(kCertificateNotes, key, &NoteRule::key);
    return found == kCertificateNotes.end() ? nullptr : found;
  }

  const CsvLines& csv_;
  std::map<std::string_view, const CsvNote*> by_key_;
};

/// A column that may be given in per cent under another name.
struct ScaledColumn {
  std::size_t index = 0;
  std::string name;
  double scale = 1.0;
};

Result<ScaledColumn> scaled_column(const CsvLines& csv, const std::string& name) {
  constexpr double kOnePercent = 0.01;
  if (const auto plain = csv.column(name)) return ScaledColumn{*plain, name, 1.0};
  if (const auto percent = csv.column(name + "_percent")) {
    return ScaledColumn{*percent, name + "_percent", kOnePercent};
  }
  return failure(csv.wrong(ErrorCode::MissingKey, csv.names_line(), name, "the column is missing",
                           fmt::format("{0} or {0}_percent", name)));
}

Result<void> write_entries(const CsvLines& csv, TomlLines& toml) {
  const auto wavelength = csv.column("wavelength_nm");
  if (!wavelength) {
    return failure(csv.wrong(ErrorCode::MissingKey, csv.names_line(), "wavelength_nm", "the column is missing",
                             "wavelength_nm, reflectance, uncertainty"));
  }
  const auto reflectance = scaled_column(csv, "reflectance");
  if (!reflectance) return failure(reflectance.error());
  const auto uncertainty = scaled_column(csv, "uncertainty");
  if (!uncertainty) return failure(uncertainty.error());
  const std::array<std::pair<std::string_view, ScaledColumn>, 3> columns{
      {{"wavelength_nm", {*wavelength, "wavelength_nm", 1.0}},
       {"reflectance", *reflectance},
       {"uncertainty", *uncertainty}}};
  for (const CsvRow& row : csv.rows()) {
    toml.add("[[certificate.entries]]", row.line, "wavelength_nm");
    for (const auto& [key, column] : columns) {
      const Result<double> value = csv.number(row.cells[column.index], row.line, column.name);
      if (!value) return failure(value.error());
      // Ten digits: 98.9 % is 0.989, not its neighbour.
      toml.add(fmt::format("{} = {:.10g}", key, *value * column.scale), row.line, column.name);
    }
  }
  return {};
}

// ---- shapes ----

// In millionths of a degree and of a nm, so that nodes compare exactly.
using ShapePlace = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

struct ShapeRow {
  double factor = 0.0;
  int line = 0;
};

/// The rows of a shape by their places.
class ShapeRows {
 public:
  explicit ShapeRows(const CsvLines& csv) : csv_(csv) {}

  Result<void> read() {
    GONIO_TRY(find_columns());
    for (const CsvRow& row : csv_.rows()) GONIO_TRY(read_row(row));
    return {};
  }

  [[nodiscard]] bool has_wavelengths() const { return wavelength_.has_value(); }
  [[nodiscard]] std::vector<double> grid(std::size_t axis) const {
    std::vector<double> values;
    for (const std::int64_t node : nodes_[axis]) values.push_back(static_cast<double>(node) * 1e-6);
    return values;
  }

  /// All factors, wavelength slowest, phi fastest.
  Result<std::vector<double>> factors() const {
    std::vector<double> all;
    for (const std::int64_t w : nodes_[0]) {
      for (const std::int64_t i : nodes_[1]) {
        for (const std::int64_t r : nodes_[2]) {
          for (const std::int64_t p : nodes_[3]) {
            const Result<double> factor = factor_at(w, i, r, p);
            if (!factor) return failure(factor.error());
            all.push_back(*factor);
          }
        }
      }
    }
    return all;
  }

 private:
  Result<void> find_columns() {
    constexpr std::array<std::string_view, 4> kNeeded{"theta_i_deg", "theta_r_deg", "phi_deg", "factor"};
    for (std::size_t k = 0; k < kNeeded.size(); ++k) {
      const auto column = csv_.column(kNeeded[k]);
      if (!column) {
        return failure(csv_.wrong(ErrorCode::MissingKey, csv_.names_line(), kNeeded[k], "the column is missing",
                                  fmt::format("{}", fmt::join(kNeeded, ", "))));
      }
      columns_[k] = *column;
    }
    wavelength_ = csv_.column("wavelength_nm");
    return {};
  }

  Result<void> read_row(const CsvRow& row) {
    constexpr std::array<std::string_view, 4> kNames{"wavelength_nm", "theta_i_deg", "theta_r_deg", "phi_deg"};
    constexpr double kLargest = 1e6;  // nm, deg
    std::array<std::int64_t, 4> place{};
    for (std::size_t axis = 0; axis < kNames.size(); ++axis) {
      if (axis == 0 && !wavelength_) continue;
      const std::size_t column = axis == 0 ? *wavelength_ : columns_[axis - 1];
      const Result<double> value = csv_.number(row.cells[column], row.line, kNames[axis]);
      if (!value) return failure(value.error());
      if (*value < 0.0 || *value > kLargest) {
        return failure(csv_.wrong(ErrorCode::InvalidInput, row.line, kNames[axis], fmt::format("{}", *value),
                                  fmt::format("0 to {}", kLargest)));
      }
      place[axis] = std::llround(*value * 1e6);
      add_node(axis, place[axis]);
    }
    if (!wavelength_) add_node(0, 0);
    const Result<double> factor = csv_.number(row.cells[columns_[3]], row.line, "factor");
    if (!factor) return failure(factor.error());
    const ShapePlace key{place[0], place[1], place[2], place[3]};
    const auto [entry, is_new] = rows_.try_emplace(key, ShapeRow{*factor, row.line});
    if (is_new) return {};
    return failure(csv_.wrong(ErrorCode::InvalidInput, row.line, "factor",
                              fmt::format("the node stands on line {} too", entry->second.line), "each node once"));
  }

  void add_node(std::size_t axis, std::int64_t node) {
    auto& nodes = nodes_[axis];
    const auto at = std::ranges::lower_bound(nodes, node);
    if (at == nodes.end() || *at != node) nodes.insert(at, node);
  }

  [[nodiscard]] Result<double> factor_at(std::int64_t w, std::int64_t i, std::int64_t r, std::int64_t p) const {
    const auto own = rows_.find({w, i, r, p});
    if (own != rows_.end()) return own->second.factor;
    if (i == 0 || r == 0) {  // about the normal any phi is the same direction
      const auto any = rows_.lower_bound({w, i, r, 0});
      if (any != rows_.end() && std::get<0>(any->first) == w && std::get<1>(any->first) == i &&
          std::get<2>(any->first) == r) {
        return any->second.factor;
      }
    }
    return failure(
        csv_.wrong(ErrorCode::InvalidInput, 0, "factor",
                   fmt::format("no row for theta_i {:g}, theta_r {:g}, phi {:g} deg{}", static_cast<double>(i) * 1e-6,
                               static_cast<double>(r) * 1e-6, static_cast<double>(p) * 1e-6,
                               wavelength_ ? fmt::format(" at {:g} nm", static_cast<double>(w) * 1e-6) : std::string()),
                   "a row for each node of the grid that the others span"));
  }

  const CsvLines& csv_;
  std::array<std::size_t, 4> columns_{};
  std::optional<std::size_t> wavelength_;
  std::array<std::vector<std::int64_t>, 4> nodes_;  ///< ascending: wavelength, theta_i, theta_r, phi
  std::map<ShapePlace, ShapeRow> rows_;
};

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.10g}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

// `# mode: limb limb 0.02`, `# mode: hot-spot opposition 0.03 5`
Result<void> write_mode(const CsvLines& csv, const CsvNote& note, TomlLines& toml) {
  std::istringstream in(note.value);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  constexpr std::size_t kLeast = 3;
  constexpr std::size_t kMost = 4;
  if (words.size() < kLeast || words.size() > kMost) {
    return failure(csv.wrong(ErrorCode::InvalidInput, note.line, "mode", fmt::format("\"{}\"", shown_text(note.value)),
                             "NAME KIND U, and WIDTH_DEG of an opposition"));
  }
  toml.add("[[shape.modes]]", note.line, "mode");
  toml.add("name = " + toml_text(words[0]), note.line, "mode");
  toml.add("kind = " + toml_text(words[1]), note.line, "mode");
  for (std::size_t k = 2; k < words.size(); ++k) {
    const Result<double> value = csv.number(words[k], note.line, "mode");
    if (!value) return failure(value.error());
    toml.add(fmt::format("{} = {}", k == 2 ? "u" : "width_deg", *value), note.line, "mode");
  }
  return {};
}

Result<void> write_shape_notes(const CsvLines& csv, TomlLines& toml) {
  for (const CsvNote& note : csv.notes()) {
    if (note.key == "u_integral") {
      const Result<double> value = csv.number(note.value, note.line, note.key);
      if (!value) return failure(value.error());
      toml.add(fmt::format("u_integral = {}", *value), note.line, note.key);
    } else if (note.key != "mode") {
      return failure(csv.wrong(ErrorCode::UnknownKey, note.line, note.key,
                               "there is no note \"" + note.key + "\" of a shape", "u_integral, mode"));
    }
  }
  for (const CsvNote& note : csv.notes()) {
    if (note.key == "mode") GONIO_TRY(write_mode(csv, note, toml));
  }
  return {};
}

std::vector<double> in_degrees_list(const std::vector<Angle>& grid) {
  std::vector<double> deg;
  for (const Angle angle : grid) deg.push_back(in_degrees(angle));
  return deg;
}

std::string_view kind_word(ShapeModeKind kind) {
  constexpr std::array<std::string_view, 4> kModeWords{"limb", "forward", "sideways", "opposition"};
  return kModeWords[static_cast<std::size_t>(kind)];
}

}  // namespace

Result<TomlPart> certificate_from_csv(std::string_view csv, const std::string& file) {
  const auto lines = CsvLines::read(
      csv, file, {"wavelength_nm", "reflectance", "reflectance_percent", "uncertainty", "uncertainty_percent"});
  if (!lines) return failure(lines.error());
  CertificateNotes notes(*lines);
  GONIO_TRY(notes.read());
  TomlLines toml(file);
  toml.add("[standard]", lines->names_line());
  GONIO_TRY(notes.write(toml, true));
  toml.add("[certificate]", lines->names_line());
  GONIO_TRY(notes.write(toml, false));
  if (lines->rows().size() > 1) GONIO_TRY(notes.write_one(toml, kLongestGap));
  GONIO_TRY(write_entries(*lines, toml));
  return toml.take();
}

Result<TomlPart> shape_from_csv(std::string_view csv, const std::string& file) {
  const auto lines = CsvLines::read(csv, file, {"theta_i_deg", "theta_r_deg", "phi_deg", "factor", "wavelength_nm"});
  if (!lines) return failure(lines.error());
  ShapeRows rows(*lines);
  GONIO_TRY(rows.read());
  const Result<std::vector<double>> factors = rows.factors();
  if (!factors) return failure(factors.error());
  TomlLines toml(file);
  const int at = lines->names_line();
  toml.add("[shape]", at);
  if (rows.has_wavelengths()) toml.add("wavelengths_nm = " + list_text(rows.grid(0)), at, "wavelength_nm");
  toml.add("theta_i_deg = " + list_text(rows.grid(1)), at, "theta_i_deg");
  toml.add("theta_r_deg = " + list_text(rows.grid(2)), at, "theta_r_deg");
  toml.add("phi_deg = " + list_text(rows.grid(3)), at, "phi_deg");
  toml.add("values = " + list_text(*factors), at, "factor");
  GONIO_TRY(write_shape_notes(*lines, toml));
  return toml.take();
}

TomlPart shape_of(const ReferenceStandard& standard, bool with_integral) {
  TomlLines toml("shape of " + standard.serial());
  const ShapeTable& grid = standard.shapes().front().table;
  toml.add("[shape]");
  std::vector<double> wavelengths;
  std::vector<double> values;
  for (const SpectralShape& shape : standard.shapes()) {
    wavelengths.push_back(in_nanometres(shape.wavelength));
    values.insert(values.end(), shape.table.values().begin(), shape.table.values().end());
  }
  if (standard.shapes().size() > 1) toml.add("wavelengths_nm = " + list_text(wavelengths));
  toml.add("theta_i_deg = " + list_text(in_degrees_list(grid.theta_i())));
  toml.add("theta_r_deg = " + list_text(in_degrees_list(grid.theta_r())));
  toml.add("phi_deg = " + list_text(in_degrees_list(grid.phi())));
  toml.add("values = " + list_text(values));
  if (with_integral) toml.add(fmt::format("u_integral = {}", standard.u_integral()));
  for (const ShapeMode& mode : standard.modes()) {
    toml.add("[[shape.modes]]");
    toml.add("name = " + toml_text(mode.name));
    toml.add(fmt::format("kind = \"{}\"", kind_word(mode.kind)));
    toml.add(fmt::format("u = {}", mode.u));
    if (mode.kind == ShapeModeKind::Opposition) toml.add(fmt::format("width_deg = {:.10g}", in_degrees(mode.width)));
  }
  return toml.take();
}

}  // namespace gonio::calibration
