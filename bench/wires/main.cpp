// Exchanges a second of each link with its driver, beside a bare loop over the library below it, in turns against the
// same simulated device. Ends with 1 where ours is below 0.9 of bare. The radiometer has a program of its own
// (bench_radiometer): its emulated USB lies under every call of the C library. Usage: bench_wires [ROUNDS]
#include <algorithm>
#include <cstdlib>

#include "bench/wires/contest.h"
#include "bench/wires/contests.h"

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  gonio::bench::print_heading();
  const bool tcp = gonio::bench::hold_stage_over_tcp(rounds);
  const bool rtu = gonio::bench::hold_stage_over_rtu(rounds);
  const bool camera = gonio::bench::hold_camera(rounds);
  return tcp && rtu && camera ? EXIT_SUCCESS : EXIT_FAILURE;
}
