#include "proto/datetime.h"

#include <charconv>
#include <chrono>

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

namespace {

constexpr std::int64_t kSecond = 1000, kMinute = 60 * kSecond, kHour = 60 * kMinute, kDay = 24 * kHour;

/// Takes digits and separators off the front.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  /// Exactly so many digits; -1 when there are others.
  int digits(std::size_t count) {
    int value = 0;
    if (text_.size() < count) return -1;
    const auto read = std::from_chars(text_.data(), text_.data() + count, value);
    if (read.ptr != text_.data() + count || text_.front() == '-') return -1;
    text_.remove_prefix(count);
    return value;
  }
  bool take(std::string_view any) {
    if (text_.empty() || any.find(text_.front()) == std::string_view::npos) return false;
    text_.remove_prefix(1);
    return true;
  }
  /// Milliseconds of ".123456", if that comes; -1: a point without digits.
  int fraction_ms() {
    if (!take(".")) return 0;
    int value = 0, scale = 100;
    bool any = false;
    while (!text_.empty() && text_.front() >= '0' && text_.front() <= '9') {
      value += (text_.front() - '0') * scale;
      scale /= 10;
      any = true;
      text_.remove_prefix(1);
    }
    return any ? value : -1;
  }
  std::string_view rest() const { return text_; }

 private:
  std::string_view text_;
};

struct Moment {
  std::int64_t first_ms = 0, last_ms = 0;
};

bool between(int value, int low, int high) {
  return low <= value && value <= high;
}

std::optional<std::int64_t> offset_ms(Reader& reader) {
  if (reader.take("Zz")) return 0;
  const bool behind = reader.rest().starts_with('-');
  if (!reader.take("+-")) return std::nullopt;
  const int hours = reader.digits(2);
  if (!reader.take(":")) return std::nullopt;
  const int minutes = reader.digits(2);
  if (!between(hours, 0, 23) || !between(minutes, 0, 59)) return std::nullopt;
  const std::int64_t ahead = hours * kHour + minutes * kMinute;
  return behind ? -ahead : ahead;
}

std::optional<Moment> moment(std::string_view text) {
  Reader reader(text);
  const int year = reader.digits(4);
  if (!reader.take("-")) return std::nullopt;
  const int month = reader.digits(2);
  if (!reader.take("-")) return std::nullopt;
  const int day = reader.digits(2);
  if (year < 0 || month < 0 || day < 0) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  const std::int64_t midnight = std::chrono::sys_days(date).time_since_epoch().count() * kDay;
  if (reader.rest().empty()) return Moment{midnight, midnight + kDay - 1};
  if (!reader.take("Tt ")) return std::nullopt;
  const int hour = reader.digits(2);
  if (!reader.take(":")) return std::nullopt;
  const int minute = reader.digits(2);
  const bool whole_minute = !reader.take(":");
  const int second = whole_minute ? 0 : reader.digits(2);  // 60 in a leap second
  const bool exact = reader.rest().starts_with('.');
  const int fraction = reader.fraction_ms();
  const auto offset = offset_ms(reader);
  if (!between(hour, 0, 23) || !between(minute, 0, 59) || !between(second, 0, 60) || fraction < 0 ||
      !offset || !reader.rest().empty()) {
    return std::nullopt;
  }
  const std::int64_t at = midnight + hour * kHour + minute * kMinute + second * kSecond + fraction - *offset;
  if (whole_minute) return exact ? std::nullopt : std::optional(Moment{at, at + kMinute - 1});
  return Moment{at, exact ? at : at + kSecond - 1};
}

}  // namespace

Result<TimeSpan> parse_datetime(std::string_view text, const std::string& where) {
  const auto wrong = [&where] {
    return error(Code::kMalformed,
                 "A datetime is a moment or an interval of RFC 3339, like 2026-01-01T00:00:00Z/..", where);
  };
  const auto slash = text.find('/');
  if (slash == std::string_view::npos) {
    const auto only = moment(text);
    if (!only) return wrong();
    return TimeSpan{only->first_ms, only->last_ms};
  }
  const auto open = [](std::string_view end) { return end.empty() || end == ".."; };
  const std::string_view first = text.substr(0, slash), last = text.substr(slash + 1);
  TimeSpan span;
  if (!open(first)) {
    const auto from = moment(first);
    if (!from) return wrong();
    span.from_ms = from->first_ms;
  }
  if (!open(last)) {
    const auto until = moment(last);
    if (!until) return wrong();
    span.until_ms = until->last_ms;
  }
  if (span.from_ms && span.until_ms && *span.from_ms > *span.until_ms) return wrong();
  return span;
}

}  // namespace proto
