#include "sim/devices/scpi_header.h"

#include <gtest/gtest.h>

namespace gonio::sim {
namespace {

constexpr std::string_view kRange = "SENSe:POWer:[DC]:RANGe:[UPPer]";

TEST(ScpiHeader, IsKnownInShortAndLongFormInAnyCase) {
  for (const char* header : {"SENS:POW:RANG", "SENSE:POWER:DC:RANGE:UPPER", "sens:power:rang:upp", ":SENS:POW:DC:RANG",
                             "SENSe:POWer:RANGe"}) {
    EXPECT_TRUE(is_header(kRange, header)) << header;
  }
}

TEST(ScpiHeader, IsNotKnownInAnyOtherForm) {
  for (const char* header : {"", ":", "SENSO:POW:RANG", "SENS:POWE:RANG", "SENS:POW", "SENS:POW:RANG:UPP:X", "POW:RANG",
                             "SENS:POW:RANG?", "SENS::RANG"}) {
    EXPECT_FALSE(is_header(kRange, header)) << header;
  }
}

TEST(ScpiHeader, IsAQueryOrACommand) {
  EXPECT_TRUE(is_header("SYSTem:ERRor:[NEXT]?", "SYST:ERR?"));
  EXPECT_FALSE(is_header("SYSTem:ERRor:[NEXT]?", "SYST:ERR"));
}

}  // namespace
}  // namespace gonio::sim
