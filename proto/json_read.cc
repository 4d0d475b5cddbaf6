#include "proto/json_read.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "proto/utf8.h"

namespace proto {

using tin::base::Code;
using tin::base::Error;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::size_t kShownName = 64;                 // bytes of a member's name that errors repeat
constexpr std::size_t kFewMembers = 8;                 // up to so many, names are compared pair by pair
constexpr double kExactIntegers = 9007199254740992.0;  // 2^53

std::string escape_pointer(std::string_view name) {
  std::string escaped;
  for (const char c : name) {
    if (c == '~') {
      escaped += "~0";
    } else if (c == '/') {
      escaped += "~1";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

/// Receives the parser's events, and stops it at what we do not take.
class DocumentBuilder {
 public:
  explicit DocumentBuilder(std::size_t text_size) : text_size_(text_size) {}

  using Kind = Document::Kind;
  using Content = Document::Content;

  bool null() { return add(Kind::kNull, {}); }
  bool boolean(bool value) { return add(value ? Kind::kTrue : Kind::kFalse, {}); }
  bool number_integer(std::int64_t value) {
    Content content;
    content.signed_integer = value;
    return add(Kind::kSigned, content);
  }
  bool number_unsigned(std::uint64_t value) {
    Content content;
    content.unsigned_integer = value;
    return add(Kind::kUnsigned, content);
  }
  bool number_float(double value, const std::string&) {
    Content content;
    content.real = value;
    return add(Kind::kDouble, content);
  }
  bool string(const std::string& value) {
    Content content;
    content.string = keep(value);
    return add(Kind::kString, content);
  }
  bool binary(const std::vector<std::uint8_t>&) { return false; }  // JSON text has none
  bool key(const std::string& name) {
    name_ = keep(name);
    return true;
  }
  bool start_object(std::size_t) { return open(Kind::kObject); }
  bool start_array(std::size_t) { return open(Kind::kArray); }
  bool end_object() { return close() && names_are_distinct(last_closed_); }
  bool end_array() { return close(); }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& problem) {
    constexpr int kNumberOverflow = 406;
    if (problem.id == kNumberOverflow) {
      add(Kind::kNull, {});
      fail(Code::kNotFinite, "a number is too large for a double",
           static_cast<std::uint32_t>(document_.nodes_.size() - 1));
      error_.message += " (at byte " + std::to_string(position - 1) + ")";
    } else if (position > text_size_) {
      error_ = error(Code::kMalformed,
                     "not valid JSON: the text ends too early, at byte " + std::to_string(text_size_));
    } else {
      error_ = error(Code::kMalformed, "not valid JSON at byte " + std::to_string(position - 1));
    }
    return false;
  }

  Document take_document() { return std::move(document_); }
  Error take_error() { return std::move(error_); }

 private:
  Document::Slice keep(const std::string& text) {
    const Document::Slice slice{static_cast<std::uint32_t>(document_.strings_.size()),
                                static_cast<std::uint32_t>(text.size())};
    document_.strings_ += text;
    return slice;
  }

  std::uint32_t next_index() const { return static_cast<std::uint32_t>(document_.nodes_.size()); }

  bool add(Kind kind, Content content) {
    if (!open_.empty()) ++document_.nodes_[open_.back()].content.count;
    document_.nodes_.push_back({kind, next_index() + 1, name_, content});
    name_ = {};
    return true;
  }

  bool open(Kind kind) {
    if (open_.size() == kMaxJsonDepth) {
      error_ = error(Code::kMalformed, "nested deeper than " + std::to_string(kMaxJsonDepth) + " levels");
      return false;
    }
    const std::uint32_t index = next_index();
    add(kind, {});
    open_.push_back(index);
    return true;
  }

  bool close() {
    last_closed_ = open_.back();
    document_.nodes_[last_closed_].end = next_index();
    open_.pop_back();
    return true;
  }

  bool names_are_distinct(std::uint32_t object) {
    const auto& nodes = document_.nodes_;
    members_.clear();
    for (std::uint32_t i = object + 1; i < nodes[object].end; i = nodes[i].end) members_.push_back(i);
    if (members_.size() > kFewMembers) {
      std::sort(members_.begin(), members_.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int order = name(a).compare(name(b));
        return order != 0 ? order < 0 : a < b;
      });
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const std::size_t last =
          members_.size() > kFewMembers ? std::min(i + 2, members_.size()) : members_.size();
      for (std::size_t j = i + 1; j < last; ++j) {
        if (name(members_[i]) == name(members_[j]))
          return fail(Code::kMalformed, "the member is there twice", members_[j]);
      }
    }
    return true;
  }

  std::string_view name(std::uint32_t index) const { return document_.text_of(document_.nodes_[index].name); }

  bool fail(Code code, std::string message, std::uint32_t index) {
    for (const std::uint32_t container : open_) document_.nodes_[container].end = next_index();
    error_ = error(code, std::move(message), document_.pointer_to(index));
    return false;
  }

  std::size_t text_size_;
  Document document_;
  Document::Slice name_{};
  std::vector<std::uint32_t> open_;
  std::vector<std::uint32_t> members_;
  std::uint32_t last_closed_ = 0;
  Error error_;
};

namespace {

/// Reads plain JSON, which is what programs send: ASCII without escapes, numbers that fit. Several times as
/// fast as the parser that reads all JSON and says what is wrong with it; whatever is not plain is left to
/// that one.
class PlainParser {
 public:
  PlainParser(std::string_view text, DocumentBuilder& builder)
      : at_(text.data()), end_(text.data() + text.size()), builder_(builder) {}

  /// False when the text is not plain, wrong, or not taken by the builder: the other parser will tell.
  bool run() {
    if (!value()) return false;
    while (!open_.empty()) {
      if (!(open_.back() == '[' ? next_item() : next_member())) return false;
    }
    skip_space();
    return at_ == end_;
  }

 private:
  void skip_space() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
  }
  bool take(char c) {
    skip_space();
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  bool take_word(std::string_view word) {
    if (!std::string_view(at_, end_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }

  bool value() {
    skip_space();
    if (at_ == end_) return false;
    switch (*at_) {
      case '[':
      case '{':
        return begin(*at_++);
      case '"':
        return string() && builder_.string(text_);
      case 't':
        return take_word("true") && builder_.boolean(true);
      case 'f':
        return take_word("false") && builder_.boolean(false);
      case 'n':
        return take_word("null") && builder_.null();
      default:
        return number();
    }
  }

  bool begin(char bracket) {
    if (!(bracket == '[' ? builder_.start_array(0) : builder_.start_object(0))) return false;
    open_ += bracket;
    fresh_ = true;
    return true;
  }
  bool end() {
    const bool array = open_.back() == '[';
    open_.pop_back();
    fresh_ = false;
    return array ? builder_.end_array() : builder_.end_object();
  }

  /// The end of the innermost array, or its next item.
  bool next_item() {
    if (take(']')) return end();
    if (!std::exchange(fresh_, false) && !take(',')) return false;
    return value();
  }
  bool next_member() {
    if (take('}')) return end();
    if (!std::exchange(fresh_, false) && !take(',')) return false;
    skip_space();
    return at_ != end_ && *at_ == '"' && string() && builder_.key(text_) && take(':') && value();
  }

  bool string() {
    const char* const begin = ++at_;
    while (at_ != end_ && *at_ >= ' ' && *at_ < 0x7f && *at_ != '"' && *at_ != '\\') ++at_;
    if (at_ == end_ || *at_ != '"') return false;
    text_.assign(begin, at_++);
    return true;
  }

  bool digits() {
    const char* const begin = at_;
    while (at_ != end_ && *at_ >= '0' && *at_ <= '9') ++at_;
    return at_ != begin;
  }
  bool number() {
    constexpr std::ptrdiff_t kFit = 18;  // characters of an integer that fits 64 bits in any case
    const char* const begin = at_;
    const bool negative = *at_ == '-';
    if (negative) ++at_;
    const char* const whole = at_;
    if (!digits() || (*whole == '0' && at_ - whole > 1)) return false;
    bool integer = true;
    if (at_ != end_ && *at_ == '.') {
      integer = false;
      ++at_;
      if (!digits()) return false;
    }
    if (at_ != end_ && (*at_ == 'e' || *at_ == 'E')) {
      integer = false;
      ++at_;
      if (at_ != end_ && (*at_ == '+' || *at_ == '-')) ++at_;
      if (!digits()) return false;
    }
    if (!integer) {
      double real = 0;
      const auto [stop, failure] = std::from_chars(begin, at_, real);
      return failure == std::errc() && stop == at_ && builder_.number_float(real, {});
    }
    if (at_ - begin > kFit) return false;
    std::int64_t count = 0;
    std::from_chars(begin, at_, count);
    return negative ? builder_.number_integer(count)
                    : builder_.number_unsigned(static_cast<std::uint64_t>(count));
  }

  const char* at_;
  const char* const end_;
  DocumentBuilder& builder_;
  std::string open_;    // brackets
  bool fresh_ = false;  // the innermost one was opened just now
  std::string text_;
};

}  // namespace

Result<Document> Document::parse(std::string_view text) {
  if (text.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
    return error(Code::kTooLarge, "a JSON text may have at most 2 GiB");
  }
  // The parser takes a NUL for the end of the text and would overlook what follows it.
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos) {
    return error(Code::kMalformed, "not valid JSON at byte " + std::to_string(nul));
  }
  if (DocumentBuilder plain(text.size()); PlainParser(text, plain).run()) return plain.take_document();
  DocumentBuilder builder(text.size());
  if (!nlohmann::json::sax_parse(text.data(), text.data() + text.size(), &builder))
    return builder.take_error();
  return builder.take_document();
}

Value Document::root() const {
  return Value(this, 0);
}

std::string Document::pointer_to(std::uint32_t index) const {
  std::string path;
  std::uint32_t at = 0;
  while (at != index) {
    const bool in_array = nodes_[at].kind == Kind::kArray;
    std::uint32_t child = at + 1;
    std::uint64_t position = 0;
    for (; nodes_[child].end <= index; child = nodes_[child].end) ++position;
    path += '/';
    path += in_array ? std::to_string(position)
                     : escape_pointer(utf8_prefix(text_of(nodes_[child].name), kShownName));
    at = child;
  }
  return path;
}

Value Array::Iterator::operator*() const {
  return Value(document_, index_);
}

Array::Iterator& Array::Iterator::operator++() {
  index_ = document_->nodes_[index_].end;
  return *this;
}

std::optional<Value> Object::find(std::string_view name) const {
  const auto& nodes = document_->nodes_;
  for (std::uint32_t i = index_ + 1; i < nodes[index_].end; i = nodes[i].end) {
    if (document_->text_of(nodes[i].name) == name) return Value(document_, i);
  }
  return std::nullopt;
}

Result<Value> Object::require(std::string_view name) const {
  if (const auto value = find(name)) return *value;
  return error(Code::kMalformed, "the member \"" + std::string(name) + "\" is missing",
               document_->pointer_to(index_));
}

Error Value::error(Code code, std::string message) const {
  return tin::base::error(code, std::move(message), pointer());
}

Error Value::not_a(std::string_view wanted) const {
  static constexpr std::string_view kNames[] = {"null",     "false",    "true",     "a number", "a number",
                                                "a number", "a string", "an array", "an object"};
  return error(Code::kMalformed, "here must be " + std::string(wanted) + ", not " +
                                     std::string(kNames[static_cast<std::size_t>(node().kind)]));
}

Result<bool> Value::boolean() const {
  if (node().kind == Document::Kind::kTrue) return true;
  if (node().kind == Document::Kind::kFalse) return false;
  return not_a("true or false");
}

Result<double> Value::number() const {
  switch (node().kind) {
    case Document::Kind::kSigned:
      return static_cast<double>(node().content.signed_integer);
    case Document::Kind::kUnsigned:
      return static_cast<double>(node().content.unsigned_integer);
    case Document::Kind::kDouble:
      return node().content.real;
    default:
      return not_a("a number");
  }
}

Result<std::int64_t> Value::integer(std::int64_t min, std::int64_t max) const {
  std::optional<std::int64_t> value;  // nothing: beyond what anyone asks for
  if (node().kind == Document::Kind::kSigned) {
    value = node().content.signed_integer;
  } else if (node().kind == Document::Kind::kUnsigned) {
    const std::uint64_t whole = node().content.unsigned_integer;
    if (whole <= static_cast<std::uint64_t>(max)) value = static_cast<std::int64_t>(whole);
  } else if (node().kind == Document::Kind::kDouble) {
    const double real = node().content.real;
    if (real != std::trunc(real)) return error(Code::kMalformed, "here must be a whole number");
    // From 2^53 on a double no longer tells which integer was written.
    if (std::fabs(real) < kExactIntegers) value = static_cast<std::int64_t>(real);
  } else {
    return not_a("a whole number");
  }
  if (value && *value >= min && *value <= max) return *value;
  return error(Code::kInvalidValue,
               "the number must lie between " + std::to_string(min) + " and " + std::to_string(max));
}

Result<std::string_view> Value::string(std::size_t max_bytes) const {
  if (node().kind != Document::Kind::kString) return not_a("a string");
  const std::string_view text = document_->text_of(node().content.string);
  if (text.size() > max_bytes) {
    return error(Code::kTooLarge, "the text may have at most " + std::to_string(max_bytes) + " bytes");
  }
  return text;
}

Result<Array> Value::array(std::size_t max_items) const {
  if (node().kind != Document::Kind::kArray) return not_a("an array");
  if (node().content.count > max_items) {
    return error(Code::kTooLarge, "the array has " + std::to_string(node().content.count) +
                                      " items; at most " + std::to_string(max_items) + " are taken at once");
  }
  return Array(document_, index_);
}

Result<Object> Value::object(std::initializer_list<std::string_view> allowed) const {
  if (node().kind != Document::Kind::kObject) return not_a("an object");
  for (std::uint32_t i = index_ + 1; i < node().end; i = document_->nodes_[i].end) {
    const std::string_view name = document_->text_of(document_->nodes_[i].name);
    if (std::find(allowed.begin(), allowed.end(), name) != allowed.end()) continue;
    std::string names;
    for (const std::string_view one : allowed) names += (names.empty() ? "" : ", ") + std::string(one);
    return tin::base::error(
        Code::kMalformed,
        "there is no member \"" + utf8_prefix(name, kShownName) + "\" here; known are: " + names,
        document_->pointer_to(i));
  }
  return Object(document_, index_);
}

Result<Object> Value::any_object() const {
  if (node().kind != Document::Kind::kObject) return not_a("an object");
  return Object(document_, index_);
}

}  // namespace proto
