// Writing JSON: members in the order in which they are written, no spaces, the same bytes for the same data.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace proto {

/// Appends `text` as a JSON string. What is not UTF-8 becomes U+FFFD, so that the result always parses.
void append_json_string(std::string& out, std::string_view text);

/// Appends values to a text and puts the commas. Whoever calls it sees to the nesting.
class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array() { return open('['); }
  JsonWriter& end_array() { return close(']'); }

  JsonWriter& key(std::string_view name);
  JsonWriter& string(std::string_view text);
  JsonWriter& integer(std::uint64_t value);
  /// Shortest round trip; a number that is not finite, which JSON cannot say, becomes null.
  JsonWriter& number(double value);
  JsonWriter& boolean(bool value) { return raw(value ? "true" : "false"); }
  JsonWriter& null() { return raw("null"); }
  /// `json` must be a JSON value.
  JsonWriter& raw(std::string_view json);

  std::string take() { return std::move(out_); }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  void separate();

  std::string out_;
  bool comma_ = false;  // whether a value or a closing bracket stands last
};

}  // namespace proto
