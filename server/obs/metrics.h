// Numbers for a monitoring system: what is counted while requests are served, and the text in which
// Prometheus reads it (https://prometheus.io/docs/instrumenting/exposition_formats/). Debian's client library
// would bring a web server and curl along.
//
//   metrics.http.record("GET", "/tins/{tin}", 200, 0.004, 512);
//   MetricsText text;
//   text.family("tinsmith_tins", "gauge", "TINs that are served").sample("", 3);
//   metrics.http.write(text);
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <utility>

namespace server::obs {

/// The text of a scrape.
class MetricsText {
 public:
  /// Begins a family: `type` is counter, gauge or histogram.
  MetricsText& family(std::string_view name, std::string_view type, std::string_view help);
  /// A sample of the present family; `labels` as label() makes them, joined by commas.
  MetricsText& sample(std::string_view labels, double value) { return sample("", labels, value); }
  MetricsText& sample(std::string_view suffix, std::string_view labels, double value);
  /// `name="value"`, escaped.
  static std::string label(std::string_view name, std::string_view value);

  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::string name_;
};

/// How long something took, in buckets from 0.5 ms to 60 s. Thread-safe.
class Histogram {
 public:
  static constexpr std::array<double, 14> kBounds = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                                     0.1,    0.25,  1,      2.5,   10,   30,    60};

  void observe(double seconds);
  /// The samples _bucket, _sum and _count.
  void write(MetricsText& text, const std::string& labels) const;

 private:
  std::array<std::atomic<std::uint64_t>, kBounds.size() + 1> counts_{};
  std::atomic<std::uint64_t> sum_us_{0};
};

/// The requests, by route and by class of status. Thread-safe; a route seen before costs no exclusive lock.
class HttpMetrics {
 public:
  void record(std::string_view method, std::string_view route, int status, double seconds,
              std::uint64_t bytes);
  void write(MetricsText& text) const;

 private:
  struct OfRoute {
    std::array<std::atomic<std::uint64_t>, 6> by_class{};  // by the first digit of the status
    Histogram seconds;
  };
  OfRoute& of(const std::string& key);

  mutable std::shared_mutex mutex_;
  std::map<std::string, std::unique_ptr<OfRoute>> routes_;  // by "METHOD route"
  std::atomic<std::uint64_t> bytes_{0};
};

/// All that is counted as it happens; other numbers are asked for when somebody scrapes.
struct Metrics {
  HttpMetrics http;
  std::atomic<std::uint64_t> edits{0};      // single operations that were acknowledged
  std::atomic<std::uint64_t> revisions{0};  // that were acknowledged
};

/// Those of this process.
Metrics& metrics();

/// Bytes of memory that the process has in RAM; 0 where that cannot be learnt.
std::uint64_t resident_bytes();

}  // namespace server::obs
