// Every verb in every situation of a scan: taken, or refused with the state, what it takes, and nothing changed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "daemon/sequencer/scan_machine.h"
#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using std::chrono::hours;
using test::ScanRig;
using testing::HasSubstr;

api::Plan plan_of_two() {
  api::Plan plan = test::bench_plan({30}, {10, 40}, {90});
  plan.target_snr = 300;
  return plan;
}

// One situation in the making: the scan that is asked for something, on a rig of its own.
struct Stand {
  explicit Stand(const Instrument& instrument) : rig(instrument) {}

  void submit(ScanTurn turn = {}) {
    NewScan scan = test::new_scan(plan_of_two());
    scan.turn = turn;
    const CommandId command = rig.command(SubmitScan{std::move(scan)});
    ASSERT_TRUE(rig.run_until([&] { return rig.reply_to(command) != nullptr; }));
    id = rig.reply_to(command)->result->scan;
  }
  void until(const std::function<bool()>& reached) { ASSERT_TRUE(rig.run_until(reached)); }
  void until_doing(const std::string& what) {
    until([&] { return rig.status().doing == what; });
  }
  void until_asked(const std::string& request) {
    until([&] { return rig.asked == request; });
  }
  void until_state(ScanState state) {
    until([&] { return rig.status().active && rig.status().active->state == state; });
  }
  void command(Verb verb) { rig.command(std::move(verb)); }

  ScanRig rig;
  ScanId id = 0;
};

struct Situation {
  std::string_view name;
  std::string_view takes;  ///< by letter, see kAsks
  std::string_view state;  ///< that a refusal names
  std::function<void(Stand&)> reach;
  std::function<void(Instrument&)> instrument = [](Instrument&) {};
};

struct Ask {
  char letter;
  const char* action;  ///< as audit has it
  std::function<Verb(ScanId)> verb;
};

MoveStage move_by_hand() {
  MoveStage move;
  move.target[stage::index_of(stage::Axis::Carriage)] = 5.0;
  return move;
}

const std::array<Ask, 11> kAsks{{
    {'P', "pause", [](ScanId id) { return PauseScan{.scan = id}; }},
    {'N', "pause", [](ScanId id) { return PauseScan{.scan = id, .now = true}; }},
    {'R', "resume", [](ScanId id) { return ResumeScan{.scan = id}; }},
    {'r', "resume", [](ScanId id) { return ResumeScan{.scan = id, .hold = HoldName::Operator}; }},
    {'F', "finish", [](ScanId id) { return FinishScan{id}; }},
    {'A', "abort", [](ScanId id) { return AbortScan{.scan = id}; }},
    {'S', "skip", [](ScanId id) { return SkipItemInHand{id}; }},
    {'C', "change", [](ScanId id) { return ChangeScan{.scan = id, .target_snr = 200.0}; }},
    {'M', "stage move", [](ScanId) { return move_by_hand(); }},
    {'H', "stage home", [](ScanId) { return HomeStage{}; }},
    {'L', "stage reset", [](ScanId) { return ClearStage{}; }},
}};

std::string action_of(char letter) {
  for (const Ask& ask : kAsks) {
    if (ask.letter == letter) return ask.action;
  }
  return "";
}

void to_end(Stand& stand) {
  stand.rig.run_to_rest();
}

void pause_at_first_item(Stand& stand) {
  stand.submit();
  stand.until_doing("exposing");
  stand.command(PauseScan{.scan = stand.id, .reason = "look"});
  to_end(stand);
}

void want_warm_lamp(Instrument& instrument) {
  instrument.lamp.before_shutter = true;
  instrument.lamp.warm_up =
      LampWarmUp{.slope_per_s = 1e-4, .over = std::chrono::seconds(60), .at_most = std::chrono::minutes(10)};
}

std::vector<Situation> waiting_situations() {
  return {
      {"queued behind another scan", "PNAC", "queued",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.submit();
       }},
      {"paused in the queue", "PNRrAC", "queued",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.submit();
         s.command(PauseScan{.scan = s.id});
         const std::string one_hold = "SELECT count(*) FROM hold WHERE name = 'operator'";
         s.until([&] { return s.rig.count(one_hold) == 1; });
       }},
      {"waiting for its time", "PNACMHL", "queued",
       [](Stand& s) {
         const Instant at = s.rig.clock().now() + hours(1);
         s.submit({.start = ScanTurn::Start{.at = at, .utc = s.rig.clock().utc_now() + hours(1)}});
       }},
      {"set aside by a more urgent scan", "PNAC", "preempted",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         const ScanId first = s.id;
         s.submit({.priority = 5, .preempts = true});
         s.until([&] { return s.rig.status().active && s.rig.status().active->scan == s.id; });
         s.until_doing("exposing");
         s.id = first;
       }},
      {"holding for the operator", "PNRrFASCMHL", "holding", pause_at_first_item},
      {"holding, and its store was read again", "PNRrFASCMHL", "holding",
       [](Stand& s) {
         pause_at_first_item(s);
         s.rig.kill();
         s.rig.start();
         to_end(s);
       }},
      {"holding for a lamp that is out", "PNFASCMHL", "holding",
       [](Stand& s) {
         s.rig.world.monitor = 0.01;
         s.submit();
         to_end(s);
       }},
      {"holding for an open door", "PNFASCMHL", "holding",
       [](Stand& s) {
         s.rig.world.stage.interlock_open = true;
         s.submit();
         to_end(s);
       }},
      {"holding for operator and lamp", "PNRrFASCMHL", "holding",
       [](Stand& s) {
         s.rig.world.monitor = 0.01;
         s.submit();
         to_end(s);
         s.command(PauseScan{.scan = s.id});
         to_end(s);
       }},
      {"holding for a full disk", "PNFASCMHL", "holding",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.rig.tell_disk(1000);
         to_end(s);
       }},
      {"stopped", "PNASCL", "stopped",  // what moves is the stage's own refusal
       [](Stand& s) {
         s.submit();
         s.until_doing("moving");
         s.rig.stop();
         to_end(s);
       }},
      {"just found at start-up", "PNRAC", "interrupted",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.rig.kill();
         s.rig.start();
         s.until([&] { return s.rig.status().active.has_value(); });  // the transition is under way
       }},
  };
}

std::vector<Situation> busy_situations() {
  const auto preparing = [](const char* request, const std::function<void(Stand&)>& before) {
    return [=](Stand& s) {
      before(s);
      s.submit();
      s.until_state(ScanState::Preparing);
      s.until_asked(request);
    };
  };
  const auto nothing = [](Stand&) {};
  return {
      {"its start is being written", "PNFASC", "preparing",
       [](Stand& s) {
         s.submit();
         s.until([&] { return s.rig.status().active.has_value(); });
       }},
      {"preparing: detector", "PNFASC", "preparing", preparing("prepare", nothing)},
      {"preparing: first look", "PNFASC", "preparing", preparing("look", nothing)},
      {"preparing: stage still moves", "PNFASC", "preparing",
       [](Stand& s) {
         s.rig.world.moving_until = s.rig.clock().now() + std::chrono::milliseconds(500);
         s.submit();
         s.until_asked("look");
         s.rig.step();  // the answer has come: it looks again in a while
       }},
      {"preparing: reset", "PNFASC", "preparing",
       preparing("reset", [](Stand& s) { s.rig.world.stage.heartbeat_tripped = true; })},
      {"preparing: homing", "PNFASC", "preparing",
       preparing("home", [](Stand& s) { s.rig.world.stage.homed = false; })},
      {"preparing: lamp not warm", "PNFASC", "preparing",
       [](Stand& s) {
         s.submit();
         s.until_doing("waiting for the lamp to be warm");
         s.until_asked("look");
       },
       want_warm_lamp},
      {"running: to the dark", "PNFAC", "running",
       [](Stand& s) {
         s.submit();
         s.until_state(ScanState::Running);
         s.until_asked("move");
       }},
      {"running: exposing the dark", "PNFAC", "running",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing the dark");
       }},
      {"running: moving", "PNFASC", "running",
       [](Stand& s) {
         s.submit();
         s.until([&] { return s.rig.status().active && s.rig.status().active->in_hand; });
         s.until_doing("moving");
       }},
      {"running: exposing", "PNFASC", "running",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
       }},
      {"running: an item is being written", "PNFASC", "running",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.until_asked("commit");
       }},
      {"running, paused after its item", "PNRrFASC", "running",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.command(PauseScan{.scan = s.id});
       }},
      {"running, finish asked", "PNASC", "running",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.command(FinishScan{s.id});
       }},
      {"finishing: dark", "PNA", "finishing",
       [](Stand& s) {
         s.submit();
         s.until_state(ScanState::Finishing);
         s.until_doing("exposing the dark");
       }},
      {"finishing: parking", "PNA", "finishing",
       [](Stand& s) {
         s.submit();
         s.until_state(ScanState::Finishing);
         s.until_doing("exposing the dark");
         s.until_doing("moving");
       }},
  };
}

std::vector<Situation> ended_situations() {
  return {
      {"done", "MHL", "done",
       [](Stand& s) {
         s.submit();
         to_end(s);
       }},
      {"finished early", "MHL", "finished-early",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.command(FinishScan{s.id});
         to_end(s);
       }},
      {"aborted", "MHL", "aborted",
       [](Stand& s) {
         s.submit();
         s.until_doing("exposing");
         s.command(AbortScan{.scan = s.id});
         to_end(s);
       }},
      {"failed", "MHL", "failed",
       [](Stand& s) {
         NewScan scan = test::new_scan(plan_of_two());
         scan.policy.on_item_error = api::OnItemError::Fail;
         s.rig.world.rate_dn_per_s = [](double, bool) { return 1e9; };
         const CommandId command = s.rig.command(SubmitScan{std::move(scan)});
         to_end(s);
         s.id = s.rig.reply_to(command)->result->scan;
       }},
  };
}

struct Outcome {
  std::string events;
  std::map<std::string, std::int64_t> audits;  ///< by action
  ScanState state = ScanState::Queued;
};

Outcome outcome_of(Stand& stand) {
  stand.rig.run_to_rest();
  Outcome outcome{.state = stand.rig.state_of(stand.id)};
  for (const Ask& ask : kAsks) {
    const std::string action = ask.action;
    outcome.audits[action] = stand.rig.count("SELECT count(*) FROM audit WHERE action = '" + action + "'");
  }
  for (const EventRecord& event : stand.rig.events) {
    outcome.events += std::to_string(event.scan) + " " + event.kind + " by " + event.who + "\n";
  }
  return outcome;
}

// Where a verb that was taken leads when nobody says anything more.
void expect_taken(char letter, Stand& stand, const Outcome& without) {
  const Outcome now = outcome_of(stand);
  const std::string action = action_of(letter);
  EXPECT_GT(now.audits.at(action), without.audits.at(action)) << "who did it is recorded: " << action;
  const bool was_queued = stand.rig.count("SELECT count(*) FROM event WHERE kind = 'scan-preparing' AND scan_id = " +
                                          std::to_string(stand.id)) == 0;
  if (letter == 'A') {
    EXPECT_EQ(now.state, ScanState::Aborted);
  }
  if (letter == 'F') {
    const bool may_not_park = stand.rig.world.stage.interlock_open;
    EXPECT_EQ(now.state, may_not_park ? ScanState::Holding : ScanState::FinishedEarly);
  }
  if (letter == 'P' || letter == 'N') {
    EXPECT_EQ(now.state, was_queued ? ScanState::Queued : ScanState::Holding);
  }
  if (letter == 'S') {
    EXPECT_GT(stand.rig.count("SELECT count(*) FROM item WHERE outcome = 'skipped' AND who = 'uid:1000'"), 0);
  }
  if (letter == 'C') {
    EXPECT_EQ(stand.rig.count("SELECT count(*) FROM event WHERE kind = 'scan-changed'"), 1);
    EXPECT_EQ(now.state, without.state);
  }
}

void expect_refused(char letter, const Error& error, Stand& stand, const Situation& situation, const Outcome& without) {
  EXPECT_EQ(error.code, ErrorCode::WrongState) << describe(error);
  const bool is_of_the_stage = letter == 'M' || letter == 'H' || letter == 'L';  // whoever has it, is named
  EXPECT_THAT(error.seen, HasSubstr(is_of_the_stage ? "scan " : std::string(situation.state)));
  EXPECT_FALSE(error.limit.empty()) << describe(error);
  const Outcome now = outcome_of(stand);
  EXPECT_EQ(now.events, without.events);
  EXPECT_EQ(now.audits, without.audits);
  EXPECT_EQ(now.state, without.state);
}

std::unique_ptr<Stand> stand_at(const Situation& situation) {
  Instrument instrument = test::bench_instrument();
  situation.instrument(instrument);
  auto stand = std::make_unique<Stand>(instrument);
  situation.reach(*stand);
  return stand;
}

void walk(const Situation& situation) {
  SCOPED_TRACE(std::string(situation.name));
  const Outcome without = outcome_of(*stand_at(situation));
  for (const Ask& ask : kAsks) {
    SCOPED_TRACE(std::string("verb ") + ask.letter);
    const auto stand = stand_at(situation);
    if (testing::Test::HasFatalFailure()) return;
    const CommandId command = stand->rig.command(ask.verb(stand->id));
    ASSERT_TRUE(stand->rig.run_until([&] { return stand->rig.reply_to(command) != nullptr; })) << "no answer";
    const Result<CommandDone>& result = stand->rig.reply_to(command)->result;
    const bool is_taken = situation.takes.find(ask.letter) != std::string_view::npos;
    const bool is_of_the_stage = situation.state == "stopped" && (ask.letter == 'M' || ask.letter == 'H');
    EXPECT_EQ(result.has_value(), is_taken || (is_of_the_stage && result.has_value()))
        << (result ? "" : describe(result.error()));
    if (is_of_the_stage || result.has_value() != is_taken) continue;
    if (is_taken) {
      expect_taken(ask.letter, *stand, without);
    } else {
      expect_refused(ask.letter, result.error(), *stand, situation, without);
    }
  }
}

TEST(ScanVerbs, AreTakenOrRefusedWhereAScanWaits) {
  for (const Situation& situation : waiting_situations()) walk(situation);
}

TEST(ScanVerbs, AreTakenOrRefusedWhileSomethingIsUnderWay) {
  for (const Situation& situation : busy_situations()) walk(situation);
}

TEST(ScanVerbs, AreTakenOrRefusedWhenAScanIsOver) {
  for (const Situation& situation : ended_situations()) walk(situation);
}

TEST(ScanVerbs, StopHoldsWhateverIsUnderWayAndLeavesTheRest) {
  const auto stop_in = [](const Situation& situation) {
    SCOPED_TRACE(std::string(situation.name));
    const auto stand = stand_at(situation);
    const ScanState before = stand->rig.state_of(stand->id);

    stand->rig.stop();
    stand->rig.run_to_rest();

    const ScanState after = stand->rig.state_of(stand->id);
    const bool never_started = before == ScanState::Queued && after == ScanState::Queued;
    EXPECT_TRUE(after == ScanState::Holding || never_started || is_over(before)) << scan_state_name(after);
    EXPECT_EQ(stand->rig.count("SELECT count(*) FROM audit WHERE action = 'stop' AND who = 'uid:7'"), 1);
  };
  for (const Situation& situation : waiting_situations()) {
    if (situation.state != "stopped" && situation.name != "waiting for its time") stop_in(situation);
  }
  for (const Situation& situation : busy_situations()) stop_in(situation);
  for (const Situation& situation : ended_situations()) stop_in(situation);
}

TEST(ScanVerbs, OfAScanThatThereNeverWasAreRefusedByItsNumber) {
  Stand stand(test::bench_instrument());
  for (const Ask& ask : kAsks) {
    if (std::string_view("MHL").find(ask.letter) != std::string_view::npos) continue;
    const CommandId command = stand.rig.command(ask.verb(77));
    ASSERT_TRUE(stand.rig.run_until([&] { return stand.rig.reply_to(command) != nullptr; }));
    EXPECT_EQ(stand.rig.reply_to(command)->result.error().code, ErrorCode::NotFound);
    EXPECT_THAT(stand.rig.reply_to(command)->result.error().tried, HasSubstr("77"));
  }
}

}  // namespace
}  // namespace gonio::daemon
