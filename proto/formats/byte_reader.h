// Where readers of files get their bytes: a file, or memory in tests. And lines of text from them.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace proto::formats {

class ByteReader {
 public:
  virtual ~ByteReader() = default;
  /// Up to `size` bytes; 0 at the end, and when failed().
  virtual std::size_t read(char* to, std::size_t size) = 0;
  virtual bool failed() const { return false; }
  /// How many bytes there are in all.
  virtual std::uint64_t size() const = 0;

  /// Exactly `size` bytes, or false.
  bool read_fully(char* to, std::size_t size);
  /// Passes over that many bytes, or false.
  bool skip(std::uint64_t size);
};

class FileReader : public ByteReader {
 public:
  /// A file that cannot be opened is failed().
  explicit FileReader(const std::filesystem::path& file);
  std::size_t read(char* to, std::size_t size) override;
  bool failed() const override { return failed_; }
  std::uint64_t size() const override { return size_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
  bool failed_;
};

/// Borrows the bytes.
class MemoryReader : public ByteReader {
 public:
  explicit MemoryReader(std::string_view bytes) : rest_(bytes), size_(bytes.size()) {}
  std::size_t read(char* to, std::size_t size) override;
  std::uint64_t size() const override { return size_; }

 private:
  std::string_view rest_;
  std::uint64_t size_;
};

/// Reads line by line in bounded memory; accepts LF and CR LF, and skips a UTF-8 byte order mark.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  explicit LineReader(ByteReader& bytes) : source_(bytes) {}

  /// The next line without its end, valid until the next call; nothing at the end, or when failed().
  std::optional<std::string_view> next();

  /// The number of the line that next() gave, from 1.
  std::uint64_t number() const { return number_; }
  std::uint64_t bytes_read() const { return bytes_; }
  /// Whether the source could not be read, or has a line longer than kLongestLine.
  bool failed() const { return failed_ || source_.failed(); }

  /// Exactly `size` bytes from where the last line ended, or false.
  bool read_fully(char* to, std::size_t size);

 private:
  bool fill();

  ByteReader& source_;
  std::vector<char> buffer_ = std::vector<char>(kLongestLine / 16);  // grows up to the whole
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t number_ = 0, bytes_ = 0;
  bool failed_ = false, at_end_ = false;
};

}  // namespace proto::formats
