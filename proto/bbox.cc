#include "proto/bbox.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

Result<std::uint64_t> parse_count(std::string_view text, std::uint64_t min, std::uint64_t max,
                                  std::string where) {
  std::uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec == std::errc::invalid_argument || read.ptr != text.data() + text.size()) {
    return error(Code::kMalformed, "here must be a whole number without a sign", std::move(where));
  }
  if (read.ec != std::errc{} || value < min || value > max) {
    return error(Code::kInvalidValue,
                 "the number must lie between " + std::to_string(min) + " and " + std::to_string(max),
                 std::move(where));
  }
  return value;
}

Result<double> parse_number(std::string_view text, std::string where) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec == std::errc::invalid_argument || read.ptr != text.data() + text.size()) {
    return error(Code::kMalformed, "here must be a number", std::move(where));
  }
  // Out of range is said of numbers too large and of those too small for a double; both are refused.
  if (read.ec != std::errc{} || !std::isfinite(value)) {
    return error(Code::kNotFinite, "the number must be finite and fit a double", std::move(where));
  }
  return value;
}

namespace {

Result<std::vector<double>> parse_list(std::string_view text, const std::string& where) {
  std::vector<double> numbers;
  while (numbers.size() <= 6) {
    const std::size_t comma = text.find(',');
    auto number = parse_number(text.substr(0, comma), where);
    if (!number) return std::move(number).error();
    numbers.push_back(*number);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  return numbers;
}

Result<Bbox> parse_any_box(std::string_view text, const std::string& where) {
  auto list = parse_list(text, where);
  if (!list) return std::move(list).error();
  const std::vector<double>& n = *list;
  if (n.size() == 4) return Bbox{n[0], n[1], n[2], n[3], std::nullopt, std::nullopt};
  if (n.size() == 6) return Bbox{n[0], n[1], n[3], n[4], n[2], n[5]};
  return error(Code::kMalformed, "a box is minx,miny,maxx,maxy (or six numbers with z)", where);
}

Result<void> check_order(const Bbox& box, const std::string& where) {
  if (box.min_x <= box.max_x && box.min_y <= box.max_y && (!box.min_z || *box.min_z <= *box.max_z)) return {};
  return error(Code::kInvalidValue, "a minimum of the box lies above its maximum", where);
}

}  // namespace

Result<Bbox> parse_bbox(std::string_view text, std::string where) {
  const auto box = parse_any_box(text, where);
  if (!box) return box;
  if (auto fine = check_order(*box, where); !fine) return fine.error();
  return box;
}

Result<std::vector<Bbox>> parse_lon_lat_bbox(std::string_view text, std::string where) {
  const auto box = parse_any_box(text, where);
  if (!box) return box.error();
  std::vector<Bbox> boxes{*box};
  if (box->min_x > box->max_x && box->min_x <= 180 && box->max_x >= -180) {
    boxes = {*box, *box};
    boxes[0].max_x = 180;
    boxes[1].min_x = -180;
  }
  for (const Bbox& part : boxes) {
    if (auto fine = check_order(part, where); !fine) return fine.error();
  }
  return boxes;
}

}  // namespace proto
