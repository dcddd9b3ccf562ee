// The data of the figures of C. D. Mobley, "Informal Notes on Reflectances" (2005), that are formulas.
// Usage: reflectance_figures FOLDER   Writes into FOLDER what lobe.gnuplot draws; `scripts/figures` does both.
#include <cstdio>

#include "bench/figures/figure.h"

int main(int argc, char** argv) {
  using namespace gonio;
  if (argc != 2) {
    std::fprintf(stderr, "usage: reflectance_figures FOLDER\n");
    return 2;
  }
  std::error_code error;
  std::filesystem::create_directories(argv[1], error);  // a folder that is not there shows when it is written into
  const Result<std::vector<bench::Figure>> figures = bench::notes_figures();
  if (!figures) {
    std::fprintf(stderr, "%s\n", describe(figures.error()).c_str());
    return 1;
  }
  for (const bench::Figure& figure : *figures) {
    const Result<void> written = bench::write_figure(figure, argv[1]);
    if (!written) {
      std::fprintf(stderr, "%s\n", describe(written.error()).c_str());
      return 1;
    }
    std::printf("%s\n", figure.name.c_str());
  }
  return 0;
}
