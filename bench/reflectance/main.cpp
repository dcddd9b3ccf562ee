// Error against time of the reflectance room: rho_dh, sampling, evaluation.
// Usage: bench_reflectance [--output FOLDER] [PART ...]   (PART: rho_dh, sampling, evaluation; all of them otherwise)
// Prints its tables and writes them, with every measurement, into FOLDER (the working folder otherwise).
// Ends with 1 when a claim does not hold.
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "bench/reflectance/evaluation.h"
#include "bench/reflectance/rho_dh.h"
#include "bench/reflectance/sampling.h"

int main(int argc, char** argv) {
  std::filesystem::path folder = ".";
  std::set<std::string> parts;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument == "--output" && k + 1 < argc) {
      folder = argv[++k];
    } else if (argument == "rho_dh" || argument == "sampling" || argument == "evaluation") {
      parts.insert(argument);
    } else {
      std::fprintf(stderr, "usage: bench_reflectance [--output FOLDER] [rho_dh] [sampling] [evaluation]\n");
      return 2;
    }
  }
  std::filesystem::create_directories(folder);
  const auto wanted = [&](const char* part) { return parts.empty() || parts.contains(part); };
  bool holds = true;
  if (wanted("rho_dh")) holds = gonio::bench::measure_rho_dh(folder) && holds;
  if (wanted("sampling")) holds = gonio::bench::measure_sampling(folder) && holds;
  if (wanted("evaluation")) holds = gonio::bench::measure_evaluation(folder) && holds;
  return holds ? 0 : 1;
}
