// The log: one JSON object per line on stderr, for people with grep and for collectors alike.
//
//   log_info("tin_created", {{"tin", id}, {"vertices", count}});
//   {"time":"2024-05-01T12:00:00.000Z","level":"info","event":"tin_created","tin":"alps","vertices":7}
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace server::obs {

enum class LogLevel { kDebug, kInfo, kWarning, kError, kOff };

/// The level that people call debug, info, warning, error or off; nothing for any other name.
std::optional<LogLevel> log_level_named(std::string_view name);

/// A name and a value; both are borrowed for the call.
struct Field {
  using Value = std::variant<std::string_view, std::int64_t, std::uint64_t, double, bool>;

  Field(std::string_view k, std::string_view v) : key(k), value(v) {}
  Field(std::string_view k, const char* v) : key(k), value(std::string_view(v)) {}
  Field(std::string_view k, const std::string& v) : key(k), value(std::string_view(v)) {}
  Field(std::string_view k, bool v) : key(k), value(v) {}
  Field(std::string_view k, std::floating_point auto v) : key(k), value(static_cast<double>(v)) {}
  Field(std::string_view k, std::signed_integral auto v) : key(k), value(static_cast<std::int64_t>(v)) {}
  Field(std::string_view k, std::unsigned_integral auto v) : key(k), value(static_cast<std::uint64_t>(v)) {}

  std::string_view key;
  Value value;
};

using Fields = std::initializer_list<Field>;

/// Lines below `level` are not written; kInfo at first. Thread-safe, as all of these.
void set_log_level(LogLevel level);

void log_debug(std::string_view event, Fields fields = {});
void log_info(std::string_view event, Fields fields = {});
void log_warning(std::string_view event, Fields fields = {});
void log_error(std::string_view event, Fields fields = {});

/// The members of a line's object, without braces and time: `"event":"x","key":1`. Whatever the bytes of
/// event, keys and values, the result is JSON on one line: bytes that are not UTF-8 become U+FFFD, numbers
/// that JSON does not have become null.
std::string log_members(std::string_view event, Fields fields);

/// A key and a text as a member of a JSON object: `"key":"text"`.
std::string log_pair(std::string_view key, std::string_view text);

}  // namespace server::obs
