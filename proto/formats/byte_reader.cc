#include "proto/formats/byte_reader.h"

#include <algorithm>
#include <array>
#include <system_error>

namespace proto::formats {

bool ByteReader::read_fully(char* to, std::size_t size) {
  while (size > 0) {
    const std::size_t got = read(to, size);
    if (got == 0) return false;
    to += got;
    size -= got;
  }
  return true;
}

bool ByteReader::skip(std::uint64_t size) {
  std::array<char, 4096> nowhere;
  for (; size > 0; size -= std::min<std::uint64_t>(size, nowhere.size())) {
    if (!read_fully(nowhere.data(), static_cast<std::size_t>(std::min<std::uint64_t>(size, nowhere.size()))))
      return false;
  }
  return true;
}

FileReader::FileReader(const std::filesystem::path& file)
    : file_(std::fopen(file.c_str(), "rb")), failed_(file_ == nullptr) {
  std::error_code problem;
  const auto bytes = std::filesystem::file_size(file, problem);
  if (!problem) size_ = bytes;
}

std::size_t FileReader::read(char* to, std::size_t size) {
  if (failed_) return 0;
  const std::size_t got = std::fread(to, 1, size, file_.get());
  if (got == 0) failed_ = std::ferror(file_.get()) != 0;
  return got;
}

std::size_t MemoryReader::read(char* to, std::size_t size) {
  const std::size_t got = std::min(size, rest_.size());
  if (got > 0) std::memcpy(to, rest_.data(), got);
  rest_.remove_prefix(got);
  return got;
}

bool LineReader::fill() {
  if (failed() || at_end_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ == kLongestLine) {
    failed_ = true;
    return false;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  const std::size_t got = source_.read(buffer_.data() + end_, buffer_.size() - end_);
  at_end_ = got == 0;
  end_ += got;
  bytes_ += got;
  return got > 0;
}

std::optional<std::string_view> LineReader::next() {
  for (std::size_t searched = 0;;) {
    const char* const begin = buffer_.data() + begin_;
    const void* const newline = std::memchr(begin + searched, '\n', end_ - begin_ - searched);
    if (newline == nullptr) {
      searched = end_ - begin_;
      if (fill()) continue;
      if (failed() || begin_ == end_) return std::nullopt;
    }
    const std::size_t length = newline == nullptr
                                   ? end_ - begin_
                                   : static_cast<std::size_t>(static_cast<const char*>(newline) - begin);
    std::string_view line(buffer_.data() + begin_, length);
    begin_ += length + (newline == nullptr ? 0 : 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (++number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    return line;
  }
}

bool LineReader::read_fully(char* to, std::size_t size) {
  const std::size_t held = std::min(size, end_ - begin_);
  std::memcpy(to, buffer_.data() + begin_, held);
  begin_ += held;
  bytes_ += size - held;
  return source_.read_fully(to + held, size - held);
}

}  // namespace proto::formats
