#include "tests/fuzz/scratch_folder.h"

#include <stdlib.h>

#include <fstream>

#include "tests/fuzz/promise.h"

namespace gonio::fuzz {

ScratchFolder::ScratchFolder() {
  const std::filesystem::path memory = "/dev/shm";
  const auto parent = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  std::string name = (parent / "gonio-fuzz-XXXXXX").string();
  hold(::mkdtemp(name.data()) != nullptr, "a folder can be made in " + parent.string());
  folder_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void ScratchFolder::write(const std::string& name, std::string_view text) const {
  std::ofstream out(path(name), std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  hold(out.good(), "a file can be written in " + folder_.string());
}

}  // namespace gonio::fuzz
