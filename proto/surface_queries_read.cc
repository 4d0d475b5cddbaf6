#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/crs_uri.h"
#include "proto/surface_queries.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kMaxWord = 256;

/// Reads members one after another; after the first error the rest is skipped and the error stays.
class Reader {
 public:
  explicit Reader(const Object& object) : object_(object) {}

  void number(std::string_view name, double& value) {
    with(name, [&](Value member) { take(member.number(), value); });
  }
  void required_number(std::string_view name, double& value) {
    if (require(name)) number(name, value);
  }
  void boolean(std::string_view name, bool& value) {
    with(name, [&](Value member) { take(member.boolean(), value); });
  }
  void position(std::string_view name, Position2& value) {
    if (require(name)) with(name, [&](Value member) { read_position(member, value); });
  }
  void positions(std::string_view name, std::vector<Position2>& out, std::size_t most) {
    if (require(name)) with(name, [&](Value member) { read_positions(member, out, most); });
  }
  void numbers(std::string_view name, std::vector<double>& out, std::size_t most) {
    with(name, [&](Value member) {
      const auto array = member.array(most);
      if (!array) return fail(array.error());
      for (const Value item : *array) {
        out.emplace_back();
        if (!take(item.number(), out.back())) return;
      }
    });
  }
  /// One ring, or several.
  void polygon(std::string_view name, std::vector<Ring2>& out, std::size_t most) {
    with(name, [&](Value member) {
      const auto array = member.array(most);
      if (!array) return fail(array.error());
      const bool rings = is_array_of_arrays_of_arrays(*array);
      if (!rings) return read_positions(member, out.emplace_back(), most);
      std::size_t left = most;
      for (const Value ring : *array) {
        read_positions(ring, out.emplace_back(), left);
        if (!fine()) return;
        left -= out.back().size();
      }
    });
  }
  void box(std::string_view name, std::optional<Bbox>& out) {
    with(name, [&](Value member) {
      const auto array = member.array(std::numeric_limits<std::size_t>::max());
      if (!array) return fail(array.error());
      if (array->size() != 4)
        return fail(member.error(Code::kMalformed, "here must be 4 numbers: minx, miny, maxx, maxy"));
      std::array<double, 4> v{};
      std::size_t i = 0;
      for (const Value item : *array) {
        if (!take(item.number(), v[i++])) return;
      }
      if (v[0] > v[2] || v[1] > v[3])
        return fail(member.error(Code::kInvalidValue, "a minimum is above its maximum"));
      out = Bbox{v[0], v[1], v[2], v[3], std::nullopt, std::nullopt};
    });
  }
  void manner(Manner& out) {
    with("crs", [&](Value member) {
      std::string_view text;
      if (!take(member.string(kMaxWord), text)) return;
      std::string name;
      if (take(parse_crs(text, member.pointer()), name)) out.crs = std::move(name);
    });
    with("voids", [&](Value member) {
      std::string_view text;
      if (take(member.string(kMaxWord), text)) take(parse_voids(text, member.pointer()), out.voids);
    });
  }
  void area(AreaOfInterest& out, std::size_t most) {
    polygon("polygon", out.polygon, most);
    box("bbox", out.box);
    if (!out.polygon.empty() && out.box) {
      with("bbox", [&](Value member) {
        fail(member.error(Code::kInvalidValue, "either a polygon or a bbox, not both"));
      });
    }
  }
  std::optional<Value> find(std::string_view name) const { return object_.find(name); }

  bool fine() const { return !error_; }
  template <class T>
  Result<T> result(T value) {
    if (error_) return *std::move(error_);
    return value;
  }

 private:
  template <class F>
  void with(std::string_view name, const F& f) {
    if (error_) return;
    if (const auto member = object_.find(name)) f(*member);
  }
  bool require(std::string_view name) {
    if (error_) return false;
    if (auto member = object_.require(name); !member) fail(std::move(member).error());
    return !error_;
  }
  template <class R, class T>
  bool take(R result, T& value) {
    if (!result) {
      fail(std::move(result).error());
      return false;
    }
    value = *std::move(result);
    return true;
  }
  void fail(tin::base::Error problem) {
    if (!error_) error_ = std::move(problem);
  }
  void read_position(Value value, Position2& out) {
    const auto array = value.array(std::numeric_limits<std::size_t>::max());
    if (!array) return fail(array.error());
    if (array->size() != 2) {
      return fail(
          value.error(Code::kMalformed, "here must be 2 numbers, not " + std::to_string(array->size())));
    }
    double* to[] = {&out.x, &out.y};
    std::size_t i = 0;
    for (const Value item : *array) {
      if (!take(item.number(), *to[i++])) return;
    }
  }
  void read_positions(Value value, std::vector<Position2>& out, std::size_t most) {
    const auto array = value.array(most);
    if (!array) return fail(array.error());
    out.reserve(array->size());
    for (const Value item : *array) {
      read_position(item, out.emplace_back());
      if (error_) return;
    }
  }
  static bool is_array_of_arrays_of_arrays(const Array& array) {
    if (array.size() == 0) return false;
    const Value first = *array.begin();
    if (!first.is_array()) return false;
    const auto inner = first.array(std::numeric_limits<std::size_t>::max());
    return inner && inner->size() > 0 && (*inner->begin()).is_array();
  }

  const Object& object_;
  std::optional<tin::base::Error> error_;
};

}  // namespace

Result<std::vector<Position2>> parse_positions(std::string_view text, std::size_t max_positions,
                                               std::string where) {
  std::vector<Position2> out;
  std::vector<double> pair;
  while (true) {
    const auto comma = std::min(text.find(','), text.size());
    const auto number = parse_number(text.substr(0, comma), where);
    if (!number) return number.error();
    pair.push_back(*number);
    if (pair.size() == 2) {
      if (out.size() == max_positions) {
        return error(Code::kTooLarge, "There may be " + std::to_string(max_positions) + " positions at most.",
                     std::move(where));
      }
      out.push_back({pair[0], pair[1]});
      pair.clear();
    }
    if (comma == text.size()) break;
    text.remove_prefix(comma + 1);
  }
  if (!pair.empty())
    return error(Code::kMalformed, "Positions are pairs of numbers: x,y,x,y,...", std::move(where));
  return out;
}

Result<PositionsInputs> read_positions_inputs(const Object& object, std::size_t max_positions) {
  Reader reader(object);
  PositionsInputs inputs;
  reader.positions("positions", inputs.positions, max_positions);
  reader.manner(inputs.manner);
  return reader.result(std::move(inputs));
}

Result<SightInputs> read_sight_inputs(const Object& object) {
  Reader reader(object);
  SightInputs inputs;
  reader.position("observer", inputs.observer);
  reader.position("target", inputs.target);
  reader.number("observerHeight", inputs.observer_height);
  reader.number("targetHeight", inputs.target_height);
  reader.boolean("curvature", inputs.curvature);
  reader.number("refraction", inputs.refraction);
  reader.manner(inputs.manner);
  return reader.result(std::move(inputs));
}

Result<void> check_sight_inputs(const SightInputs& inputs, const std::string& where) {
  if (inputs.refraction >= 0 && inputs.refraction < 1) return {};
  return error(Code::kInvalidValue, "The refraction is at least 0 and less than 1.", where + "refraction");
}

Result<ContourInputs> read_contour_inputs(const Object& object, std::size_t max_levels) {
  Reader reader(object);
  ContourInputs inputs;
  if (reader.find("interval")) {
    inputs.interval = 0;
    reader.number("interval", *inputs.interval);
  }
  reader.number("base", inputs.base);
  reader.numbers("levels", inputs.levels, max_levels);
  reader.box("bbox", inputs.box);
  reader.manner(inputs.manner);
  return reader.result(std::move(inputs));
}

Result<void> check_contour_inputs(const ContourInputs& inputs, std::size_t max_levels,
                                  const std::string& where) {
  if (inputs.levels.size() > max_levels) {
    return error(Code::kTooLarge, "There may be " + std::to_string(max_levels) + " levels at most.",
                 where + "levels");
  }
  if (inputs.interval.has_value() == !inputs.levels.empty()) {
    return error(Code::kInvalidValue, "Contours need either an interval or levels.", where + "interval");
  }
  if (inputs.interval && !(*inputs.interval > 0)) {
    return error(Code::kInvalidValue, "The interval must be greater than 0.", where + "interval");
  }
  for (std::size_t i = 1; i < inputs.levels.size(); ++i) {
    if (inputs.levels[i] > inputs.levels[i - 1]) continue;
    return error(Code::kInvalidValue, "Levels must ascend.", where + "levels");
  }
  return {};
}

Result<AreaInputs> read_area_inputs(const Object& object, std::size_t max_positions) {
  Reader reader(object);
  AreaInputs inputs;
  reader.area(inputs.area, max_positions);
  reader.manner(inputs.manner);
  return reader.result(std::move(inputs));
}

Result<VolumeInputs> read_volume_inputs(const Object& object, std::size_t max_positions) {
  Reader reader(object);
  VolumeInputs inputs;
  reader.required_number("level", inputs.level);
  reader.area(inputs.area, max_positions);
  reader.manner(inputs.manner);
  return reader.result(std::move(inputs));
}

}  // namespace proto
