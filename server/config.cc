#include "server/config.h"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

namespace server {
namespace {

using nlohmann::json;
using tin::base::Code;
using tin::base::Error;
using tin::base::Result;

constexpr std::int64_t kMillion = 1'000'000;
constexpr std::int64_t kMiB = std::int64_t{1} << 20;
constexpr std::int64_t kGiB = std::int64_t{1} << 30;

// A number that can be set, and its range.
struct Number {
  std::int64_t* value;
  std::int64_t least;
  std::int64_t most;
};
using Numbers = std::map<std::string, Number>;  // by JSON pointer

// The upper bounds keep sums and products of limits within 64 bits, and masks of rasters within what a
// checkpoint holds.
Numbers numbers_of(LimitConfig& limits) {
  return {{"/limits/body_bytes_memory", {&limits.body_bytes_memory, 1024, 4 * kGiB}},
          {"/limits/upload_bytes", {&limits.upload_bytes, 1024, 1024 * kGiB}},
          {"/limits/unpacked_bytes", {&limits.unpacked_bytes, 1, 1024 * kGiB}},
          {"/limits/raster_pixels", {&limits.raster_pixels, 1, kGiB}},
          {"/limits/export_pixels", {&limits.export_pixels, 1, 16 * kGiB}},
          {"/limits/memory_bytes", {&limits.memory_bytes, 0, 1024 * 1024 * kGiB}},
          {"/limits/raster_memory_bytes", {&limits.raster_memory_bytes, kMiB, 1024 * kGiB}},
          {"/limits/scratch_bytes", {&limits.scratch_bytes, 0, 1024 * kGiB}},
          {"/limits/vertices_per_tin", {&limits.vertices_per_tin, 1, 500 * kMillion}},
          {"/limits/tins", {&limits.tins, 1, kMillion}},
          {"/limits/edits_per_request", {&limits.edits_per_request, 1, 10 * kMillion}},
          {"/limits/areas_per_request", {&limits.areas_per_request, 0, kMillion}},
          {"/limits/positions_per_request", {&limits.positions_per_request, 1, 100 * kMillion}},
          {"/limits/polygon_positions", {&limits.polygon_positions, 3, kMillion}},
          {"/limits/contour_levels", {&limits.contour_levels, 1, kMillion}},
          {"/limits/answer_positions", {&limits.answer_positions, 1, 100 * kMillion}},
          {"/limits/uploads_at_once", {&limits.uploads_at_once, 1, 1000}},
          {"/limits/exports_at_once", {&limits.exports_at_once, 1, 1000}},
          {"/limits/export_seconds", {&limits.export_seconds, 1, kMillion}},
          {"/limits/tile_cache_bytes", {&limits.tile_cache_bytes, 0, std::int64_t{1} << 40}},
          {"/limits/edits_at_once", {&limits.edits_at_once, 1, 10'000}},
          {"/limits/listeners", {&limits.listeners, 1, 100'000}},
          {"/limits/page_size", {&limits.page_size, 1, kMillion}},
          {"/limits/page_size_max", {&limits.page_size_max, 1, kMillion}}};
}

Numbers numbers_of(DecoderConfig& decoder) {
  return {{"/decoder/memory_bytes", {&decoder.memory_bytes, kGiB, 1024 * kGiB}},
          {"/decoder/file_bytes", {&decoder.file_bytes, 0, 1024 * kGiB}},
          {"/decoder/cpu_seconds", {&decoder.cpu_seconds, 1, kMillion}},
          {"/decoder/seconds", {&decoder.seconds, 1, kMillion}}};
}

Numbers numbers_of(JobConfig& jobs) {
  return {{"/jobs/workers", {&jobs.workers, 1, 256}},
          {"/jobs/queued", {&jobs.queued, 1, 100'000}},
          {"/jobs/kept", {&jobs.kept, 1, 100'000}},
          {"/jobs/sync_seconds", {&jobs.sync_seconds, 0, 3600}},
          {"/jobs/sync_waiting", {&jobs.sync_waiting, 1, 1000}},
          {"/jobs/simplify_seconds", {&jobs.simplify_seconds, 1, 86400}}};
}

Numbers numbers_of(HistoryConfig& history) {
  return {{"/history/revisions", {&history.revisions, 0, 1000 * kMillion}},
          {"/history/bytes", {&history.bytes, 0, 1024 * kGiB}},
          {"/history/checkpoint_steps", {&history.checkpoint_steps, 1, 1000 * kMillion}},
          {"/history/key_hours", {&history.key_hours, 1, 24 * 366}},
          {"/history/keys", {&history.keys, 1, 1000 * kMillion}}};
}

Numbers numbers_of(HttpConfig& http) {
  return {{"/http/io_threads", {&http.io_threads, 1, 256}},
          {"/http/worker_threads", {&http.worker_threads, 0, 1024}},
          {"/http/header_bytes", {&http.header_bytes, 1024, kMillion}},
          {"/http/header_fields", {&http.header_fields, 8, 10'000}},
          {"/http/target_bytes", {&http.target_bytes, 256, kMillion}},
          {"/http/header_seconds", {&http.header_seconds, 1, 3600}},
          {"/http/buffered_bytes", {&http.buffered_bytes, 1024, 1024 * kGiB}},
          {"/http/body_bytes_per_second", {&http.body_bytes_per_second, 1, kGiB}},
          {"/http/stall_seconds", {&http.stall_seconds, 1, 3600}},
          {"/http/compress_from_bytes", {&http.compress_from_bytes, 0, kGiB}},
          {"/http/keep_alive_seconds", {&http.keep_alive_seconds, 1, 3600}},
          {"/http/requests_per_connection", {&http.requests_per_connection, 1, 1000 * kMillion}},
          {"/http/connections", {&http.connections, 1, kMillion}},
          {"/http/connections_per_address", {&http.connections_per_address, 1, kMillion}},
          {"/http/drain_notice_seconds", {&http.drain_notice_seconds, 0, 600}},
          {"/http/drain_seconds", {&http.drain_seconds, 0, 3600}}};
}

Error invalid(const std::string& pointer, const std::string& rule) {
  return tin::base::error(Code::kInvalidValue, "must be " + rule, pointer);
}

// An integer within int64; nlohmann's own conversions wrap around or cut off without a word.
std::optional<std::int64_t> integer(const json& value) {
  if (!value.is_number_integer()) return std::nullopt;
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) return std::nullopt;
  return value.get<std::int64_t>();
}

Result<void> set_number(const Number& number, const json& value, const std::string& pointer) {
  const auto given = integer(value);
  if (!given || *given < number.least || *given > number.most) {
    return invalid(pointer,
                   "an integer from " + std::to_string(number.least) + " to " + std::to_string(number.most));
  }
  *number.value = *given;
  return {};
}

// "a/b~c" as a token of a JSON pointer (RFC 6901).
std::string token(const std::string& key) {
  json::json_pointer pointer;
  pointer.push_back(key);
  return pointer.to_string();
}

Result<void> set_section(const Numbers& numbers, const json& section, const std::string& pointer) {
  if (!section.is_object()) return invalid(pointer, "an object");
  for (const auto& [key, value] : section.items()) {
    const std::string place = pointer + token(key);
    const auto known = numbers.find(place);
    if (known == numbers.end())
      return tin::base::error(Code::kUnknownParameter, "there is no such key", place);
    if (auto set = set_number(known->second, value, place); !set.ok()) return set;
  }
  return {};
}

Result<void> set_listen(Config& config, const json& value) {
  auto listen = parse_listen(value.is_string() ? value.get<std::string>() : "");
  if (!listen.ok()) return tin::base::error(Code::kInvalidValue, listen.error().message, "/listen");
  config.listen = *std::move(listen);
  return {};
}

Result<void> set_data_dir(Config& config, const json& value) {
  if (!value.is_string() || value.get<std::string>().empty())
    return invalid("/data_dir", "the path of a folder");
  config.data_dir = value.get<std::string>();
  return {};
}

Result<void> set_public_url(Config& config, const json& value) {
  const std::string url = value.is_string() ? value.get<std::string>() : "?";
  const bool web = url.starts_with("http://") || url.starts_with("https://");
  if (!url.empty() && (!web || url.ends_with('/') || url.find_first_of(" \"<>?#\\") != std::string::npos)) {
    return invalid("/public_url", "\"\" or a URL like \"https://terrain.example.org\", without a slash at the end");
  }
  config.public_url = url;
  return {};
}

Result<void> set_log_level(Config& config, const json& value) {
  for (const char* level : {"debug", "info", "warning", "error", "off"}) {
    if (value != level) continue;
    config.log_level = level;
    return {};
  }
  return invalid("/log_level", "\"debug\", \"info\", \"warning\", \"error\" or \"off\"");
}

Result<void> set_flag(bool& flag, const json& value, const std::string& pointer) {
  if (!value.is_boolean()) return invalid(pointer, "true or false");
  flag = value.get<bool>();
  return {};
}

// {"name": "survey", "hash": "sha256:...", "scopes": ["read", "write"]}
Result<auth::Grant> grant_of(const json& value, const std::string& pointer) {
  if (!value.is_object()) return invalid(pointer, "an object");
  auth::Grant grant;
  grant.read = false;
  for (const auto& [key, member] : value.items()) {
    const std::string place = pointer + token(key);
    if (key == "name") {
      if (!member.is_string() || member.get<std::string>().empty()) return invalid(place, "a name");
      grant.name = member.get<std::string>();
    } else if (key == "hash") {
      grant.hash = member.is_string() ? member.get<std::string>() : "";
      if (!auth::is_hash(grant.hash)) return invalid(place, "a hash as `tinsmith token` prints it");
    } else if (key == "scopes") {
      if (!member.is_array()) return invalid(place, "an array of \"read\" and \"write\"");
      for (const json& scope : member) {
        if (scope != "read" && scope != "write") return invalid(place, "an array of \"read\" and \"write\"");
        (scope == "read" ? grant.read : grant.write) = true;
      }
    } else {
      return tin::base::error(Code::kUnknownParameter, "there is no such key", place);
    }
  }
  if (grant.name.empty() || grant.hash.empty())
    return invalid(pointer, "an object with name, hash and scopes");
  if (!grant.read && !grant.write) return invalid(pointer + "/scopes", "an array of \"read\" and \"write\"");
  return grant;
}

Result<void> set_auth(AuthConfig& config, const json& section) {
  if (!section.is_object()) return invalid("/auth", "an object");
  for (const auto& [key, value] : section.items()) {
    const std::string place = "/auth" + token(key);
    if (key == "anonymous_read" || key == "insecure") {
      auto set = set_flag(key == "insecure" ? config.insecure : config.anonymous_read, value, place);
      if (!set) return set;
    } else if (key == "tokens") {
      if (!value.is_array()) return invalid(place, "an array of tokens");
      for (const json& item : value) {
        auto grant = grant_of(item, place + "/" + std::to_string(config.tokens.size()));
        if (!grant) return grant.error();
        config.tokens.push_back(*std::move(grant));
      }
    } else {
      return tin::base::error(Code::kUnknownParameter, "there is no such key", place);
    }
  }
  return {};
}

Result<void> set_key(Config& config, const std::string& key, const json& value) {
  if (key == "listen") return set_listen(config, value);
  if (key == "data_dir") return set_data_dir(config, value);
  if (key == "public_url") return set_public_url(config, value);
  if (key == "log_level") return set_log_level(config, value);
  if (key == "auth") return set_auth(config.auth, value);
  if (key == "limits") return set_section(numbers_of(config.limits), value, "/limits");
  if (key == "decoder") return set_section(numbers_of(config.decoder), value, "/decoder");
  if (key == "jobs") return set_section(numbers_of(config.jobs), value, "/jobs");
  if (key == "history") return set_section(numbers_of(config.history), value, "/history");
  if (key == "http") return set_section(numbers_of(config.http), value, "/http");
  return tin::base::error(Code::kUnknownParameter, "there is no such key", token(key));
}

Result<Config> config_of(const json& document) {
  if (!document.is_object()) return tin::base::error(Code::kMalformed, "must be a JSON object");
  Config config;
  for (const auto& [key, value] : document.items()) {
    if (auto set = set_key(config, key, value); !set.ok()) return std::move(set).error();
  }
  if (config.limits.page_size > config.limits.page_size_max) {
    return invalid("/limits/page_size",
                   "at most page_size_max, which is " + std::to_string(config.limits.page_size_max));
  }
  if (config.http.buffered_bytes < config.limits.body_bytes_memory) {
    return invalid("/http/buffered_bytes", "at least limits.body_bytes_memory, which is " +
                                               std::to_string(config.limits.body_bytes_memory));
  }
  return config;
}

bool is_address(int family, const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> ignored;
  return inet_pton(family, text.c_str(), ignored.data()) == 1;
}

std::optional<std::uint16_t> port_of(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return port;
}

// The address in what stands before the port; empty if it is none.
std::string address_of(std::string_view host) {
  if (host == "localhost") return "127.0.0.1";
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  const std::string address(bracketed ? host.substr(1, host.size() - 2) : host);
  return is_address(bracketed ? AF_INET6 : AF_INET, address) ? address : "";
}

}  // namespace

Result<Listen> parse_listen(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon != std::string_view::npos && text.find('\0') == std::string_view::npos) {
    const std::string address = address_of(text.substr(0, colon));
    const auto port = port_of(text.substr(colon + 1));
    if (!address.empty() && port) return Listen{address, *port};
  }
  return tin::base::error(Code::kInvalidValue,
                          "must be an address and a port, such as 127.0.0.1:8080 or [::1]:8080");
}

Result<void> check_exposure(const Config& config) {
  const std::string& address = config.listen.address;
  const bool loopback = address.starts_with("127.") || address == "::1";
  if (loopback || !config.auth.tokens.empty() || config.auth.insecure) return {};
  return tin::base::error(
      Code::kInvalidValue,
      "Anybody who reaches " + address +
          " could read and change everything: set tokens (tinsmith token makes one), listen on "
          "127.0.0.1 behind a proxy, or say --insecure if that is meant");
}

Result<Config> parse_config(std::string_view text, std::string_view name) {
  const std::string prefix = std::string(name) + ": ";
  json document;
  try {
    document = json::parse(text);
  } catch (const json::parse_error& failure) {
    return tin::base::error(Code::kMalformed, prefix + failure.what());
  }
  auto config = config_of(document);
  if (config.ok()) return config;
  Error error = std::move(config).error();
  error.message = prefix + (error.where.empty() ? "" : error.where + " ") + error.message;
  return error;
}

Result<Config> read_config(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return tin::base::error(Code::kNotFound, "cannot read the configuration " + file.string());
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_config(text, file.string());
}

}  // namespace server
