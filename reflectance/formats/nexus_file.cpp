#include "reflectance/formats/nexus_file.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <hdf5.h>

#include "reflectance/formats/sidecar_json.h"

namespace gonio::formats {
namespace {

// Debian's library keeps its state in globals.
std::mutex& hdf5_lock() {
  static std::mutex lock;
  return lock;
}

// A handle of any kind and how it is given back.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] bool is_open() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

struct DoubleColumn {
  const char* name;
  double BrdfPoint::*field;
  const char* unit;
};
constexpr std::array kDoubleColumns{DoubleColumn{"theta_i", &BrdfPoint::theta_i_deg, "deg"},
                                    DoubleColumn{"phi_i", &BrdfPoint::phi_i_deg, "deg"},
                                    DoubleColumn{"theta_r", &BrdfPoint::theta_r_deg, "deg"},
                                    DoubleColumn{"phi_r", &BrdfPoint::phi_r_deg, "deg"},
                                    DoubleColumn{"f", &BrdfPoint::f_per_sr, "1/sr"},
                                    DoubleColumn{"U", &BrdfPoint::U_per_sr, "1/sr"},
                                    DoubleColumn{"k", &BrdfPoint::k, ""},
                                    DoubleColumn{"u_shared", &BrdfPoint::u_shared_per_sr, "1/sr"}};

struct WholeColumn {
  const char* name;
  std::uint32_t BrdfPoint::*field;
};
constexpr std::array kWholeColumns{WholeColumn{"channel", &BrdfPoint::channel},
                                   WholeColumn{"flags", &BrdfPoint::flags}};

constexpr const char* kDataGroup = "/entry/data";
constexpr const char* kSidecarData = "/entry/sidecar/data";

// Writes what it is asked to; the first failure sticks, and the caller asks once.
class NexusWriter {
 public:
  explicit NexusWriter(const MeasuredBrdf& brdf)
      : brdf_(brdf), access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), file_(open()) {}

  [[nodiscard]] Result<std::string> image() {
    write();
    std::string bytes;
    if (file_.is_open() && H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) >= 0) {
      const ssize_t size = H5Fget_file_image(file_.id(), nullptr, 0);
      bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
      if (size > 0 && H5Fget_file_image(file_.id(), bytes.data(), bytes.size()) == size && !failed_) return bytes;
    }
    return failure({.code = ErrorCode::Internal,
                    .tried = "make an HDF5 file in memory",
                    .seen = "the library failed",
                    .limit = {}});
  }

 private:
  // In memory, never on disk.
  hid_t open_in_memory() const {
    constexpr std::size_t kGrowth = 1U << 20U;
    if (H5Pset_fapl_core(access_.id(), kGrowth, 0) < 0) return H5I_INVALID_HID;
    return H5Fcreate("gonio.nxs", H5F_ACC_TRUNC, H5P_DEFAULT, access_.id());
  }
  Handle open() const { return {open_in_memory(), H5Fclose}; }

  void note(herr_t status) { failed_ = failed_ || status < 0; }

  Handle text_type(const std::string& text) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    note(H5Tset_size(type.id(), std::max<std::size_t>(text.size(), 1)));
    note(H5Tset_strpad(type.id(), H5T_STR_NULLPAD));
    note(H5Tset_cset(type.id(), H5T_CSET_UTF8));
    return type;
  }

  void put_attribute(const char* path, const char* name, const std::string& text) {
    const Handle object(H5Oopen(file_.id(), path, H5P_DEFAULT), H5Oclose);
    const Handle type = text_type(text);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(object.id(), name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    note(H5Awrite(attribute.id(), type.id(), text.empty() ? " " : text.c_str()));
  }

  void put_group(const char* path, const char* nexus_class) {
    const Handle group(H5Gcreate2(file_.id(), path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    failed_ = failed_ || !group.is_open();
    put_attribute(path, "NX_class", nexus_class);
  }

  void put_text(const char* path, const std::string& text) {
    if (text.empty()) return;
    const Handle type = text_type(text);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle set(H5Dcreate2(file_.id(), path, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    note(H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()));
  }

  void put_column(const std::string& name, hid_t stored, hid_t in_memory, const void* values) {
    const hsize_t count = brdf_.points.size();
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const std::string path = fmt::format("{}/{}", kDataGroup, name);
    const Handle set(H5Dcreate2(file_.id(), path.c_str(), stored, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    note(H5Dwrite(set.id(), in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  }

  void put_doubles(const std::string& name, const std::vector<double>& values, const std::string& unit) {
    put_column(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
    if (!unit.empty()) put_attribute(fmt::format("{}/{}", kDataGroup, name).c_str(), "units", unit);
  }

  template <class Value>
  std::vector<double> doubles(Value value) const {
    std::vector<double> values;
    for (const BrdfPoint& point : brdf_.points) values.push_back(value(point));
    return values;
  }

  void write() {
    const BrdfMetadata& m = brdf_.metadata;
    put_attribute("/", "default", "entry");
    put_group("/entry", "NXentry");
    put_attribute("/entry", "default", "data");
    put_text("/entry/title", m.description);
    put_text("/entry/start_time", m.measured_at);
    put_text("/entry/program_name", m.software);
    put_group("/entry/sample", "NXsample");
    put_text("/entry/sample/name", m.sample);
    put_group("/entry/instrument", "NXinstrument");
    put_text("/entry/instrument/name", m.instrument);
    write_data();
    put_group("/entry/sidecar", "NXnote");
    put_text("/entry/sidecar/type", "application/json");
    put_text(kSidecarData, sidecar_json(brdf_));
  }

  void write_data() {
    put_group(kDataGroup, "NXdata");
    put_attribute(kDataGroup, "signal", "f");
    put_attribute(kDataGroup, "axes", "theta_r");
    for (const char* axis : {"theta_i", "phi_i", "theta_r", "phi_r"})
      put_attribute(kDataGroup, fmt::format("{}_indices", axis).c_str(), "0");
    for (const DoubleColumn& column : kDoubleColumns)
      put_doubles(column.name, doubles([&](const BrdfPoint& p) { return p.*column.field; }), column.unit);
    put_doubles("f_errors", doubles([](const BrdfPoint& p) { return standard_u_per_sr(p); }), "1/sr");
    put_doubles("wavelength", doubles([&](const BrdfPoint& p) { return brdf_.channels[p.channel].wavelength_nm; }),
                "nm");
    for (const WholeColumn& column : kWholeColumns) {
      std::vector<std::uint32_t> values;
      for (const BrdfPoint& point : brdf_.points) values.push_back(point.*column.field);
      put_column(column.name, H5T_STD_U32LE, H5T_NATIVE_UINT32, values.data());
    }
  }

  const MeasuredBrdf& brdf_;
  bool failed_ = false;
  Handle access_;
  Handle file_;
};

class NexusReader {
 public:
  NexusReader(std::string_view bytes, std::string file)
      : bytes_(bytes), name_(std::move(file)), access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), file_(open(bytes)) {}

  Result<MeasuredBrdf> read() {
    if (!file_.is_open()) return failure(error("first bytes", "no HDF5, or one cut off", "an HDF5 file"));
    const Result<std::string> sidecar = text(kSidecarData);
    if (!sidecar) return failure(sidecar.error());
    Result<Sidecar> beside = read_sidecar_json(*sidecar, name_);
    if (!beside) return failure(beside.error());
    MeasuredBrdf brdf = std::move(beside->brdf);
    if (beside->points > kMostPoints || beside->points > bytes_.size() / sizeof(double))
      return failure(error(kSidecarData, fmt::format("{} points", beside->points), "as many as fit in the file"));
    brdf.points.resize(beside->points);
    for (const DoubleColumn& column : kDoubleColumns)
      GONIO_TRY(read_column(column, H5T_NATIVE_DOUBLE, H5T_FLOAT, brdf));
    for (const WholeColumn& column : kWholeColumns)
      GONIO_TRY(read_column(column, H5T_NATIVE_UINT32, H5T_INTEGER, brdf));
    GONIO_TRY(check(brdf, name_));
    return brdf;
  }

 private:
  Handle open(std::string_view bytes) const {
    std::string image(bytes);  // the library asks for bytes that it may change, and copies them
    const bool is_ready = !image.empty() && H5Pset_fapl_core(access_.id(), 1U << 20U, 0) >= 0 &&
                          H5Pset_file_image(access_.id(), image.data(), image.size()) >= 0;
    return {is_ready ? H5Fopen("gonio.nxs", H5F_ACC_RDONLY, access_.id()) : H5I_INVALID_HID, H5Fclose};
  }

  Error error(std::string field, std::string seen, std::string limit) const {
    return {.code = ErrorCode::InvalidInput,
            .tried = "read it as HDF5 in NeXus layout",
            .seen = std::move(seen),
            .limit = std::move(limit),
            .where = InputLocation{name_, 0, std::move(field)}};
  }

  Result<std::string> text(const char* path) const {
    const Handle set(H5Dopen2(file_.id(), path, H5P_DEFAULT), H5Dclose);
    if (!set.is_open()) return failure(error(path, "it is absent", "required"));
    const Handle type(H5Dget_type(set.id()), H5Tclose);
    const Handle space(H5Dget_space(set.id()), H5Sclose);
    const bool is_text = H5Tget_class(type.id()) == H5T_STRING && H5Tis_variable_str(type.id()) == 0 &&
                         H5Sget_simple_extent_npoints(space.id()) == 1;
    const std::size_t size = is_text ? H5Tget_size(type.id()) : 0;
    if (size == 0 || size > bytes_.size())
      return failure(error(path, "another type, or longer than the file", "one text of fixed length"));
    std::string found(size, '\0');
    if (H5Dread(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, found.data()) < 0)
      return failure(error(path, "it cannot be read", "a whole file"));
    return found;
  }

  template <class Column>
  Result<void> read_column(const Column& column, hid_t in_memory, H5T_class_t wanted, MeasuredBrdf& brdf) const {
    const std::string path = fmt::format("{}/{}", kDataGroup, column.name);
    const Handle set(H5Dopen2(file_.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.is_open()) return failure(error(path, "it is absent", "required"));
    const Handle type(H5Dget_type(set.id()), H5Tclose);
    const Handle space(H5Dget_space(set.id()), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    if (H5Tget_class(type.id()) != wanted || count != static_cast<hssize_t>(brdf.points.size()))
      return failure(error(path, fmt::format("{} values, or another type", count),
                           fmt::format("{}, as the sidecar says", brdf.points.size())));
    using Value = std::remove_reference_t<decltype(brdf.points[0].*column.field)>;
    std::vector<Value> values(brdf.points.size());
    if (H5Dread(set.id(), in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      return failure(error(path, "it cannot be read", "a whole file"));
    for (std::size_t n = 0; n < values.size(); ++n) brdf.points[n].*column.field = values[n];
    return {};
  }

  std::string_view bytes_;
  std::string name_;
  Handle access_;
  Handle file_;
};

}  // namespace

Result<Export> write_nexus(const MeasuredBrdf& brdf) {
  GONIO_TRY(check(brdf, "NeXus"));
  const std::lock_guard lock(hdf5_lock());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its stack of errors would go to the terminal
  Result<std::string> image = NexusWriter(brdf).image();
  if (!image) return failure(image.error());
  Export written;
  written.files.push_back({.suffix = ".nxs", .bytes = *std::move(image)});
  return written;
}

Result<MeasuredBrdf> read_nexus(std::string_view bytes, const std::string& file) {
  const std::lock_guard lock(hdf5_lock());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return NexusReader(bytes, file).read();
}

}  // namespace gonio::formats
