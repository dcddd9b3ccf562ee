#include "tests/support/platters.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace gonio::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSector = 512;

void put(std::vector<char>& content, std::size_t at, const char* from, std::size_t n) {
  if (content.size() < at + n) content.resize(at + n);
  std::copy_n(from, n, content.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace

Platters::File& Platters::at(const std::string& path) {
  const auto [found, is_new] = files_.try_emplace(path);
  if (is_new && fs::exists(path)) {
    // What lay there before had all the time to sink in.
    std::ifstream file(path, std::ios::binary);
    found->second.exists = true;
    found->second.content.assign(std::istreambuf_iterator<char>(file), {});
  }
  return found->second;
}

void Platters::write(const std::string& path, std::size_t at, const char* bytes, std::size_t n) {
  note(path, {.kind = Change::Kind::Write, .at = at, .bytes = Bytes(bytes, bytes + n)});
}

void Platters::truncate(const std::string& path, std::size_t size) {
  note(path, {.kind = Change::Kind::Truncate, .at = size, .bytes = {}});
}

void Platters::create(const std::string& path) {
  note(path, {.kind = Change::Kind::Create, .bytes = {}});
}

void Platters::remove(const std::string& path) {
  note(path, {.kind = Change::Kind::Remove, .bytes = {}});
}

void Platters::sync_file(const std::string& path) {
  File& file = at(path);
  for (Change& change : file.later) change.is_down = change.is_down || !change.is_of_the_directory();
  sink_in(file);
}

void Platters::sync_directory(const std::string& path) {
  const fs::path directory = fs::path(path).parent_path();
  for (auto& [name, file] : files_) {
    if (fs::path(name).parent_path() != directory) continue;
    for (Change& change : file.later) change.is_down = change.is_down || change.is_of_the_directory();
    sink_in(file);
  }
}

// In their order: what is down behind something that is not stays in the list.
void Platters::sink_in(File& file) {
  const auto first_in_doubt = std::ranges::find(file.later, false, &Change::is_down);
  std::for_each(file.later.begin(), first_in_doubt, [&file](const Change& change) { apply(change, file); });
  file.later.erase(file.later.begin(), first_in_doubt);
}

void Platters::apply(const Change& change, File& file) {
  switch (change.kind) {
    case Change::Kind::Write:
      return put(file.content, change.at, change.bytes.data(), change.bytes.size());
    case Change::Kind::Truncate:
      return file.content.resize(std::min(file.content.size(), change.at));
    case Change::Kind::Create:
      file.exists = true;
      return;
    case Change::Kind::Remove:
      file.exists = false;
      return file.content.clear();
  }
}

void Platters::cut(File& file, double share_kept, std::mt19937_64& chance) {
  std::bernoulli_distribution keeps(share_kept);
  for (const Change& change : file.later) {
    if (change.kind == Change::Kind::Write && !change.is_down) {
      for (std::size_t from = 0; from < change.bytes.size();) {
        const std::size_t rest_of_sector = kSector - (change.at + from) % kSector;
        const std::size_t n = std::min(rest_of_sector, change.bytes.size() - from);
        if (keeps(chance)) put(file.content, change.at + from, change.bytes.data() + from, n);
        from += n;
      }
    } else if (change.is_down || keeps(chance)) {
      apply(change, file);
    } else if (change.is_of_the_directory()) {
      break;  // the name still says what it said: what came later was done to another file
    }
  }
  file.later.clear();
}

void Platters::cut(std::mt19937_64& chance) {
  // Now nothing gets through, now all of it, mostly a part.
  constexpr double kShares[] = {0.0, 1.0, 0.5, 0.1, 0.9, 0.5};
  const double share = kShares[std::uniform_int_distribution<std::size_t>(0, std::size(kShares) - 1)(chance)];
  for (auto& [path, file] : files_) {
    cut(file, share, chance);
    if (!file.exists) {
      fs::remove(path);
      file.content.clear();
      continue;
    }
    std::ofstream real(path, std::ios::binary | std::ios::trunc);
    real.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
    if (!real.flush()) throw std::runtime_error("cannot write " + path);
  }
}

}  // namespace gonio::test
