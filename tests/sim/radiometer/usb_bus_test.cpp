// The whole way: driver, session, libusb as Debian has it, an emulated kernel, the simulated radiometer. In wall time,
// on which nothing here depends but that it passes; every wait ends by a deadline.
#include "sim/wires/usb_bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "drivers/links/libusb_usbtmc_link.h"
#include "drivers/radiometer/scpi_radiometer.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

using namespace std::chrono_literals;
using drivers::RadiometerReading;
using testing::HasSubstr;
using Collected = Result<std::optional<RadiometerReading>>;

constexpr Duration kPatience = 30s;  // of a slow machine

class UsbBusTest : public testing::TestWithParam<bool> {
 protected:
  static RadiometerSpec monitor() {
    RadiometerSpec spec = quiet_radiometer();
    spec.place = RadiometerPlace::Monitor;
    spec.average_s = 0.0005;
    return spec;
  }
  static drivers::LibusbConfig usb(std::string serial = "SIM-PM-01") {
    return {.role = "monitor",
            .vendor_id = UsbtmcFunction::kVendor,
            .product_id = UsbtmcFunction::kProduct,
            .serial = std::move(serial)};
  }
  static drivers::ScpiRadiometerConfig config() {
    return {.role = "monitor",
            .serial = "SIM-PM-01",
            .settings = {.wavelength = nanometres(568.0), .range_w = 1e-2, .averages = 2, .samples = 5},
            .range_settle = 5ms,
            .reply_margin = kPatience,
            .transfer_timeout = kPatience};
  }
  void SetUp() override {
    const auto plugged = bus.plug();
    ASSERT_TRUE(plugged) << describe(plugged.error());
  }
  Collected take(drivers::ScpiRadiometer& from) {
    if (auto triggered = from.trigger(); !triggered) return failure(triggered.error());
    return from.collect(kPatience);
  }
  void expect_right_reading() {
    const Collected taken = take(driver);
    ASSERT_TRUE(taken) << describe(taken.error());
    ASSERT_TRUE(*taken);
    EXPECT_NEAR((*taken)->mean_w, 1e-3, 1e-12);
    EXPECT_EQ((*taken)->samples, 5);
  }

  SystemClock clock;
  LiveInstrument instrument{quiet_scene(), {}, clock};
  LiveRadiometer meter{instrument, monitor(), GetParam()};
  UsbBus bus{meter};
  drivers::LibusbUsbtmcLink link{usb()};
  drivers::ScpiRadiometer driver{link, config(), clock};
};

TEST_P(UsbBusTest, LetsADriverFindAndReadTheMeter) {
  const auto who = driver.ensure_open();

  ASSERT_TRUE(who) << describe(who.error());
  EXPECT_EQ(who->serial, "SIM-PM-01");
  EXPECT_EQ(link.interface().bulk_in, 0x82);
  EXPECT_EQ(link.interface().interrupt_in != 0, GetParam());
  for (int k = 0; k < 5; ++k) expect_right_reading();
}

TEST_P(UsbBusTest, LetsADriverWaitInPiecesForALongSample) {
  ASSERT_TRUE(driver.apply({.wavelength = nanometres(568.0), .range_w = 1e-2, .averages = 100, .samples = 2}));
  ASSERT_TRUE(driver.trigger());

  const Instant deadline = clock.now() + kPatience;
  Collected taken = driver.collect(1ms);
  int looks = 1;
  for (; taken && !*taken && clock.now() < deadline; ++looks) taken = driver.collect(1ms);

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(*taken);
  EXPECT_NEAR((*taken)->mean_w, 1e-3, 1e-12);
  EXPECT_GE(looks, 2) << "two samples of 50 ms, looked for during 1 ms";
}

struct Outcome {
  RadiometerFault fault;
  ErrorCode code;
};

TEST_P(UsbBusTest, CarriesEveryFaultToTheDriverWhichIsRightAgainAfterIt) {
  for (const Outcome& o : {Outcome{RadiometerFault::Stall, ErrorCode::DeviceRefused},
                           Outcome{RadiometerFault::TornReply, ErrorCode::IncompleteData},
                           Outcome{RadiometerFault::DuplicatedReply, ErrorCode::StaleData},
                           Outcome{RadiometerFault::StaleTag, ErrorCode::StaleData},
                           Outcome{RadiometerFault::NotANumber, ErrorCode::BadReply},
                           Outcome{RadiometerFault::Overload, ErrorCode::Saturated}}) {
    SCOPED_TRACE(static_cast<int>(o.fault));
    ASSERT_TRUE(driver.ensure_open());
    meter.with([&](UsbtmcFunction& function, Instant) { function.inject(o.fault, 3); });

    const Collected taken = take(driver);

    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().code, o.code) << describe(taken.error());
    expect_right_reading();
  }
}

TEST_P(UsbBusTest, LetsASessionComeBackIntoStepAfterAReplyThatNeverCame) {
  drivers::UsbtmcSession session(link, {.role = "monitor", .transfer_timeout = kPatience}, clock);
  ASSERT_TRUE(session.open());
  meter.with([](UsbtmcFunction& function, Instant) { function.inject(RadiometerFault::Silence); });

  const auto lost = session.query("*IDN?", 50ms);
  const auto next = session.query("*OPC?", kPatience);

  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::TimedOut);
  ASSERT_TRUE(next) << describe(next.error());
  EXPECT_EQ(*next, "1");
}

TEST_P(UsbBusTest, TellsADriverAtOnceThatTheMeterIsGoneAndShowsItWhenItReturns) {
  expect_right_reading();
  ASSERT_TRUE(driver.apply({.wavelength = nanometres(568.0), .range_w = 1e-2, .averages = 10000, .samples = 100}));
  ASSERT_TRUE(driver.trigger());

  Collected taken = std::optional<RadiometerReading>();
  {
    const std::jthread hand([&] { bus.unplug(); });
    taken = driver.collect(kPatience);
  }

  ASSERT_FALSE(taken) << "a sample takes 5 s, the reading 500 s";
  EXPECT_EQ(taken.error().code, ErrorCode::Unreachable) << describe(taken.error());
  EXPECT_EQ(driver.ensure_open().error().code, ErrorCode::Unreachable);

  ASSERT_TRUE(bus.plug());
  const Instant deadline = clock.now() + kPatience;
  auto who = driver.ensure_open();
  while (!who && clock.now() < deadline) who = driver.ensure_open();  // libusb hears of it in a thread of its own
  ASSERT_TRUE(who) << describe(who.error());
  ASSERT_TRUE(driver.apply(config().settings));
  expect_right_reading();
}

TEST_P(UsbBusTest, IsPulledAndPutBackByAFault) {
  PlannedFault pulled{.kind = FaultKind::RadiometerUnplugged, .after = 3};
  pulled.values[FaultParameter::Role] = static_cast<double>(FaultRole::Monitor);
  ASSERT_TRUE(driver.ensure_open());
  ASSERT_TRUE(meter.with_instrument([&](Instrument& i, Instant now) { return i.arm(pulled, now); }));
  bus.look_at_faults();

  const Collected taken = take(driver);
  meter.with_instrument([](Instrument& i, Instant now) { i.end_fault(FaultKind::RadiometerUnplugged, now); });
  bus.look_at_faults();
  const Instant deadline = clock.now() + kPatience;
  auto who = driver.ensure_open();
  while (!who && clock.now() < deadline) who = driver.ensure_open();

  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::Unreachable) << describe(taken.error());
  ASSERT_TRUE(who) << describe(who.error());
  expect_right_reading();
}

TEST_P(UsbBusTest, GivesTheInterfaceToOneOnly) {
  ASSERT_TRUE(driver.ensure_open());
  drivers::LibusbUsbtmcLink second(usb());

  const auto who = second.open();

  ASSERT_FALSE(who);
  EXPECT_EQ(who.error().code, ErrorCode::ControlLost);
  expect_right_reading();
  link.close();
  EXPECT_TRUE(second.open());
}

TEST_P(UsbBusTest, IsSearchedForTheSerialNumber) {
  drivers::LibusbUsbtmcLink other(usb("SIM-PM-02"));
  EXPECT_EQ(other.open().error().code, ErrorCode::WrongDevice);
  EXPECT_THAT(describe(other.open().error()), HasSubstr("serial SIM-PM-01"));

  drivers::LibusbConfig another_kind = usb();
  another_kind.product_id = 2;
  drivers::LibusbUsbtmcLink absent(another_kind);
  EXPECT_EQ(absent.open().error().code, ErrorCode::Unreachable);
}

// Detector and monitor: two devices of one kind, told apart by their serial numbers.
TEST(UsbBusWithTwoMeters, LetsEachDriverFindItsOwnWhichStaysWhenTheOtherGoes) {
  SystemClock clock;
  LiveInstrument instrument{quiet_scene(), {}, clock};
  RadiometerSpec bright = quiet_radiometer();
  bright.place = RadiometerPlace::Monitor;
  RadiometerSpec dim = bright;
  dim.serial = "SIM-PM-02";
  dim.watts = 5e-4;
  LiveRadiometer first{instrument, bright};
  LiveRadiometer second{instrument, dim};
  UsbBus bus({&first, &second});
  ASSERT_TRUE(bus.plug(0));
  ASSERT_TRUE(bus.plug(1));
  const auto config = [](const std::string& serial) {
    return drivers::ScpiRadiometerConfig{
        .serial = serial,
        .settings = {.wavelength = nanometres(568.0), .range_w = 1e-2, .averages = 1, .samples = 4},
        .range_settle = 5ms,
        .reply_margin = kPatience,
        .transfer_timeout = kPatience};
  };
  const auto usb = [](const std::string& serial) {
    return drivers::LibusbConfig{
        .vendor_id = UsbtmcFunction::kVendor, .product_id = UsbtmcFunction::kProduct, .serial = serial};
  };
  drivers::LibusbUsbtmcLink link_a(usb("SIM-PM-01")), link_b(usb("SIM-PM-02"));
  drivers::ScpiRadiometer a(link_a, config("SIM-PM-01"), clock), b(link_b, config("SIM-PM-02"), clock);
  const auto take = [](drivers::ScpiRadiometer& from) {
    EXPECT_TRUE(from.trigger());
    const auto taken = from.collect(kPatience);
    EXPECT_TRUE(taken && *taken);
    return taken && *taken ? (*taken)->mean_w : 0.0;
  };

  EXPECT_NEAR(take(a), 1e-3, 1e-12);
  EXPECT_NEAR(take(b), 5e-4, 1e-12);
  bus.unplug(0);
  const auto gone = a.trigger();
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::Unreachable) << describe(gone.error());
  EXPECT_NEAR(take(b), 5e-4, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(StatusByte, UsbBusTest, testing::Bool(), [](const auto& with_interrupt) {
  return with_interrupt.param ? "OnTheInterruptEndpoint" : "InTheControlAnswer";
});

}  // namespace
}  // namespace gonio::sim::test
