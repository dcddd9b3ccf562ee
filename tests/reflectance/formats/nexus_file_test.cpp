#include "reflectance/formats/nexus_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <hdf5.h>

#include "base/write_file.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/support/temporary_folder.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

MeasuredBrdf with_all_parts() {
  MeasuredBrdf brdf = bright_aside();
  brdf.metadata.description = "a \xC3\xA4 test";
  brdf.metadata.measured_at = "2026-01-01T12:00:00Z";
  brdf.metadata.instrument = "gonio 1";
  brdf.channels = {channel_at(550.25), {.name = "R", .incident = Polarisation::P}};
  brdf.flag_names = {"near-zero", "few-neighbours"};
  for (std::size_t n = 0; n < brdf.points.size(); ++n) {
    BrdfPoint& p = brdf.points[n];
    p.f_per_sr -= 0.1 + 1.0 / (3.0 + static_cast<double>(n));
    p.u_shared_per_sr = 1e-300;
    p.channel = static_cast<std::uint32_t>(n % 2);
    p.flags = static_cast<std::uint32_t>(n % 4);
  }
  return brdf;
}

TEST(NexusFile, GivesEveryBitBack) {
  const MeasuredBrdf brdf = with_all_parts();
  const Result<Export> written = write_nexus(brdf);
  ASSERT_TRUE(written) << describe(written.error());
  const Result<MeasuredBrdf> read = read_nexus(bytes_of(written, ".nxs"), "x.nxs");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(*read, brdf);
  EXPECT_TRUE(written->losses.empty());
}

// A second reader: the library's own calls on a file on disk, by the names of the NeXus layout.
std::vector<double> column(hid_t file, const std::string& name) {
  const hid_t set = H5Dopen2(file, ("/entry/data/" + name).c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(set);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
  return values;
}

std::string attribute(hid_t file, const char* object, const char* name) {
  const hid_t at = H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT);
  if (at < 0) return "absent";
  const hid_t type = H5Aget_type(at);
  std::string text(H5Tget_size(type), '\0');
  H5Aread(at, type, text.data());
  H5Tclose(type);
  H5Aclose(at);
  return text;
}

TEST(NexusFile, HoldsABrightReadingWhereItWas) {
  const gonio::test::TemporaryFolder folder;
  const std::string path = folder / "bright.nxs";
  ASSERT_TRUE(write_file(path, bytes_of(write_nexus(bright_retro()), ".nxs")));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);

  const std::vector<double> f = column(file, "f");
  const auto n = static_cast<std::size_t>(std::ranges::max_element(f) - f.begin());
  EXPECT_EQ(f[n], 5.0);
  EXPECT_EQ(column(file, "theta_i")[n], 30.0);
  EXPECT_EQ(column(file, "phi_i")[n], 0.0);
  EXPECT_EQ(column(file, "theta_r")[n], 30.0);
  EXPECT_EQ(column(file, "phi_r")[n], 0.0);
  EXPECT_EQ(column(file, "f_errors")[n], 0.005) << "standard: U/k";
  EXPECT_EQ(column(file, "wavelength")[n], 550.0);
  EXPECT_EQ(attribute(file, "/", "default"), "entry");
  EXPECT_EQ(attribute(file, "/entry", "NX_class"), "NXentry");
  EXPECT_EQ(attribute(file, "/entry/data", "NX_class"), "NXdata");
  EXPECT_EQ(attribute(file, "/entry/data", "signal"), "f");
  EXPECT_EQ(attribute(file, "/entry/data/theta_r", "units"), "deg");
  EXPECT_EQ(attribute(file, "/entry/data/f", "units"), "1/sr");
  H5Fclose(file);
}

TEST(NexusFile, SaysWhatABadOneLacks) {
  const auto said = [](const std::string& bytes) {
    const Result<MeasuredBrdf> read = read_nexus(bytes, "bad.nxs");
    return read ? std::string("it was read") : describe(read.error());
  };
  const std::string good = bytes_of(write_nexus(bright_retro()), ".nxs");
  EXPECT_THAT(said(""), HasSubstr("no HDF5"));
  EXPECT_THAT(said("tensor_file"), HasSubstr("no HDF5"));
  EXPECT_THAT(said(good.substr(0, good.size() / 2)), HasSubstr("bad.nxs"));
  std::string bad = good;
  bad.replace(bad.find("sidecar"), 7, "sidecap");
  EXPECT_THAT(said(bad), HasSubstr("/entry/sidecar/data"));
  bad = good;
  const std::string count = "\"points\": " + std::to_string(bright_retro().points.size());
  bad.replace(bad.find(count), count.size(), "\"points\": 999");
  EXPECT_THAT(said(bad), HasSubstr("theta_i"));
}

}  // namespace
}  // namespace gonio::formats
