#include "daemon/config/configuration_hash.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <set>

namespace gonio::daemon {
namespace {

// Where and over what a device is reached; each is left out where its table has it.
constexpr std::array<std::string_view, 6> kStageAddress{"link", "address", "port", "baud", "parity", "stop_bits"};

// The line of `key` in `[table]`, if that key starts the line it stands on.
void add_address_line(TomlReader root, std::string_view table, std::string_view key, std::set<int>& lines) {
  if (root.kind(table) != TomlKind::Table) return;
  TomlReader inner = root.table(table);
  if (inner.kind(key) != TomlKind::Absent) lines.insert(inner.location(key).line);
}

bool starts_with_key(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return false;
  const std::string_view rest = line.substr(first);
  const std::size_t end = rest.find_first_of(" \t=");
  return std::find(kStageAddress.begin(), kStageAddress.end(), rest.substr(0, end)) != kStageAddress.end();
}

}  // namespace

std::string sha256_hex(std::string_view text) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  return hex.data();
}

std::string configuration_hash(const TomlReader& root, std::string_view text) {
  std::set<int> left_out;
  for (const std::string_view key : kStageAddress) add_address_line(root, "stage", key, left_out);
  add_address_line(root, "detector", "address", left_out);
  std::string hashed;
  int number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    const std::string_view line = text.substr(begin, end - begin);
    if (!left_out.contains(number) || !starts_with_key(line)) hashed += line;
    begin = end;
  }
  return sha256_hex(hashed);
}

}  // namespace gonio::daemon
