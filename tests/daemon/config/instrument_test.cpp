#include "daemon/config/instrument.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "daemon/config/configuration_hash.h"
#include "protocol/stage/register_map.h"

namespace gonio::daemon {
namespace {

using testing::HasSubstr;
using namespace gonio::literals;

std::string axis_text(const std::string& name, const std::string& unit, double low, double high) {
  return "[stage.axes." + name + "]\noffset_" + unit + " = 0.5\nlow_" + unit + " = " + std::to_string(low) + "\nhigh_" +
         unit + " = " + std::to_string(high) + "\nspeed_" + unit + "_per_s = 20.0\nacceleration_" + unit +
         "_per_s2 = 40.0\nsettle_s = 0.1\nwindow_" + unit + " = 0.01\n";
}

// The example of packaging/, with all its axes and registers.
std::string whole_text() {
  std::ifstream in(std::string(GONIO_SOURCE_DIR) + "/packaging/instrument.example.toml");
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::size_t axes = text.find("\n[stage.axes.theta_i]");
  const std::size_t carriage = text.find("\n[stage.carriage]");
  const std::size_t registers = text.find("\n[stage.registers]");
  const std::size_t shadow = text.find("\n[stage.shadow]");
  EXPECT_TRUE(axes < carriage && carriage < registers && registers < shadow && shadow != std::string::npos);
  std::string whole = text.substr(0, axes) + "\n";
  whole += axis_text("theta_i", "deg", 0, 85) + axis_text("theta_r", "deg", -5, 85) +
           axis_text("phi_r", "deg", -10, 370) + axis_text("phi_i", "deg", -180, 180) +
           axis_text("carriage", "mm", -1, 300) + axis_text("filter_wheel", "slot", 0, 7);
  whole += text.substr(carriage, registers - carriage);
  whole += stage::to_toml(stage::own_register_map(), "stage.registers") + "\n" + text.substr(shadow);
  return whole;
}

std::string with(std::string text, std::string_view old_text, std::string_view new_text) {
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

Instrument read(const std::string& text) {
  const Result<Instrument> instrument = parse_instrument(text, "bench/instrument.toml");
  EXPECT_TRUE(instrument.has_value()) << describe(instrument.error());
  return instrument ? *instrument : Instrument{};
}

Error error_of(std::string_view old_text, std::string_view new_text) {
  const Result<Instrument> instrument = parse_instrument(with(whole_text(), old_text, new_text), "instrument.toml");
  EXPECT_FALSE(instrument.has_value()) << new_text;
  return instrument ? Error{} : instrument.error();
}

TEST(Instrument, HasArmsUnlessItNamesOtherKinematics) {
  const std::string turning =
      "\n[stage.kinematics]\nkind = \"turning-sample\"\nyaw = \"phi_i\"\npitch = \"theta_i\"\nroll = \"phi_r\"\n"
      "detector_arm = \"theta_r\"\nsource_elevation_deg = 5.0\n";

  const Instrument arms = read(whole_text());
  const Instrument sample = read(with(whole_text(), "\n[stage.carriage]", turning + "\n[stage.carriage]"));

  EXPECT_EQ(arms.stage.kinematics.kind, drivers::KinematicsKind::Arms);
  EXPECT_EQ(sample.stage.kinematics.kind, drivers::KinematicsKind::TurningSample);
  EXPECT_EQ(sample.stage.kinematics.turning.yaw, stage::Axis::PhiI);
  EXPECT_EQ(sample.stage.kinematics.turning.detector_arm, stage::Axis::ThetaR);
  EXPECT_DOUBLE_EQ(in_degrees(sample.stage.kinematics.turning.source_elevation), 5.0);
}

constexpr std::string_view kKeepOut =
    "\n[stage.keep_out]\nmargin_mm = 10.0\n[stage.keep_out.source]\nnearest_mm = 550.0\nfarthest_mm = 800.0\n"
    "radius_mm = 50.0\n[stage.keep_out.detector]\nnearest_mm = 500.0\nfarthest_mm = 700.0\nradius_mm = 45.0\n"
    "\n[stage.carriage]";

TEST(Instrument, HasAKeepOutOnlyWhereItIsNamed) {
  const Instrument without = read(whole_text());
  const Instrument with_it = read(with(whole_text(), "\n[stage.carriage]", kKeepOut));

  EXPECT_FALSE(without.stage.keep_out);
  ASSERT_TRUE(with_it.stage.keep_out);
  EXPECT_NEAR(in_degrees(with_it.stage.keep_out->least_separation()), 11.00584, 1e-5);  // asin(105 / 550)
}

TEST(Instrument, CoordinatesMovesOnlyWhereItIsAskedTo) {
  const Instrument without = read(whole_text());
  const Instrument with_it =
      read(with(whole_text(), "\nheartbeat_timeout_s", "\ncoordinated = true\nheartbeat_timeout_s"));

  EXPECT_FALSE(without.stage.coordinated);
  EXPECT_TRUE(with_it.stage.coordinated);
}

TEST(Instrument, RefusesHeadsThatCanNeverPassEachOther) {
  std::string huge(kKeepOut);
  const std::size_t at = huge.find("margin_mm = 10.0");
  huge.replace(at, 16, "margin_mm = 900.0");

  const Error error = error_of("\n[stage.carriage]", huge);

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_THAT(error.limit, HasSubstr("pass each other"));
}

TEST(Instrument, AnApproachSideNeedsItsOverrun) {
  const Instrument instrument = read(
      with(whole_text(), "window_deg = 0.01\n", "window_deg = 0.01\napproach = \"from above\"\nbacklash_deg = 0.3\n"));
  const Error missing = error_of("window_deg = 0.01\n", "window_deg = 0.01\napproach = \"from above\"\n");
  const Error stray = error_of("window_deg = 0.01\n", "window_deg = 0.01\nbacklash_deg = 0.3\n");

  EXPECT_EQ(instrument.stage.axis(stage::Axis::ThetaI).approach, drivers::Approach::FromAbove);
  EXPECT_EQ(instrument.stage.axis(stage::Axis::ThetaI).overrun, 0.3);
  EXPECT_EQ(instrument.stage.axis(stage::Axis::ThetaR).approach, drivers::Approach::Any);
  EXPECT_EQ(missing.code, ErrorCode::MissingKey);
  EXPECT_EQ(stray.code, ErrorCode::UnknownKey);
}

TEST(Instrument, RefusesAnAxisThatTurnsTwoThings) {
  const Error error = error_of("\n[stage.carriage]",
                               "\n[stage.kinematics]\nkind = \"turning-sample\"\nyaw = \"phi_i\"\npitch = \"phi_i\"\n"
                               "roll = \"phi_r\"\ndetector_arm = \"theta_r\"\n[stage.carriage]");

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_THAT(error.seen, HasSubstr("phi_i turns something else already"));
}

TEST(Instrument, IsReadWholeFromThePackagedExample) {
  const Instrument instrument = read(whole_text());

  EXPECT_EQ(instrument.name, "bench A");
  EXPECT_EQ(instrument.stage_address.host, "127.0.0.1");
  EXPECT_EQ(instrument.stage_address.port, 1502);
  EXPECT_EQ(instrument.stage.registers, stage::own_register_map());
  EXPECT_EQ(instrument.stage.heartbeat_timeout, std::chrono::seconds(2));
  EXPECT_EQ(instrument.stage.axis(stage::Axis::ThetaR).low, -5.0);
  EXPECT_EQ(instrument.stage.axis(stage::Axis::PhiR).settle, std::chrono::milliseconds(100));
  EXPECT_NEAR(in_millimetres(instrument.carriage.reference), 120.0, 1e-9);
  ASSERT_EQ(instrument.filters.size(), 1U);
  EXPECT_EQ(instrument.filters[0].slot, 1);
  EXPECT_EQ(instrument.filters[0].side, FilterSide::Detector);
  EXPECT_NEAR(in_millimetres(instrument.shadow.source_arm), 600.0, 1e-9);
  EXPECT_EQ(instrument.detector.serial, "SIM-0001");
  EXPECT_EQ(instrument.detector.shortest_exposure, std::chrono::milliseconds(1));
  EXPECT_EQ(instrument.detector.frames_at_most, 64);
  EXPECT_EQ(instrument.detector.aperture.radius_px, 12.0);
  EXPECT_EQ(instrument.model.detector.electrons_per_dn, 4.0);
  EXPECT_NEAR(in_degrees(instrument.model.angles.u_zero_theta_r), 0.02, 1e-12);
  EXPECT_NEAR(in_degrees(instrument.cones.source_half), 0.5, 1e-12);
  EXPECT_EQ(instrument.model.lamp.u_after_monitor, 0.0005);
  EXPECT_EQ(instrument.lamp.high, 5.0);
  EXPECT_EQ(instrument.reference_directory, "bench/reference");
}

TEST(Instrument, FindsTheNearestFilterWithinItsBand) {
  Instrument instrument;
  instrument.filters = {{.slot = 1, .centroid = 560_nm, .fwhm = 20_nm}, {.slot = 2, .centroid = 568_nm, .fwhm = 10_nm}};

  ASSERT_NE(filter_for(instrument, 566_nm), nullptr);
  EXPECT_EQ(filter_for(instrument, 566_nm)->slot, 2);
  EXPECT_EQ(filter_for(instrument, 555_nm)->slot, 1);
  EXPECT_EQ(filter_for(instrument, 600_nm), nullptr);
}

TEST(Instrument, TakesAFilterWithAnAttenuatorOnlyWhereOneIsAskedFor) {
  Instrument instrument;
  instrument.filters = {{.slot = 1, .centroid = 568_nm, .fwhm = 10_nm},
                        {.slot = 2, .centroid = 568_nm, .fwhm = 10_nm, .attenuation = Measured<double>{1e-3, 2e-6}}};

  EXPECT_EQ(filter_for(instrument, 568_nm)->slot, 1);
  EXPECT_EQ(attenuated_filter_for(instrument, 568_nm)->slot, 2);
  EXPECT_EQ(attenuated_filter_for(instrument, 600_nm), nullptr);
}

TEST(Instrument, ReadsWhatAnAbsoluteMeasurementRestsOn) {
  std::string text = with(whole_text(), "trap_mm = 240.0\n", "trap_mm = 240.0\nopen_mm = 180.0\n");
  text = with(text, "side = \"detector\" ", "attenuation = 1e-3\nu_attenuation = 2e-6\nside = \"detector\" ");
  text +=
      "\n[absolute]\nstop_radius_mm = 10.0\nu_stop_radius_mm = 0.01\nstop_distance_mm = 500.0\n"
      "u_stop_distance_mm = 0.25\n";

  const Instrument instrument = read(text);

  ASSERT_TRUE(instrument.model.absolute && instrument.carriage.open && instrument.filters.at(0).attenuation);
  EXPECT_TRUE(instrument.model.absolute->beams.empty()) << "those are found";
  EXPECT_NEAR(in_millimetres(instrument.model.absolute->aperture_radius.u), 0.01, 1e-12);
  EXPECT_NEAR(in_millimetres(instrument.model.absolute->aperture_distance.value), 500.0, 1e-9);
  EXPECT_NEAR(in_millimetres(*instrument.carriage.open), 180.0, 1e-9);
  EXPECT_EQ(instrument.filters.at(0).attenuation->u, 2e-6);
  EXPECT_FALSE(read(whole_text()).model.absolute) << "without the section no scan is absolute";
}

TEST(Instrument, AMisspeltKeyNamesLineAndNearestName) {
  const Error error = error_of("frames_at_most", "frame_at_most");

  EXPECT_EQ(error.code, ErrorCode::MissingKey);
  EXPECT_EQ(error.where->field, "detector.frames_at_most");
  EXPECT_EQ(error.where->file, "instrument.toml");
  EXPECT_GT(error.where->line, 0);
}

TEST(Instrument, AnExtraKeyIsRefused) {
  const Error error = error_of("gain_db = 0.0", "gain_db = 0.0\ngain_dB = 3.0");

  EXPECT_EQ(error.code, ErrorCode::UnknownKey);
  EXPECT_EQ(error.where->field, "detector.gain_dB");
  EXPECT_THAT(error.limit, HasSubstr("gain_db"));
}

TEST(Instrument, AnAxisInAnotherUnitIsRefused) {
  EXPECT_EQ(error_of("low_mm", "low_deg").where->field, "stage.axes.carriage.low_mm");
}

TEST(Instrument, LimitsTheWrongWayRoundAreRefusedWithBothValues) {
  const Error error = error_of("low_deg = -5.0", "low_deg = 95.0");

  EXPECT_EQ(error.where->field, "stage.axes.theta_r.low_deg");
  EXPECT_THAT(error.seen, HasSubstr("95 deg"));
  EXPECT_THAT(error.limit, HasSubstr("85 deg"));
}

TEST(Instrument, ACarriagePositionBeyondItsAxisIsRefused) {
  EXPECT_THAT(error_of("trap_mm = 240.0", "trap_mm = 400.0").limit, HasSubstr("300 mm"));
}

TEST(Instrument, AnApertureThatLeavesTheSensorIsRefused) {
  EXPECT_EQ(error_of("radius_px = 12.0", "radius_px = 40.0").where->field, "detector.aperture.radius_px");
}

TEST(Instrument, ALongestExposureBelowTheShortestIsRefused) {
  EXPECT_EQ(error_of("longest_exposure_s = 0.512", "longest_exposure_s = 0.0001").where->field,
            "detector.longest_exposure_s");
}

TEST(Instrument, TwoFiltersInOneSlotAreRefused) {
  const Error error = error_of("[stage.shadow]",
                               "[[stage.filters]]\nslot = 1\ncentroid_nm = 660\nfwhm_nm = 10\n"
                               "out_of_band_fraction = 0\nside = \"detector\"\n[stage.shadow]");

  EXPECT_EQ(error.where->field, "stage.filters.slot");
  EXPECT_THAT(error.seen, HasSubstr("twice"));
}

TEST(Instrument, AnUnreadableFileIsNamed) {
  const Result<Instrument> instrument = read_instrument("/nowhere/instrument.toml");

  ASSERT_FALSE(instrument.has_value());
  EXPECT_EQ(instrument.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(instrument.error().where->file, "/nowhere/instrument.toml");
}

TEST(ConfigurationHash, IsThatOfTheStandard) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(ConfigurationHash, DoesNotSeeAddresses) {
  const std::string text = whole_text();
  const std::string moved =
      with(with(with(text, "address = \"127.0.0.1\"", "address = \"10.0.0.7\""), "port = 1502", "port = 502"),
           "address = \"127.0.7.1\"", "address = \"10.0.0.8\"");

  EXPECT_EQ(read(moved).sha256, read(text).sha256);
  EXPECT_EQ(read(moved).stage_address.port, 502);
}

constexpr const char* kSerialLines = "address = \"/dev/ttyUSB0\"\nbaud = 19200\nparity = \"odd\"\nstop_bits = 2\n#";

std::string on_a_serial_line() {
  return with(with(with(whole_text(), "link = \"tcp\"", "link = \"rtu\""), "address = \"127.0.0.1\"", kSerialLines),
              "port = 1502", "#");
}

TEST(Instrument, HasItsStageOnASerialLineWhenTheFileSaysSo) {
  const Instrument instrument = read(on_a_serial_line());

  ASSERT_TRUE(instrument.stage_address.serial.has_value());
  EXPECT_EQ(instrument.stage_address.serial->device, "/dev/ttyUSB0");
  EXPECT_EQ(instrument.stage_address.serial->baud, 19200);
  EXPECT_EQ(instrument.stage_address.serial->parity, drivers::Parity::Odd);
  EXPECT_EQ(instrument.stage_address.serial->stop_bits, 2);
  EXPECT_FALSE(read(whole_text()).stage_address.serial.has_value());
}

TEST(Instrument, RefusesASpeedThatTheLineDoesNotHave) {
  const auto instrument =
      parse_instrument(with(on_a_serial_line(), "baud = 19200", "baud = 12345"), "bench/instrument.toml");

  ASSERT_FALSE(instrument.has_value());
  EXPECT_EQ(instrument.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(instrument.error().where->field, "stage.baud");
  EXPECT_GT(instrument.error().where->line, 0);
  EXPECT_THAT(instrument.error().limit, HasSubstr("9600, 19200, 38400"));
}

TEST(Instrument, RefusesAPortOnASerialLine) {
  const auto instrument =
      parse_instrument(with(on_a_serial_line(), "stop_bits = 2", "stop_bits = 2\nport = 502"), "instrument.toml");

  ASSERT_FALSE(instrument.has_value());
  EXPECT_EQ(instrument.error().code, ErrorCode::UnknownKey);
}

TEST(ConfigurationHash, DoesNotSeeTheSpeedOfTheLine) {
  const std::string faster = with(on_a_serial_line(), "baud = 19200", "baud = 9600");

  EXPECT_EQ(read(faster).sha256, read(on_a_serial_line()).sha256);
}

TEST(ConfigurationHash, SeesEverythingElse) {
  const std::string text = whole_text();

  EXPECT_NE(read(with(text, "electrons_per_dn = 4.0", "electrons_per_dn = 4.1")).sha256, read(text).sha256);
  EXPECT_NE(read(with(text, "serial = \"SIM-0001\"", "serial = \"SIM-0002\"")).sha256, read(text).sha256);
  EXPECT_NE(read(with(text, "heartbeat = {address = 208,", "heartbeat = {address = 209,")).sha256, read(text).sha256);
}

}  // namespace
}  // namespace gonio::daemon
