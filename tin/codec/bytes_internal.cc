#include "tin/codec/bytes_internal.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "tin/base/check.h"
#include "tin/codec/crc32c.h"

namespace tin::codec {
namespace {

constexpr std::size_t kChecksumBytes = 4;
constexpr std::size_t kVersionBytes = 2;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

std::uint32_t checksum_of(std::string_view bytes, const base::Pace& pace) {
  std::uint32_t crc = 0;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), kPieceBytes))) {
    const std::string_view piece = bytes.substr(0, kPieceBytes);
    crc = crc32c(piece, crc);
    pace.touched(1, piece.size());
  }
  return crc;
}

}  // namespace

bool storable(const terrain::Placement& placement) {
  return std::isfinite(placement.z) && exact::in_lattice(placement.at.x, placement.at.y);
}

Writer::Writer(std::string_view magic, std::uint16_t version) : bytes_(magic) {
  fixed(version, kVersionBytes);
}

void Writer::fixed(std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) u8(static_cast<std::uint8_t>(value >> (8 * i)));
}

void Writer::f64(double value) {
  fixed(std::bit_cast<std::uint64_t>(value), 8);
}

void Writer::varint(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) u8(static_cast<std::uint8_t>(value | 0x80));
  u8(static_cast<std::uint8_t>(value));
}

void Writer::zigzag(std::int64_t value) {
  varint((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
}

void Writer::text(std::string_view value) {
  varint(value.size());
  bytes_.append(value);
}

void Writer::at(exact::Point value) {
  TIN_CHECK(exact::in_lattice(value.x, value.y));
  zigzag(std::int64_t{value.x} - previous_.x);
  zigzag(std::int64_t{value.y} - previous_.y);
  previous_ = value;
}

void Writer::placement(const terrain::Placement& placement) {
  TIN_CHECK(storable(placement));
  at(placement.at);
  f64(placement.z);
}

base::Result<void> Writer::flush(const Sink& sink) {
  if (bytes_.size() < kPieceBytes) return {};
  crc_ = crc32c(bytes_, crc_);
  auto taken = sink(bytes_);
  bytes_.clear();
  return taken;
}

std::string Writer::finish() {
  fixed(crc32c(bytes_, crc_), kChecksumBytes);
  return std::move(bytes_);
}

Reader::Reader(std::string_view bytes, std::string_view magic, std::uint16_t newest_version,
               std::string_view what, const base::Pace& pace)
    : bytes_(bytes), what_(what) {
  require(bytes.starts_with(magic), "does not start as one");
  if (!ok()) return;
  bytes_.remove_prefix(magic.size());
  version_ = static_cast<std::uint16_t>(fixed(kVersionBytes));
  if (ok() && version_ > newest_version) {
    fail(base::Code::kUnsupported, "format version " + std::to_string(version_) + " is newer than " +
                                       std::to_string(newest_version) + ", the newest this program reads");
  }
  require(version_ >= 1, "format version 0");
  require(remaining() >= kChecksumBytes, "cut short");
  if (!ok()) return;
  const std::string_view summed = bytes.substr(0, bytes.size() - kChecksumBytes);
  const std::string_view body = bytes_.substr(0, bytes_.size() - kChecksumBytes);
  bytes_.remove_prefix(body.size());
  const std::uint64_t checksum = fixed(kChecksumBytes);
  require(checksum == checksum_of(summed, pace), "the checksum does not match");
  if (ok()) bytes_ = body;
}

void Reader::fail(base::Code code, std::string_view problem) {
  failure_ = base::error(code, std::string(what_) + ": " + std::string(problem));
  bytes_ = {};
}

void Reader::require(bool holds, std::string_view problem) {
  if (ok() && !holds) fail(base::Code::kMalformed, problem);
}

std::uint64_t Reader::fixed(int bytes) {
  const auto size = static_cast<std::size_t>(bytes);
  require(remaining() >= size, "cut short");
  if (!ok()) return 0;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= std::uint64_t{static_cast<unsigned char>(bytes_[i])} << (8 * i);
  }
  bytes_.remove_prefix(size);
  return value;
}

std::uint8_t Reader::u8() {
  return static_cast<std::uint8_t>(fixed(1));
}

double Reader::f64() {
  return std::bit_cast<double>(fixed(8));
}

std::uint64_t Reader::varint() {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint8_t byte = u8();
    const std::uint64_t bits = byte & 0x7fU;
    require((bits << shift) >> shift == bits, "a number is too large");
    value |= bits << shift;
    if ((byte & 0x80U) == 0) {
      require(byte != 0 || shift == 0, "a number is not in its shortest form");
      return ok() ? value : 0;
    }
  }
  require(false, "a number is too long");
  return 0;
}

std::int64_t Reader::zigzag() {
  const std::uint64_t value = varint();
  return static_cast<std::int64_t>((value >> 1) ^ (~(value & 1U) + 1U));
}

std::string Reader::text() {
  const std::size_t size = count(1);
  std::string value(bytes_.substr(0, size));
  bytes_.remove_prefix(size);
  return value;
}

exact::Point Reader::at() {
  const std::int64_t dx = zigzag();
  const std::int64_t dy = zigzag();
  // Differences of lattice coordinates need 31 bits; larger ones must not reach the sum, which would
  // overflow.
  constexpr std::int64_t kMost = 2 * std::int64_t{exact::kLatticeHalf};
  require(dx >= -kMost && dx <= kMost && dy >= -kMost && dy <= kMost, "a position is outside the lattice");
  if (!ok()) return {};
  const std::int64_t x = previous_.x + dx;
  const std::int64_t y = previous_.y + dy;
  require(exact::in_lattice(x, y), "a position is outside the lattice");
  if (!ok()) return {};
  previous_ = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  return previous_;
}

terrain::Placement Reader::placement() {
  const exact::Point position = at();
  const double z = f64();
  require(std::isfinite(z), "an elevation is not finite");
  if (!ok()) return {};
  return {position, z};
}

std::size_t Reader::count(std::size_t bytes_each) {
  const std::uint64_t items = varint();
  require(items <= remaining() / bytes_each, "a count is larger than what follows");
  return ok() ? static_cast<std::size_t>(items) : 0;
}

}  // namespace tin::codec
