#include "server/gdal/not_written.h"

#include <utility>

namespace server::gdal {

tin::base::Error not_written(std::string message, const std::filesystem::path& file) {
  constexpr std::uintmax_t kHardlyAny = 1 << 20;
  using tin::base::Code;
  std::error_code problem;
  const auto space = std::filesystem::space(file.parent_path(), problem);
  // A file system without any capacity, such as /proc, is not full.
  if (problem || space.capacity == 0 || space.available > kHardlyAny) return tin::base::error(Code::kStorage, std::move(message));
  return tin::base::error(Code::kNoSpace, std::move(message) + ": the disk is full");
}

}  // namespace server::gdal
