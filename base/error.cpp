#include "base/error.h"

#include <algorithm>
#include <array>

namespace gonio {
namespace {

using enum ErrorCode;
constexpr std::string_view kNothingChanged = "Nothing was moved and nothing was written.";
constexpr std::string_view kItemKept = "Every accepted point is kept; the item under way was not accepted.";

// In the order of the enumerators: `traits` indexes it (held by a static_assert below).
constexpr std::array kTable{
    ErrorTraits{InvalidInput, "invalid-input", 422, 2, Retry::Never, "The input is not valid", kNothingChanged,
                "Correct the field or the file that the message names."},
    ErrorTraits{UnknownKey, "unknown-key", 422, 2, Retry::Never, "The input has a key that is not known",
                kNothingChanged, "Correct the spelling, or remove the key."},
    ErrorTraits{MissingKey, "missing-key", 422, 2, Retry::Never, "The input lacks a key that is needed",
                kNothingChanged, "Add the key."},
    ErrorTraits{OutOfLimits, "out-of-limits", 422, 6, Retry::Never, "The target lies outside the limits",
                kNothingChanged, "Choose a target inside the limits that the message names."},
    ErrorTraits{Blocked, "blocked", 422, 6, Retry::Never, "The detector would shadow the source", kNothingChanged,
                "Choose a geometry farther from retro-reflection."},
    ErrorTraits{AllPointsBlocked, "all-points-blocked", 422, 6, Retry::Never, "Every point of the plan is blocked",
                kNothingChanged, "Add geometries outside the detector's shadow."},
    ErrorTraits{ReferenceExpired, "reference-expired", 422, 2, Retry::Never, "The reference's certificate has expired",
                kNothingChanged, "Have the standard recalibrated and enter the new certificate."},
    ErrorTraits{ReferenceIncomplete, "reference-incomplete", 422, 2, Retry::Never,
                "The reference's certificate lacks an entry", kNothingChanged,
                "Add the entry from the certificate: coverage factor, absolute or relative, geometry, date."},
    ErrorTraits{ReferenceOutOfReach, "reference-out-of-reach", 422, 2, Retry::Never,
                "The reference does not cover a point of the plan", kNothingChanged,
                "Use a standard that covers the plan's wavelengths and geometries, or change the plan."},
    ErrorTraits{FileUnreadable, "file-unreadable", 422, 2, Retry::Never, "A file cannot be read", kNothingChanged,
                "Check the path and its permissions."},
    ErrorTraits{NotFound, "not-found", 404, 1, Retry::Never, "There is no such thing", "Nothing was changed.",
                "List what there is, then name one of those."},
    ErrorTraits{WrongState, "wrong-state", 409, 1, Retry::Never, "The present state does not allow this",
                "Nothing was changed.", "Bring it into a state that the message names."},
    ErrorTraits{ControlHeld, "control-held", 409, 5, Retry::AfterOperator, "Someone else holds control",
                "Nothing was changed.", "Ask the holder to release control."},
    ErrorTraits{NotAuthorised, "not-authorised", 403, 4, Retry::Never, "This is not allowed for you",
                "Nothing was changed.", "Use a login with the role that the message names."},
    ErrorTraits{ForbiddenOrigin, "forbidden-origin", 403, 4, Retry::Never, "The request's origin is not allowed",
                "Nothing was changed.", "Use gonioctl, or a page served by this daemon."},
    ErrorTraits{UnsupportedMediaType, "unsupported-media-type", 415, 2, Retry::Never,
                "The request's Content-Type is not one this route takes", "Nothing was changed.",
                "Declare the Content-Type that the message names."},
    ErrorTraits{TooLarge, "too-large", 413, 2, Retry::Never, "The request is larger than the limit",
                "Nothing was changed.", "Send less at once."},
    ErrorTraits{PortBusy, "port-busy", 503, 1, Retry::AfterOperator, "The address is in use by another program",
                kNothingChanged, "Stop the other program, or choose another address."},
    ErrorTraits{StoreLocked, "store-locked", 503, 1, Retry::AfterOperator, "Another daemon has this store open",
                kNothingChanged, "Stop the other daemon, or choose another store."},
    ErrorTraits{StoreTooNew, "store-too-new", 503, 1, Retry::Never, "The store was written by a newer version",
                kNothingChanged, "Use that version or a later one."},
    ErrorTraits{NoDaemon, "no-daemon", 503, 3, Retry::AfterOperator, "No daemon answers", "Nothing was changed.",
                "Start goniod, or name its address with --connect."},
    ErrorTraits{Unreachable, "unreachable", 503, 1, Retry::Again, "The device does not answer", kItemKept,
                "Check power and cable of the device; then resume."},
    ErrorTraits{TimedOut, "timed-out", 504, 7, Retry::Again, "The device took too long", kItemKept,
                "Check the device; then resume."},
    ErrorTraits{WrongDevice, "wrong-device", 503, 1, Retry::AfterOperator,
                "The device is not the one that the configuration names", kItemKept,
                "Connect the named device, or correct instrument.toml."},
    ErrorTraits{BadReply, "bad-reply", 502, 1, Retry::Again, "The device's reply makes no sense", kItemKept,
                "Check the cable and the register map."},
    ErrorTraits{DeviceRefused, "device-refused", 502, 1, Retry::Again, "The device refused the command", kItemKept,
                "Look at the named reason; reset the device if it asks for it."},
    ErrorTraits{DeviceFault, "device-fault", 503, 1, Retry::AfterOperator, "The device reports a fault", kItemKept,
                "Remove the cause, then `gonioctl stage reset`, then resume."},
    ErrorTraits{NotHomed, "not-homed", 409, 6, Retry::AfterOperator, "The stage has no home position", kItemKept,
                "`gonioctl stage home`."},
    ErrorTraits{Stopped, "stopped", 409, 6, Retry::AfterOperator, "The motion was stopped", kItemKept,
                "When it is safe: `gonioctl stage reset`, then resume."},
    ErrorTraits{StaleEpoch, "stale-epoch", 409, 6, Retry::AfterOperator,
                "The command was decided before a STOP and was refused", kItemKept,
                "When it is safe: `gonioctl stage reset`, then resume."},
    ErrorTraits{MotionLate, "motion-late", 504, 7, Retry::Again, "The motion did not arrive in its time", kItemKept,
                "Look for what blocks or slows the axis; then resume."},
    ErrorTraits{OutOfTolerance, "out-of-tolerance", 502, 1, Retry::Again,
                "The encoder left its tolerance during the reading", kItemKept,
                "Look for vibration or a slipping axis; raise its settle time."},
    ErrorTraits{PositionLost, "position-lost", 409, 6, Retry::AfterOperator,
                "The stage has restarted: its positions cannot be trusted", kItemKept,
                "`gonioctl stage home`, then resume."},
    ErrorTraits{HeartbeatTripped, "heartbeat-tripped", 409, 6, Retry::Again,
                "The stage missed the daemon's heartbeat and stopped", kItemKept,
                "Check the link to the stage; `gonioctl stage reset`, then resume."},
    ErrorTraits{Interlock, "interlock", 409, 6, Retry::AfterOperator, "An interlock is open", kItemKept,
                "Close it, then resume."},
    ErrorTraits{ControlLost, "control-lost", 503, 1, Retry::Again, "Another program took the device", kItemKept,
                "Close the other program; then resume."},
    ErrorTraits{IncompleteData, "incomplete-data", 502, 1, Retry::Again, "Part of the data did not arrive",
                "The reading was refused and is taken again.", "Check cable, switch and receive buffers."},
    ErrorTraits{StaleData, "stale-data", 502, 1, Retry::Again, "The data belong to an earlier request",
                "The reading was refused and is taken again.", "None, if it does not come back."},
    ErrorTraits{Saturated, "saturated", 422, 1, Retry::Never, "The detector is saturated",
                "The reading was refused; it is never used.", "Allow shorter exposures in instrument.toml."},
    ErrorTraits{SettingNotTaken, "setting-not-taken", 502, 1, Retry::Again,
                "The device did not take a setting: it reads back otherwise", kItemKept,
                "Choose a value that the device supports."},
    ErrorTraits{StoreFailed, "store-failed", 500, 1, Retry::AfterOperator, "The store could not be written", kItemKept,
                "Look at the disk; then resume."},
    ErrorTraits{DiskFull, "disk-full", 507, 1, Retry::AfterOperator, "The disk is full", kItemKept,
                "Make room; then resume."},
    ErrorTraits{Busy, "busy", 503, 1, Retry::Again, "Too much is asked for at once", "Nothing was changed.",
                "Try again in a moment."},
    ErrorTraits{ReplayDiffers, "replay-differs", 409, 1, Retry::Never, "The program does not do what the tape has",
                "The recording and its store are untouched; the replay's store ends here.",
                "Compare the version, the instrument's file and the record that is named."},
    ErrorTraits{Internal, "internal", 500, 1, Retry::Never, "The program broke a promise of its own", kItemKept,
                "Please report it, with the log."},
};

constexpr bool table_is_in_order() {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    if (static_cast<std::size_t>(kTable[i].code) != i) return false;
  }
  return kTable.size() == static_cast<std::size_t>(Internal) + 1;
}
static_assert(table_is_in_order());

void append_sentence_part(std::string& text, std::string_view separator, std::string_view part) {
  if (part.empty()) return;
  if (!text.empty()) text += separator;
  text += part;
}

// What a device or a user's file said may hold anything: a line's end, or what a terminal takes for a command.
std::string on_one_line(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_control = byte < 0x20 || byte == 0x7F;
    line += is_control ? std::string{'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 0xFU]} : std::string(1, c);
  }
  return line;
}

std::string location_text(const InputLocation& where) {
  std::string text = where.file;
  if (where.line > 0) text += ":" + std::to_string(where.line);
  if (!where.field.empty()) text += (text.empty() ? "" : ": ") + where.field;
  return text;
}

}  // namespace

const ErrorTraits& traits(ErrorCode code) {
  return kTable.at(static_cast<std::size_t>(code));
}

std::span<const ErrorTraits> all_error_traits() {
  return kTable;
}

std::optional<ErrorCode> error_code_from_name(std::string_view name) {
  const auto row = std::ranges::find(kTable, name, &ErrorTraits::name);
  if (row == kTable.end()) return std::nullopt;
  return row->code;
}

std::string describe(const Error& error) {
  std::string text;
  if (error.where) append_sentence_part(text, "", location_text(*error.where));
  append_sentence_part(text, ": ", error.device);
  append_sentence_part(text, ": ", error.tried);
  append_sentence_part(text, ": ", error.seen);
  append_sentence_part(text, "; limit: ", error.limit);
  append_sentence_part(text, " ", "[" + std::string(traits(error.code).name) + "]");
  return on_one_line(text);
}

std::string explain(const Error& error) {
  const ErrorTraits& row = traits(error.code);
  std::string text = describe(error);
  text += "\n  " + std::string(row.title) + ". " + std::string(row.for_the_data);
  text += "\n  What to do: " + std::string(row.remedy);
  return text;
}

}  // namespace gonio
