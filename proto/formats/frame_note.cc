#include "proto/formats/frame_note.h"

#include "proto/json_read.h"
#include "proto/json_write.h"

namespace proto::formats {
namespace {

using tin::base::Code;
using tin::base::Result;
using tin::frame::Axis;
using tin::frame::Frame;

constexpr std::size_t kLongestName = 64 * 1024;
constexpr std::int64_t kMostParts = 1'000'000'000'000;

void write_axis(JsonWriter& json, std::string_view name, const Axis& axis) {
  json.key(name).begin_object();
  json.key("origin").number(axis.origin);
  json.key("unit").number(axis.unit);
  json.key("parts").integer(static_cast<std::uint64_t>(axis.parts));
  json.end_object();
}

/// The number of this name, > 0 if so demanded.
Result<double> number(const Object& object, std::string_view name, bool positive) {
  const auto value = object.require(name);
  if (!value) return value.error();
  const auto number = value->number();
  if (number && positive && !(*number > 0)) return value->error(Code::kInvalidValue, "must be above 0");
  return number;
}

Result<Axis> read_axis(const Object& object, std::string_view name) {
  const auto value = object.require(name);
  if (!value) return value.error();
  const auto axis = value->object({"origin", "unit", "parts"});
  if (!axis) return axis.error();
  const auto origin = number(*axis, "origin", false), unit = number(*axis, "unit", true);
  if (!origin) return origin.error();
  if (!unit) return unit.error();
  const auto parts_value = axis->require("parts");
  if (!parts_value) return parts_value.error();
  const auto parts = parts_value->integer(1, kMostParts);
  if (!parts) return parts.error();
  return Axis{*origin, *unit, *parts};
}

Result<std::string> text(const Object& object, std::string_view name) {
  const auto value = object.require(name);
  if (!value) return value.error();
  const auto string = value->string(kLongestName);
  if (!string) return string.error();
  return std::string(*string);
}

}  // namespace

std::string frame_note(const Frame& frame) {
  JsonWriter json;
  json.begin_object();
  json.key("crs").string(frame.crs);
  write_axis(json, "x", frame.x);
  write_axis(json, "y", frame.y);
  json.key("verticalUnit").begin_object();
  json.key("name").string(frame.vertical_unit);
  json.key("metres").number(frame.vertical_unit_m);
  json.end_object().end_object();
  return json.take();
}

Result<Frame> read_frame_note(std::string_view note) {
  const auto document = Document::parse(note);
  if (!document) return document.error();
  const auto object = document->root().object({"crs", "x", "y", "verticalUnit"});
  if (!object) return object.error();
  const auto crs = text(*object, "crs");
  if (!crs) return crs.error();
  const auto x = read_axis(*object, "x"), y = read_axis(*object, "y");
  if (!x) return x.error();
  if (!y) return y.error();
  const auto unit_value = object->require("verticalUnit");
  if (!unit_value) return unit_value.error();
  const auto unit = unit_value->object({"name", "metres"});
  if (!unit) return unit.error();
  const auto name = text(*unit, "name");
  if (!name) return name.error();
  const auto metres = number(*unit, "metres", true);
  if (!metres) return metres.error();
  return Frame{*crs, *x, *y, *name, *metres};
}

std::string_view find_frame_note(std::string_view comment) {
  const auto begin = comment.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  comment.remove_prefix(begin);
  if (!comment.starts_with(kFrameNoteName)) return {};
  comment.remove_prefix(kFrameNoteName.size());
  const auto note = comment.find('{');
  return note == std::string_view::npos ? std::string_view() : comment.substr(note);
}

std::string_view find_frame_member(std::string_view json) {
  const std::string name = '"' + std::string(kFrameNoteName) + "\":{";
  const std::size_t begin = json.find(name);
  if (begin == std::string_view::npos) return {};
  json.remove_prefix(begin + name.size() - 1);
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{') {
      ++depth;
    } else if (c == '}' && --depth == 0) {
      return json.substr(0, i + 1);
    }
  }
  return {};
}

}  // namespace proto::formats
