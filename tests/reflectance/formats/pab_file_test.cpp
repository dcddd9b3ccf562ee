#include "reflectance/formats/pab_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

// A second reader by the description: '#' lines of the header, then theta, phi [deg], BSDF [sr^-1].
struct PabTable {
  double in_theta = -1.0, in_phi = -1.0;
  bool is_bsdf = false;
  std::vector<std::array<double, 3>> rows;
};

PabTable pab_table(const std::string& text) {
  PabTable table;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    table.is_bsdf = table.is_bsdf || line == "#format: theta phi BSDF";
    if (std::sscanf(line.c_str(), "#intheta %lf", &table.in_theta) == 1) continue;
    if (std::sscanf(line.c_str(), "#inphi %lf", &table.in_phi) == 1) continue;
    std::array<double, 3> row{};
    if (std::sscanf(line.c_str(), "%lf %lf %lf", &row[0], &row[1], &row[2]) == 3) table.rows.push_back(row);
  }
  return table;
}

TEST(PabFile, HoldsABrightReadingWhereItWas) {
  for (const MeasuredBrdf& brdf : {bright_retro(), bright_aside()}) {
    const BrdfPoint& bright = brightest(brdf);
    const Result<Export> written = write_pab(brdf);
    ASSERT_TRUE(written) << describe(written.error());
    ASSERT_EQ(written->files.size(), 4u) << "one for each incidence";

    std::size_t rows = 0;
    for (const OutputFile& file : written->files) rows += pab_table(file.bytes).rows.size();
    const PabTable table = pab_table(bytes_of(written, "-30-0.dat"));
    const auto found = std::ranges::max_element(table.rows, {}, [](const auto& row) { return row[2]; });

    EXPECT_EQ(rows, brdf.points.size());
    EXPECT_TRUE(table.is_bsdf);
    EXPECT_EQ(table.in_theta, 30.0);
    EXPECT_EQ(table.in_phi, 0.0);
    EXPECT_EQ(*found, (std::array<double, 3>{bright.theta_r_deg, bright.phi_r_deg, 5.0}));
    EXPECT_TRUE(has_loss(written->losses, LossKind::Uncertainty));
  }
}

TEST(PabFile, TakesAnEncodersScatterForOneIncidence) {
  MeasuredBrdf brdf = bright_retro();
  for (std::size_t n = 0; n < brdf.points.size(); ++n) brdf.points[n].theta_i_deg += n % 2 == 0 ? 0.002 : -0.002;
  EXPECT_EQ(write_pab(brdf)->files.size(), 4u);
  for (std::size_t n = 0; n < brdf.points.size(); ++n) brdf.points[n].phi_i_deg = static_cast<double>(n);
  EXPECT_GT(write_pab(brdf)->files.size(), 300u);
  while (brdf.points.size() < 1500) {
    brdf.points.push_back(brdf.points.back());
    brdf.points.back().phi_i_deg += 0.1;
  }
  EXPECT_FALSE(write_pab(brdf)) << "thousands of files";
}

}  // namespace
}  // namespace gonio::formats
