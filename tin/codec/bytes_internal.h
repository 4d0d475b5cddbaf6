// Writing and reading the primitives of FORMAT.md. For this folder's .cc files and its tests.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tin/base/array.h"
#include "tin/base/result.h"
#include "tin/codec/sink.h"
#include "tin/exact/point.h"
#include "tin/terrain/edit.h"

namespace tin::codec {

/// A position on the lattice with a finite z: the only kind that is written and the only kind that is read.
bool storable(const terrain::Placement& placement);

/// Appends primitives to a string, of which pieces may go to a sink before the rest is there.
class Writer {
 public:
  /// Starts with magic and version.
  Writer(std::string_view magic, std::uint16_t version);

  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  void u8(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  void u64(std::uint64_t value) { fixed(value, 8); }
  void f64(double value);
  void varint(std::uint64_t value);
  void zigzag(std::int64_t value);
  void text(std::string_view value);
  /// A position on the lattice.
  void at(exact::Point value);
  /// `at` and z. Requires: storable(placement).
  void placement(const terrain::Placement& placement);
  /// Hands out what is there, if that is much; for long work, between its items.
  base::Result<void> flush(const Sink& sink);
  /// Appends the checksum and hands the rest out.
  std::string finish();

 private:
  void fixed(std::uint64_t value, int bytes);

  std::string bytes_;
  std::uint32_t crc_ = 0;  // of what was handed out
  exact::Point previous_;
};

/// Takes primitives off a string. After the first failure every read gives zeros and remaining() is 0, so
/// that callers may read on and ask ok() where a loop or an allocation depends on it.
class Reader {
 public:
  /// Checks magic, version and checksum of `bytes`, which must outlive the reader; `pace` is of their memory.
  Reader(std::string_view bytes, std::string_view magic, std::uint16_t newest_version, std::string_view what,
         const base::Pace& pace = {});

  bool ok() const { return failure_.message.empty(); }
  /// The version that the bytes are of.
  std::uint16_t version() const { return version_; }
  /// Bytes left before the checksum: bounds every count that is believed.
  std::size_t remaining() const { return bytes_.size(); }
  const base::Error& error() const { return failure_; }

  std::uint8_t u8();
  std::uint64_t u64() { return fixed(8); }
  double f64();
  std::uint64_t varint();
  std::int64_t zigzag();
  std::string text();
  exact::Point at();
  terrain::Placement placement();
  /// A varint that says how many items of at least `bytes_each` follow.
  std::size_t count(std::size_t bytes_each);

  /// Fails with "<what>: <problem>" unless `holds`, or unless something failed before.
  void require(bool holds, std::string_view problem);
  /// Fails unless everything was read.
  void finish() { require(remaining() == 0, "bytes are left over"); }

 private:
  void fail(base::Code code, std::string_view problem);
  std::uint64_t fixed(int bytes);

  std::string_view bytes_;
  std::string_view what_;
  base::Error failure_;
  exact::Point previous_;
  std::uint16_t version_ = 0;
};

}  // namespace tin::codec
