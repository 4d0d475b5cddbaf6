#include "server/obs/metrics.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <mutex>

namespace server::obs {
namespace {

std::string number_text(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return std::string(digits.data(), end);
}

}  // namespace

MetricsText& MetricsText::family(std::string_view name, std::string_view type, std::string_view help) {
  name_ = name;
  text_.append("# HELP ").append(name).append(" ").append(help).append("\n");
  text_.append("# TYPE ").append(name).append(" ").append(type).append("\n");
  return *this;
}

MetricsText& MetricsText::sample(std::string_view suffix, std::string_view labels, double value) {
  text_.append(name_).append(suffix);
  if (!labels.empty()) text_.append("{").append(labels).append("}");
  text_.append(" ").append(number_text(value)).append("\n");
  return *this;
}

std::string MetricsText::label(std::string_view name, std::string_view value) {
  std::string out = std::string(name) + "=\"";
  for (const char c : value) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + '"';
}

void Histogram::observe(double seconds) {
  const auto bucket = std::lower_bound(kBounds.begin(), kBounds.end(), seconds) - kBounds.begin();
  counts_[static_cast<std::size_t>(bucket)].fetch_add(1, std::memory_order_relaxed);
  const double us = std::clamp(seconds * 1e6, 0.0, 1e15);
  sum_us_.fetch_add(static_cast<std::uint64_t>(us), std::memory_order_relaxed);
}

void Histogram::write(MetricsText& text, const std::string& labels) const {
  const std::string before = labels.empty() ? "" : labels + ",";
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    total += counts_[i].load(std::memory_order_relaxed);
    const std::string bound = i < kBounds.size() ? number_text(kBounds[i]) : "+Inf";
    text.sample("_bucket", before + MetricsText::label("le", bound), static_cast<double>(total));
  }
  text.sample("_sum", labels, 1e-6 * static_cast<double>(sum_us_.load(std::memory_order_relaxed)));
  text.sample("_count", labels, static_cast<double>(total));
}

HttpMetrics::OfRoute& HttpMetrics::of(const std::string& key) {
  {
    const std::shared_lock lock(mutex_);
    if (const auto found = routes_.find(key); found != routes_.end()) return *found->second;
  }
  const std::lock_guard lock(mutex_);
  auto& made = routes_[key];
  if (!made) made = std::make_unique<OfRoute>();
  return *made;
}

void HttpMetrics::record(std::string_view method, std::string_view route, int status, double seconds,
                         std::uint64_t bytes) {
  OfRoute& metrics = of(std::string(method) + " " + std::string(route));
  const auto digit = static_cast<std::size_t>(std::clamp(status / 100, 0, 5));
  metrics.by_class[digit].fetch_add(1, std::memory_order_relaxed);
  metrics.seconds.observe(seconds);
  bytes_.fetch_add(bytes, std::memory_order_relaxed);
}

void HttpMetrics::write(MetricsText& text) const {
  const std::shared_lock lock(mutex_);
  const auto labels = [](const std::string& key) {
    const std::size_t space = key.find(' ');
    return MetricsText::label("method", key.substr(0, space)) + "," +
           MetricsText::label("route", key.substr(space + 1));
  };
  text.family("tinsmith_http_requests_total", "counter", "Requests answered, by route and class of status");
  for (const auto& [key, route] : routes_) {
    for (std::size_t digit = 1; digit < route->by_class.size(); ++digit) {
      const std::uint64_t count = route->by_class[digit].load(std::memory_order_relaxed);
      if (count == 0) continue;
      text.sample(labels(key) + "," + MetricsText::label("status", std::to_string(digit) + "xx"),
                  static_cast<double>(count));
    }
  }
  text.family("tinsmith_http_request_seconds", "histogram",
              "From the head of a request to the end of its answer");
  for (const auto& [key, route] : routes_) route->seconds.write(text, labels(key));
  text.family("tinsmith_http_sent_bytes_total", "counter", "Bytes of answers, heads included")
      .sample("", static_cast<double>(bytes_.load(std::memory_order_relaxed)));
}

Metrics& metrics() {
  static Metrics of_this_process;
  return of_this_process;
}

std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  if (!(statm >> total >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace server::obs
