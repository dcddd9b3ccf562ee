#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace gonio::test {

/// What a disk's platter has of each file and what it has been asked since, by path: what a power cut leaves.
class Platters {
 public:
  void write(const std::string& path, std::size_t at, const char* bytes, std::size_t n);
  void truncate(const std::string& path, std::size_t size);
  void create(const std::string& path);
  void remove(const std::string& path);
  /// All that was written to the file is down. Its name in the directory need not be.
  void sync_file(const std::string& path);
  /// All that was created and deleted in the file's directory is down.
  void sync_directory(const std::string& path);

  /// What was not synced happens or not, writes sector by sector; the real files become what is left of them.
  void cut(std::mt19937_64& chance);

 private:
  using Bytes = std::vector<char>;
  struct Change {
    enum class Kind : std::uint8_t { Write, Truncate, Create, Remove };
    Kind kind = Kind::Write;
    std::size_t at = 0;  ///< of a truncation: the new size
    Bytes bytes;
    bool is_down = false;
    [[nodiscard]] bool is_of_the_directory() const { return kind == Kind::Create || kind == Kind::Remove; }
  };
  struct File {
    bool exists = false;
    Bytes content;
    std::vector<Change> later;
  };
  File& at(const std::string& path);
  void note(const std::string& path, Change change) { at(path).later.push_back(std::move(change)); }
  static void apply(const Change& change, File& file);
  static void sink_in(File& file);
  static void cut(File& file, double share_kept, std::mt19937_64& chance);

  std::map<std::string, File> files_;
};

}  // namespace gonio::test
