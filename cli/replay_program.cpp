#include "cli/replay_program.h"

#include "cli/sibling_program.h"

namespace gonio::cli {

std::vector<std::string> replay_command(const ReplayLine& wanted, const std::string& own_path) {
  std::vector<std::string> command{sibling_program("goniod", own_path),
                                   "--replay",
                                   wanted.tape,
                                   "--store",
                                   wanted.store.empty() ? wanted.tape + ".sqlite" : wanted.store,
                                   "--log-level",
                                   "error"};
  if (!wanted.against.empty()) command.insert(command.end(), {"--against", wanted.against});
  if (!wanted.instrument.empty()) command.insert(command.end(), {"--instrument", wanted.instrument});
  return command;
}

Error become_replay(const ReplayLine& wanted) {
  return become_program(replay_command(wanted, own_program()), "start goniod to replay");
}

}  // namespace gonio::cli
