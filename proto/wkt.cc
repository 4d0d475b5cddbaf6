#include "proto/wkt.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "proto/bbox.h"

namespace proto {

using tin::base::Code;
using tin::base::Error;
using tin::base::error;
using tin::base::Result;

namespace {

using Kind = WktGeometry::Kind;
using Sequence = WktGeometry::Sequence;

constexpr std::pair<std::string_view, Kind> kKinds[] = {
    {"POINT", Kind::kPoint},           {"MULTIPOINT", Kind::kMultiPoint},
    {"LINESTRING", Kind::kLineString}, {"MULTILINESTRING", Kind::kMultiLineString},
    {"POLYGON", Kind::kPolygon},       {"MULTIPOLYGON", Kind::kMultiPolygon},
};

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// Reads from left to right; after the first error nothing is read any more.
class Reader {
 public:
  Reader(std::string_view text, std::size_t room, const std::string& where)
      : text_(text), room_(room), where_(where) {}

  Result<WktGeometry> geometry() {
    WktGeometry found;
    found.kind = kind();
    switch (found.kind) {
      case Kind::kPoint:
        found.parts = {{points(1)}};
        break;
      case Kind::kMultiPoint:
        found.parts = {{points(SIZE_MAX)}};
        break;
      case Kind::kLineString:
        found.parts = {{line()}};
        break;
      case Kind::kMultiLineString:
        list([&] { found.parts.push_back({line()}); });
        break;
      case Kind::kPolygon:
        found.parts = {rings()};
        break;
      case Kind::kMultiPolygon:
        list([&] { found.parts.push_back(rings()); });
        break;
    }
    skip_spaces();
    if (!text_.empty()) fail("There is something after the end of the geometry.");
    if (error_) return *error_;
    return found;
  }

 private:
  Kind kind() {
    skip_spaces();
    const auto end = std::find_if_not(text_.begin(), text_.end(), is_letter);
    std::string word(text_.begin(), end);
    for (char& c : word) c = static_cast<char>(c >= 'a' ? c - 'a' + 'A' : c);
    text_.remove_prefix(word.size());
    skip_spaces();
    for (const auto& [name, kind] : kKinds) {
      if (word == name && (text_.empty() || text_.front() == '(')) return kind;
    }
    fail(
        "A geometry is written like POINT(7 46), LINESTRING(7 46,7.1 46.2) or POLYGON((...)), in two "
        "dimensions.");
    return Kind::kPoint;
  }

  /// "(" item "," item ... ")"
  template <class F>
  void list(const F& item) {
    if (!take('(')) return fail("A parenthesis is missing.");
    do {
      item();
    } while (!error_ && take(','));
    if (!error_ && !take(')'))
      fail("Positions are two numbers with a space between them, and commas between positions.");
  }

  Sequence points(std::size_t most) {
    Sequence out;
    list([&] {
      if (out.size() == most) return fail("A POINT has one position.");
      const bool wrapped = most > 1 && take('(');
      out.push_back(position());
      if (wrapped && !take(')')) fail("A parenthesis is missing.");
    });
    return out;
  }

  Sequence line() {
    Sequence out;
    list([&] { out.push_back(position()); });
    if (out.size() < 2) fail("A line has two positions at least.");
    return out;
  }

  std::vector<Sequence> rings() {
    std::vector<Sequence> out;
    list([&] {
      Sequence ring = line();
      if (error_) return;
      if (ring.size() < 4 || ring.front() != ring.back()) {
        return fail("A ring has four positions at least, the last of them equal to the first.");
      }
      out.push_back(std::move(ring));
    });
    return out;
  }

  Position2 position() {
    Position2 at;
    at.x = number();
    at.y = number();
    if (room_ == 0 && !error_)
      error_ = error(Code::kTooLarge, "The geometry has too many positions.", where_);
    if (room_ > 0) --room_;
    return at;
  }

  double number() {
    skip_spaces();
    const auto end = std::find_if(text_.begin(), text_.end(),
                                  [](char c) { return is_space(c) || c == ',' || c == '(' || c == ')'; });
    const std::string_view digits = text_.substr(0, static_cast<std::size_t>(end - text_.begin()));
    text_.remove_prefix(digits.size());
    const auto value = parse_number(digits, where_);
    if (value) return *value;
    if (!error_) error_ = value.error();
    return 0;
  }

  bool take(char c) {
    skip_spaces();
    if (error_ || text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  void skip_spaces() {
    while (!text_.empty() && is_space(text_.front())) text_.remove_prefix(1);
  }
  void fail(std::string why) {
    if (!error_) error_ = error(Code::kMalformed, std::move(why), where_);
  }

  std::string_view text_;
  std::size_t room_;
  const std::string& where_;
  std::optional<Error> error_;
};

}  // namespace

Result<WktGeometry> parse_wkt(std::string_view text, std::size_t max_positions, const std::string& where) {
  return Reader(text, max_positions, where).geometry();
}

}  // namespace proto
