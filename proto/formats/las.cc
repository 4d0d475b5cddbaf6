#include "proto/formats/las.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "proto/formats/little_endian.h"
#include "proto/formats/text_internal.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

namespace {

constexpr std::size_t kShortestHeader = 227, kHeader14 = 375;
constexpr std::size_t kRecordHeader = 54, kExtendedRecordHeader = 60;
constexpr std::uint32_t kMostRecords = 100'000;
constexpr std::uint64_t kLongestCrs = 1 << 20;
/// Bytes of a point in each format; a file may have more.
constexpr std::array<std::uint16_t, 11> kPointBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

double read_double(const char* at) {
  return std::bit_cast<double>(read_little<std::uint64_t>(at));
}

Error malformed(const std::string& what) {
  return error(Code::kMalformed, "The LAS file is damaged: " + what);
}

struct Header {
  std::uint64_t size = 0;  // of the header
  std::uint64_t points_at = 0, points = 0;
  std::uint32_t records = 0;
  std::uint8_t format = 0;
  std::uint16_t point_bytes = 0;
  std::array<double, 3> scale{}, offset{};
  std::uint64_t extended_at = 0;
  std::uint32_t extended = 0;
};

class LasReader {
 public:
  LasReader(ByteReader& bytes, const LasClasses& classes, const ReadLimits& limits)
      : bytes_(bytes), classes_(classes), limits_(limits) {}

  Result<LasFile> read() {
    if (auto bad = read_header()) return *std::move(bad);
    if (auto bad = check_header()) return *std::move(bad);
    if (auto bad = read_records()) return *std::move(bad);
    if (auto bad = read_points()) return *std::move(bad);
    if (auto bad = read_extended_records()) return *std::move(bad);
    return std::move(file_);
  }

 private:
  bool take(char* to, std::uint64_t size) {
    at_ += size;
    return bytes_.read_fully(to, static_cast<std::size_t>(size));
  }
  bool pass(std::uint64_t size) {
    at_ += size;
    return bytes_.skip(size);
  }

  std::optional<Error> read_header() {
    std::array<char, kHeader14> head{};
    if (!take(head.data(), kShortestHeader)) return malformed("its header is cut off");
    if (std::string_view(head.data(), 4) != "LASF") return malformed("it does not begin with LASF");
    const auto major = static_cast<unsigned char>(head[24]), minor = static_cast<unsigned char>(head[25]);
    if (major != 1 || minor > 4) {
      return error(Code::kUnsupported, "LAS " + std::to_string(major) + "." + std::to_string(minor) +
                                           " is not read; the versions 1.0 to 1.4 are");
    }
    header_.size = read_little<std::uint16_t>(&head[94]);
    header_.points_at = read_little<std::uint32_t>(&head[96]);
    header_.records = read_little<std::uint32_t>(&head[100]);
    header_.format = static_cast<std::uint8_t>(head[104]);
    header_.point_bytes = read_little<std::uint16_t>(&head[105]);
    header_.points = read_little<std::uint32_t>(&head[107]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      header_.scale[axis] = read_double(&head[131 + 8 * axis]);
      header_.offset[axis] = read_double(&head[155 + 8 * axis]);
    }
    if (minor < 4) return std::nullopt;
    if (!take(&head[kShortestHeader], kHeader14 - kShortestHeader)) return malformed("its header is cut off");
    header_.extended_at = read_little<std::uint64_t>(&head[235]);
    header_.extended = read_little<std::uint32_t>(&head[243]);
    header_.points = read_little<std::uint64_t>(&head[247]);
    return std::nullopt;
  }

  std::optional<Error> check_header() {
    if ((header_.format & 0xC0) != 0) {
      return error(Code::kUnsupported,
                   "LAZ, which is compressed LAS, is not read: decompress it first, for example with laszip");
    }
    if (header_.format >= kPointBytes.size())
      return error(Code::kUnsupported, "There is no LAS point format " + std::to_string(header_.format));
    if (header_.point_bytes < kPointBytes[header_.format])
      return malformed("its points are too short for their format");
    if (header_.size < at_ || header_.points_at < header_.size)
      return malformed("its header and its points overlap");
    if (header_.records > kMostRecords) return malformed("it has too many records");
    if (header_.points_at > bytes_.size() ||
        header_.points > (bytes_.size() - header_.points_at) / header_.point_bytes)
      return malformed("it should hold " + std::to_string(header_.points) + " points and is shorter");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(header_.scale[axis]) || header_.scale[axis] == 0 ||
          !std::isfinite(header_.offset[axis]))
        return malformed("its scale or offset is of no use");
    }
    if (!pass(header_.size - at_)) return malformed("its header is cut off");
    return std::nullopt;
  }

  std::optional<Error> read_records() {
    for (std::uint32_t i = 0; i < header_.records; ++i) {
      std::array<char, kRecordHeader> head{};
      if (at_ + head.size() > header_.points_at) break;  // some writers count one too many
      if (!take(head.data(), head.size())) return malformed("a record is cut off");
      const auto length = read_little<std::uint16_t>(&head[20]);
      if (at_ + length > header_.points_at) return malformed("a record reaches into the points");
      if (auto bad = read_record(&head[2], read_little<std::uint16_t>(&head[18]), length)) return bad;
    }
    if (!pass(header_.points_at - at_)) return malformed("it ends before its points");
    return std::nullopt;
  }

  /// A record that tells the CRS is kept, others are passed over.
  std::optional<Error> read_record(const char* user, std::uint16_t id, std::uint64_t length) {
    std::string_view owner(user, 16);
    owner = owner.substr(0, owner.find('\0'));
    const bool crs = owner == "LASF_Projection" && (id == 2112 || (id >= 34735 && id <= 34737));
    if (!crs || length > kLongestCrs) {
      if (!pass(length)) return malformed("a record is cut off");
      return std::nullopt;
    }
    std::string content(static_cast<std::size_t>(length), '\0');
    if (!take(content.data(), length)) return malformed("a record is cut off");
    keep_crs(id, content);
    return std::nullopt;
  }

  void keep_crs(std::uint16_t id, const std::string& content) {
    if (id == 2112) file_.mesh.crs = content.substr(0, content.find('\0'));
    if (id == 34737) file_.geo_ascii = content;
    if (id == 34735) {
      for (std::size_t i = 0; i + 2 <= content.size(); i += 2)
        file_.geo_keys.push_back(read_little<std::uint16_t>(&content[i]));
    }
    if (id == 34736) {
      for (std::size_t i = 0; i + 8 <= content.size(); i += 8)
        file_.geo_doubles.push_back(read_double(&content[i]));
    }
  }

  std::optional<Error> read_points() {
    constexpr std::uint64_t kAtOnce = 1024;
    std::vector<char> block(kAtOnce * header_.point_bytes);
    for (std::uint64_t first = 0; first < header_.points; first += kAtOnce) {
      const std::uint64_t count = std::min(kAtOnce, header_.points - first);
      if (!take(block.data(), count * header_.point_bytes)) return malformed("it ends within its points");
      for (std::uint64_t i = 0; i < count; ++i) {
        if (auto bad = take_point(&block[static_cast<std::size_t>(i) * header_.point_bytes], first + i))
          return bad;
      }
      if (limits_.check) {
        if (auto going = limits_.check(at_); !going) return going.error();
      }
    }
    return std::nullopt;
  }

  std::optional<Error> take_point(const char* point, std::uint64_t number) {
    const bool late = header_.format >= 6;
    const auto flags = static_cast<unsigned char>(point[15]);
    const unsigned kind = late ? static_cast<unsigned char>(point[16]) : flags & 0x1FU;
    if ((flags & (late ? 0x04U : 0x80U)) != 0) {
      ++file_.withheld;
      return std::nullopt;
    }
    if (!classes_[kind]) {
      ++file_.others;
      return std::nullopt;
    }
    std::array<double, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto whole = static_cast<std::int32_t>(read_little<std::uint32_t>(point + 4 * axis));
      at[axis] = whole * header_.scale[axis] + header_.offset[axis];
      if (!std::isfinite(at[axis])) {
        return error(Code::kNotFinite, "Point " + std::to_string(number) + " is not finite",
                     "point " + std::to_string(number));
      }
    }
    if (auto added = add_point(file_.mesh, {at[0], at[1], at[2]}, limits_); !added) return added.error();
    return std::nullopt;
  }

  /// LAS 1.4 may keep its WKT behind the points.
  std::optional<Error> read_extended_records() {
    if (header_.extended == 0 || header_.extended_at < at_ || header_.extended_at > bytes_.size())
      return std::nullopt;
    if (!pass(header_.extended_at - at_)) return malformed("it ends before its extended records");
    for (std::uint32_t i = 0; i < std::min(header_.extended, kMostRecords); ++i) {
      std::array<char, kExtendedRecordHeader> head{};
      if (!take(head.data(), head.size())) return malformed("an extended record is cut off");
      const auto length = read_little<std::uint64_t>(&head[20]);
      if (length > bytes_.size() - at_) return malformed("an extended record is cut off");
      if (auto bad = read_record(&head[2], read_little<std::uint16_t>(&head[18]), length)) return bad;
    }
    return std::nullopt;
  }

  ByteReader& bytes_;
  const LasClasses& classes_;
  const ReadLimits& limits_;
  std::uint64_t at_ = 0;
  Header header_;
  LasFile file_;
};

}  // namespace

Result<LasFile> read_las(ByteReader& bytes, const LasClasses& classes, const ReadLimits& limits) {
  return LasReader(bytes, classes, limits).read();
}

}  // namespace proto::formats
