#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>

#include "cli/run.h"

namespace {

std::atomic<bool> interrupted{false};

void on_interrupt(int) {
  interrupted = true;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, &on_interrupt);
  std::signal(SIGPIPE, SIG_DFL);
  const char* connect = std::getenv("GONIOD_CONNECT");
  gonio::cli::World world{.out = std::cout,
                          .err = std::cerr,
                          .out_is_terminal = isatty(STDOUT_FILENO) == 1,
                          .interrupted = interrupted,
                          .default_connect = connect == nullptr ? "http://127.0.0.1:8470" : connect};
  return gonio::cli::run({argv + 1, argv + argc}, world);
}
