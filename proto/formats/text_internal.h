// Words and numbers of the text formats. For this folder only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh_points.h"
#include "tin/base/result.h"

namespace proto::formats {

/// The words of a line, between blanks and tabs.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  /// The next word; empty after the last.
  std::string_view next();
  /// What is left of the line.
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// The number that is the whole word; a leading plus is allowed, infinities and NaN are numbers too.
std::optional<double> to_number(std::string_view word);
std::optional<std::int64_t> to_integer(std::string_view word);

/// The next three words as a finite position. Errors: kMalformed, kNotFinite.
tin::base::Result<Position> read_position(Words& words);

tin::base::Error at_line(tin::base::Code code, const std::string& what, std::uint64_t line);

/// Adds a point, unless the limit is reached (kTooLarge).
tin::base::Result<void> add_point(MeshPoints& mesh, const Position& at, const ReadLimits& limits);

/// What a file's comment may have to say to us: the frame. Errors: kMalformed.
tin::base::Result<void> read_comment(MeshPoints& mesh, std::string_view comment);

/// Every few thousand calls, whether the reading may go on.
class Checkpoint {
 public:
  explicit Checkpoint(const ReadLimits& limits) : limits_(limits) {}
  tin::base::Result<void> pass(std::uint64_t bytes) {
    if (++count_ % 8192 != 0 || !limits_.check) return {};
    return limits_.check(bytes);
  }

 private:
  const ReadLimits& limits_;
  std::uint64_t count_ = 0;
};

/// Text of ours on one line: control characters become blanks.
std::string one_line(std::string_view text);

}  // namespace proto::formats
