#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gonio::formats {

/// What a column of a CSV holds, by the name at its top.
struct CsvColumn {
  std::string name;              ///< ours: "theta_i_deg", "f_per_sr"
  std::optional<double> factor;  ///< into our unit; absent where the name does not say the unit
};

/// Our own names to the letter, and of strangers': angles, the BRDF and the wavelength, whatever their case, with the
/// unit behind '_', in brackets or after a blank ("Theta_i [rad]", "phi_o(deg)", "BRDF", "lambda (um)"). s and o at an
/// angle's end are r. No uncertainty: `u` and `U` differ by k, and a stranger's name seldom tells. Absent: none of
/// these.
[[nodiscard]] std::optional<CsvColumn> csv_column(std::string_view name);

/// What stands between the cells of a row of names: comma, semicolon or tab, whichever there are most of.
[[nodiscard]] char csv_separator(std::string_view names);

/// Whether a row of names has an angle of incidence and a BRDF.
[[nodiscard]] bool is_csv_header(std::string_view names);

/// "sep=;", which spreadsheets put before the names.
[[nodiscard]] bool is_separator_line(std::string_view line);

/// Without quotation marks around it.
[[nodiscard]] std::string_view unquoted(std::string_view cell);

}  // namespace gonio::formats
