// What an operator can set, with the defaults of one who sets nothing. Read and checked once, at the start.
//
//   {"listen": "0.0.0.0:8080", "limits": {"tins": 10}}      // every key is optional
//
// deploy/config.example.json has all keys at their defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "server/auth/tokens.h"
#include "tin/base/result.h"

namespace server {

/// Where the server listens.
struct Listen {
  std::string address = "127.0.0.1";  // IPv4 or IPv6, without brackets
  std::uint16_t port = 8080;          // 0: any free one
  friend bool operator==(const Listen&, const Listen&) = default;
};

struct LimitConfig {
  std::int64_t body_bytes_memory = 32 << 20;          // of a body that is read into memory
  std::int64_t upload_bytes = std::int64_t{2} << 30;  // of a body that goes to a file
  std::int64_t unpacked_bytes = std::int64_t{8} << 30;  // of what is read from an uploaded ZIP archive
  std::int64_t raster_pixels = 500'000'000;             // of an uploaded raster
  std::int64_t export_pixels = 400'000'000;           // of a raster that is made
  std::int64_t memory_bytes = 0;  // that terrains, versions and jobs take, estimated; 0: 3/4 of the machine
  std::int64_t raster_memory_bytes =
      512 << 20;  // of a raster's samples while it is simplified, each; the rest is in files
  std::int64_t scratch_bytes = std::int64_t{16} << 30;  // of these files, in all; 0: everything is in memory
  std::int64_t vertices_per_tin = 50'000'000;
  std::int64_t tins = 1000;
  std::int64_t edits_per_request = 100'000;
  std::int64_t areas_per_request = 16;  // edits of an area; each looks at all vertices
  std::int64_t positions_per_request = 1'000'000;
  std::int64_t polygon_positions = 5000;       // of a polygon that is asked about
  std::int64_t contour_levels = 10'000;        // per request
  std::int64_t answer_positions = 1'000'000;   // of a profile, and of contours that a process returns
  std::int64_t uploads_at_once = 2;     // files being read beside the jobs
  std::int64_t exports_at_once = 2;     // rasters being made
  std::int64_t export_seconds = 120;    // for making one
  std::int64_t tile_cache_bytes = 64 << 20;  // of tiles that are kept; 0: none
  std::int64_t edits_at_once = 128;     // edits being applied or waiting for the disk
  std::int64_t listeners = 100;         // streams of changes
  std::int64_t page_size = 1000;        // when a request does not say
  std::int64_t page_size_max = 10'000;  // the most that it may say; not less than page_size
  friend bool operator==(const LimitConfig&, const LimitConfig&) = default;
};

/// What the process that reads an uploaded file may use up.
struct DecoderConfig {
  std::int64_t memory_bytes = std::int64_t{4} << 30;  // of address space, some 170 MB of libraries included
  std::int64_t file_bytes = std::int64_t{8} << 30;    // of a temporary file: an archive's entry that is unpacked
  std::int64_t cpu_seconds = 300;
  std::int64_t seconds = 600;  // in all
  friend bool operator==(const DecoderConfig&, const DecoderConfig&) = default;
};

struct JobConfig {
  std::int64_t workers = 1;
  std::int64_t queued = 16;
  std::int64_t kept = 200;
  std::int64_t sync_seconds =
      60;                         // how long a request waits for its job before it is told where to ask later
  std::int64_t sync_waiting = 4;  // requests that may wait so; others are told at once
  /// After which a simplification comes to an end with the best result so far; no request may ask for more.
  std::int64_t simplify_seconds = 3600;
  friend bool operator==(const JobConfig&, const JobConfig&) = default;
};

/// What is kept of the past. The journal since the last checkpoint is kept in any case.
struct HistoryConfig {
  std::int64_t revisions = 100'000;             // per TIN, that can be listed and undone
  std::int64_t bytes = std::int64_t{1} << 30;   // per TIN, of their records
  std::int64_t checkpoint_steps = 200'000;      // changed vertices from one checkpoint to the next
  std::int64_t key_hours = 24;                  // how long an Idempotency-Key is remembered
  std::int64_t keys = 1'000'000;                // the most of them
  friend bool operator==(const HistoryConfig&, const HistoryConfig&) = default;
};

struct HttpConfig {
  std::int64_t io_threads = 2;
  std::int64_t worker_threads =
      0;  // for short requests, beside those that may wait; 0: two per core, at least 8
  std::int64_t header_bytes = 16 * 1024;
  std::int64_t header_fields = 100;
  std::int64_t target_bytes = 8 * 1024;
  std::int64_t header_seconds = 10;
  std::int64_t buffered_bytes =
      256 << 20;  // of bodies in memory and of answers that wait for clients, in all
  std::int64_t body_bytes_per_second = 1024;  // the least, either way
  std::int64_t stall_seconds = 60;            // without any progress of a body
  std::int64_t compress_from_bytes = 1024;    // of an answer in text, for clients that accept it; 0: never
  std::int64_t keep_alive_seconds = 75;
  std::int64_t requests_per_connection = 1000;
  std::int64_t connections = 1000;
  std::int64_t connections_per_address = 200;
  std::int64_t drain_notice_seconds = 0;  // between /readyz saying no and the end of new connections
  std::int64_t drain_seconds = 30;        // for what runs when the server is told to stop
  friend bool operator==(const HttpConfig&, const HttpConfig&) = default;
};

/// Who may use the server. Without tokens anybody may do anything; then it listens to this machine only,
/// unless `insecure` says that this is meant (or is seen to elsewhere, by a proxy or a network of one's own).
struct AuthConfig {
  std::vector<auth::Grant> tokens;
  bool anonymous_read = false;  // reading needs no token
  bool insecure = false;
  friend bool operator==(const AuthConfig&, const AuthConfig&) = default;
};

struct Config {
  Listen listen;
  std::filesystem::path data_dir = "data";
  /// What clients call this server, such as "https://terrain.example.org"; empty: what their Host field says. No slash at
  /// the end.
  std::string public_url;
  std::string log_level = "info";  // debug, info, warning, error or off
  AuthConfig auth;
  LimitConfig limits;
  DecoderConfig decoder;
  JobConfig jobs;
  HistoryConfig history;
  HttpConfig http;
  friend bool operator==(const Config&, const Config&) = default;
};

/// The configuration in `file`.
///
/// Errors: kNotFound (no such file), kMalformed (no JSON object), kUnknownParameter (a key that there is
/// not),
///         kInvalidValue (type or range); `where` is the JSON pointer, and the message names file and
///         pointer.
tin::base::Result<Config> read_config(const std::filesystem::path& file);

/// The configuration in `text`; `name` stands for the file in messages.
tin::base::Result<Config> parse_config(std::string_view text, std::string_view name);

/// Whether `config` may serve where it listens. Errors: kInvalidValue: beyond this machine, and neither
/// tokens nor `insecure`.
tin::base::Result<void> check_exposure(const Config& config);

/// "127.0.0.1:8080", "[::1]:8080" or "localhost:8080" (which is 127.0.0.1). Errors: kInvalidValue.
tin::base::Result<Listen> parse_listen(std::string_view text);

}  // namespace server
