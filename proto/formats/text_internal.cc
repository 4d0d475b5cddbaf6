#include "proto/formats/text_internal.h"

#include <charconv>
#include <cmath>

#include "proto/formats/frame_note.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {
constexpr std::string_view kBlanks = " \t\r\f\v";
}

std::string_view Words::next() {
  const std::size_t begin = rest_.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    rest_ = {};
    return {};
  }
  const std::size_t end = std::min(rest_.find_first_of(kBlanks, begin), rest_.size());
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  if (word.starts_with('+')) return std::nullopt;
  double value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ptr != word.data() + word.size() || word.empty()) return std::nullopt;
  if (read.ec == std::errc::result_out_of_range) return std::nullopt;
  if (read.ec != std::errc{}) return std::nullopt;
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  std::int64_t value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc{} || read.ptr != word.data() + word.size()) return std::nullopt;
  return value;
}

Result<Position> read_position(Words& words) {
  double values[3];
  for (double& value : values) {
    const auto number = to_number(words.next());
    if (!number) return error(Code::kMalformed, "three numbers must stand here");
    if (!std::isfinite(*number)) return error(Code::kNotFinite, "a coordinate is not a finite number");
    value = *number;
  }
  return Position{values[0], values[1], values[2]};
}

tin::base::Error at_line(Code code, const std::string& what, std::uint64_t line) {
  return error(code, "Line " + std::to_string(line) + ": " + what, "line " + std::to_string(line));
}

Result<void> add_point(MeshPoints& mesh, const Position& at, const ReadLimits& limits) {
  if (mesh.points.size() >= limits.points) {
    return error(Code::kTooLarge,
                 "The file holds more than " + std::to_string(limits.points) + " elevations, the limit here");
  }
  mesh.points.push_back(at);
  return {};
}

Result<void> read_comment(MeshPoints& mesh, std::string_view comment) {
  const std::string_view note = find_frame_note(comment);
  if (note.empty()) return {};
  auto frame = read_frame_note(note);
  if (!frame) {
    return error(Code::kMalformed, "The note on the lattice (" + std::string(kFrameNoteName) +
                                       ") is damaged: " + frame.error().message);
  }
  mesh.frame = *std::move(frame);
  return {};
}

std::string one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return line;
}

}  // namespace proto::formats
