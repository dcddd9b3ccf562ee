// The GenICam description: features, and the registers behind them.
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "sim/wires/camera_registers.h"
#include "sim/wires/pixel_packing.h"

namespace gonio::sim {
namespace {

struct Entry {
  std::string_view name;
  std::uint32_t value;
};

/// Collects nodes and the list of features of the category that shows them.
class Description {
 public:
  void integer(std::string_view name, std::uint32_t at, std::uint32_t least, std::uint32_t most) {
    feature(name);
    integer_register(name, at);
    body_ += fmt::format("<Integer Name=\"{0}\"><pValue>{0}Reg</pValue><Min>{1}</Min><Max>{2}</Max></Integer>\n", name,
                         least, most);
  }

  void constant(std::string_view name, std::uint32_t value) {
    feature(name);
    body_ += fmt::format("<Integer Name=\"{}\"><Value>{}</Value></Integer>\n", name, value);
  }

  void number(std::string_view name, std::uint32_t at, double least, double most, std::string_view unit,
              bool is_writable = true) {
    feature(name);
    body_ += fmt::format(
        "<FloatReg Name=\"{0}Reg\"><Address>0x{1:x}</Address><Length>8</Length><AccessMode>{2}</AccessMode>"
        "<pPort>Device</pPort><Cachable>NoCache</Cachable><Endianess>BigEndian</Endianess></FloatReg>\n"
        "<Float Name=\"{0}\"><pValue>{0}Reg</pValue><Min>{3:.9g}</Min><Max>{4:.9g}</Max><Unit>{5}</Unit></Float>\n",
        name, at, is_writable ? "RW" : "RO", least, most, unit);
  }

  void choice(std::string_view name, std::uint32_t at, const std::vector<Entry>& entries) {
    feature(name);
    integer_register(name, at);
    body_ += fmt::format("<Enumeration Name=\"{}\">", name);
    for (const Entry& entry : entries) {
      body_ += fmt::format("<EnumEntry Name=\"{}\"><Value>{}</Value></EnumEntry>", entry.name, entry.value);
    }
    body_ += fmt::format("<pValue>{}Reg</pValue></Enumeration>\n", name);
  }

  void command(std::string_view name, std::uint32_t at, std::uint32_t value, bool has_own_register = true) {
    feature(name);
    if (has_own_register) integer_register(name, at);
    const std::string_view owner = has_own_register ? name : "AcquisitionStart";
    body_ += fmt::format("<Command Name=\"{}\"><pValue>{}Reg</pValue><CommandValue>{}</CommandValue></Command>\n", name,
                         owner, value);
  }

  [[nodiscard]] std::string text() const {
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
           "<RegisterDescription ModelName=\"Simulated_camera\" VendorName=\"Goniod\" StandardNameSpace=\"GEV\" "
           "SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" "
           "MinorVersion=\"0\" "
           "SubMinorVersion=\"0\" ProductGuid=\"0\" VersionGuid=\"0\" "
           "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n"
           "<Category Name=\"Root\"><pFeature>Camera</pFeature></Category>\n<Category Name=\"Camera\">" +
           features_ + "</Category>\n" + body_ + "<Port Name=\"Device\"/>\n</RegisterDescription>\n";
  }

 private:
  void feature(std::string_view name) { features_ += fmt::format("<pFeature>{}</pFeature>", name); }
  void integer_register(std::string_view name, std::uint32_t at) {
    body_ += fmt::format(
        "<IntReg Name=\"{}Reg\"><Address>0x{:x}</Address><Length>4</Length><AccessMode>RW</AccessMode>"
        "<pPort>Device</pPort><Cachable>NoCache</Cachable><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></"
        "IntReg>\n",
        name, at);
  }

  std::string features_;
  std::string body_;
};

}  // namespace

std::string genicam_description(const CameraIdentity& identity) {
  const auto width = static_cast<std::uint32_t>(identity.width_px);
  const auto height = static_cast<std::uint32_t>(identity.height_px);
  Description xml;
  xml.constant("SensorWidth", width);
  xml.constant("SensorHeight", height);
  xml.constant("WidthMax", width);
  xml.constant("HeightMax", height);
  constexpr std::uint32_t kFewestPixels = 4;
  xml.integer("Width", address::kWidth, kFewestPixels, width);
  xml.integer("Height", address::kHeight, kFewestPixels, height);
  xml.integer("OffsetX", address::kOffsetX, 0, width - kFewestPixels);
  xml.integer("OffsetY", address::kOffsetY, 0, height - kFewestPixels);
  xml.integer("PayloadSize", address::kPayloadSize, 1, 2 * width * height);
  std::vector<Entry> formats;
  for (const SentFormat& format : sent_formats()) {
    if (format.bits == identity.bits) formats.push_back({format.name, format.code});
  }
  xml.choice("PixelFormat", address::kPixelFormat, formats);
  xml.choice("AcquisitionMode", address::kAcquisitionMode, {{"Continuous", 0}});
  xml.choice("TriggerSelector", address::kTriggerSelector, {{"FrameStart", 0}});
  xml.choice("TriggerMode", address::kTriggerMode, {{"Off", 0}, {"On", 1}});
  xml.choice("TriggerSource", address::kTriggerSource, {{"Software", 0}});
  xml.command("TriggerSoftware", address::kTriggerSoftware, 1);
  xml.command("AcquisitionStart", address::kAcquisition, 1);
  xml.command("AcquisitionStop", address::kAcquisition, 0, false);
  xml.number("ExposureTime", address::kExposureUs, identity.shortest_exposure_us, identity.longest_exposure_us, "us");
  xml.number("Gain", address::kGainDb, 0.0, identity.most_gain_db, "dB");
  if (identity.temperature_c) xml.number("DeviceTemperature", address::kTemperatureC, -50.0, 150.0, "C", false);
  xml.integer("GevHeartbeatTimeout", address::kHeartbeatTimeoutMs, 500, 60000);
  xml.constant("TLParamsLocked", 0);
  return xml.text();
}

}  // namespace gonio::sim
