// libFuzzer's entry to one target, chosen when compiled.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gonio::fuzz::GONIO_FUZZ_TARGET({data, size});
  return 0;
}
