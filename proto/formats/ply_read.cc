// PLY files of anyone: the header says what is in them.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "proto/formats/little_endian.h"
#include "proto/formats/ply.h"
#include "proto/formats/text_internal.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

namespace {

constexpr std::uint64_t kMostHeaderLines = 10'000;
constexpr std::size_t kMostElements = 64, kMostProperties = 256;

enum class Kind { kSigned, kUnsigned, kReal };
struct Type {
  std::string_view name, other_name;
  std::uint8_t bytes;
  Kind kind;
};
constexpr std::array kTypes{
    Type{"char", "int8", 1, Kind::kSigned},   Type{"uchar", "uint8", 1, Kind::kUnsigned},
    Type{"short", "int16", 2, Kind::kSigned}, Type{"ushort", "uint16", 2, Kind::kUnsigned},
    Type{"int", "int32", 4, Kind::kSigned},   Type{"uint", "uint32", 4, Kind::kUnsigned},
    Type{"float", "float32", 4, Kind::kReal}, Type{"double", "float64", 8, Kind::kReal},
};

const Type* type_named(std::string_view name) {
  const auto found = std::find_if(kTypes.begin(), kTypes.end(), [name](const Type& type) {
    return type.name == name || type.other_name == name;
  });
  return found == kTypes.end() ? nullptr : &*found;
}

struct Property {
  std::string name;
  const Type* type;
  const Type* count = nullptr;  // of a list
};
struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Property> properties;
};
enum class Encoding { kText, kLittle, kBig };

class PlyReader {
 public:
  PlyReader(ByteReader& bytes, const ReadLimits& limits)
      : limits_(limits), lines_(bytes), checkpoint_(limits) {}

  Result<MeshPoints> read() {
    if (auto bad = read_header()) return *std::move(bad);
    if (auto bad = find_vertices()) return *std::move(bad);
    for (const Element& element : elements_) {
      if (auto bad = read_element(element)) return *std::move(bad);
      if (&element == vertices_) break;
    }
    return std::move(mesh_);
  }

 private:
  Error here(Code code, const std::string& what) const { return at_line(code, what, lines_.number()); }

  std::optional<Error> read_header() {
    const auto magic = lines_.next();
    if (!magic || *magic != "ply") return error(Code::kMalformed, "A PLY file begins with a line \"ply\"");
    bool formatted = false;
    while (const auto line = lines_.next()) {
      if (lines_.number() > kMostHeaderLines) return here(Code::kTooLarge, "the header is too long");
      Words words(*line);
      const std::string_view keyword = words.next();
      std::optional<Error> bad;
      if (keyword == "end_header") {
        if (formatted) return std::nullopt;
        return here(Code::kMalformed, "the header names no format");
      } else if (keyword == "format") {
        formatted = true;
        bad = take_format(words);
      } else if (keyword == "element") {
        bad = take_element(words);
      } else if (keyword == "property") {
        bad = take_property(words);
      } else if (keyword == "comment") {
        if (auto read = read_comment(mesh_, words.rest()); !read) return read.error();
      } else if (keyword != "obj_info" && !keyword.empty()) {
        bad = here(Code::kMalformed, "this is no line of a PLY header");
      }
      if (bad) return bad;
    }
    return error(Code::kMalformed, "The header of the PLY file does not end");
  }

  std::optional<Error> take_format(Words& words) {
    const std::string_view name = words.next();
    if (words.next() != "1.0") return here(Code::kUnsupported, "only version 1.0 of PLY is read");
    if (name == "ascii") {
      encoding_ = Encoding::kText;
    } else if (name == "binary_little_endian") {
      encoding_ = Encoding::kLittle;
    } else if (name == "binary_big_endian") {
      encoding_ = Encoding::kBig;
    } else {
      return here(Code::kUnsupported, "there is no PLY format of this name");
    }
    return std::nullopt;
  }

  std::optional<Error> take_element(Words& words) {
    const std::string_view name = words.next();
    const auto rows = to_integer(words.next());
    if (name.empty() || !rows || *rows < 0)
      return here(Code::kMalformed, "an element has a name and a count");
    if (elements_.size() == kMostElements) return here(Code::kTooLarge, "there are too many elements");
    elements_.push_back({std::string(name), static_cast<std::uint64_t>(*rows), {}});
    return std::nullopt;
  }

  std::optional<Error> take_property(Words& words) {
    if (elements_.empty()) return here(Code::kMalformed, "a property must belong to an element");
    auto& properties = elements_.back().properties;
    if (properties.size() == kMostProperties) return here(Code::kTooLarge, "there are too many properties");
    Property property{};
    std::string_view word = words.next();
    if (word == "list") {
      property.count = type_named(words.next());
      if (property.count == nullptr || property.count->kind == Kind::kReal)
        return here(Code::kMalformed, "a list is counted by an integer");
      word = words.next();
    }
    property.type = type_named(word);
    property.name = words.next();
    if (property.type == nullptr || property.name.empty())
      return here(Code::kMalformed, "a property has a type and a name");
    properties.push_back(std::move(property));
    return std::nullopt;
  }

  std::optional<Error> find_vertices() {
    const auto found = std::find_if(elements_.begin(), elements_.end(),
                                    [](const Element& element) { return element.name == "vertex"; });
    if (found == elements_.end()) return error(Code::kInvalidValue, "The PLY file has no element vertex");
    vertices_ = &*found;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const auto& all = vertices_->properties;
      const auto property = std::find_if(all.begin(), all.end(), [&name](const Property& one) {
        return one.name == name && one.count == nullptr;
      });
      if (property == all.end())
        return error(Code::kInvalidValue, "The vertices of the PLY file have no property " + name);
      axes_[axis] = static_cast<std::size_t>(property - all.begin());
    }
    if (vertices_->rows > limits_.points) {
      return error(Code::kTooLarge, "The file holds more than " + std::to_string(limits_.points) +
                                        " elevations, the limit here");
    }
    return std::nullopt;
  }

  std::optional<Error> read_element(const Element& element) {
    // A row without properties takes no byte, whatever the count.
    if (element.properties.empty()) return std::nullopt;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      if (auto going = checkpoint_.pass(lines_.bytes_read()); !going) return going.error();
      auto bad = encoding_ == Encoding::kText ? read_text_row(element) : read_binary_row(element, row);
      if (bad) return bad;
    }
    return std::nullopt;
  }

  std::optional<Error> read_text_row(const Element& element) {
    std::optional<std::string_view> line;
    do {
      line = lines_.next();
      if (!line) return error(Code::kMalformed, "The PLY file ends before its element " + element.name);
    } while (line->find_first_not_of(" \t") == std::string_view::npos);
    if (&element != vertices_) return std::nullopt;
    Words words(*line);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const auto number = to_number(words.next());
      if (!number) return here(Code::kMalformed, "a number is missing");
      row_[i] = *number;
      if (element.properties[i].count == nullptr) continue;
      // The items of a list, of which none is wanted.
      if (!(*number >= 0)) return here(Code::kMalformed, "a list has a negative length");
      for (double left = *number; left >= 1; --left) {
        if (words.next().empty()) return here(Code::kMalformed, "a list is too short");
      }
    }
    return take_row([this](Code code, const std::string& what) { return here(code, what); });
  }

  std::optional<Error> read_binary_row(const Element& element, std::uint64_t row) {
    const auto ended = [&] {
      return error(Code::kMalformed,
                   "The PLY file ends within element " + element.name + ", row " + std::to_string(row));
    };
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      const auto value = read_value(property.count == nullptr ? *property.type : *property.count);
      if (!value) return ended();
      row_[i] = *value;
      if (property.count == nullptr) continue;
      if (*value < 0) return error(Code::kMalformed, "A list of the PLY file has a negative length");
      if (!skip(static_cast<std::uint64_t>(*value) * property.type->bytes)) return ended();
    }
    if (&element != vertices_) return std::nullopt;
    return take_row([row](Code code, const std::string& what) {
      return error(code, "Vertex " + std::to_string(row) + ": " + what, "vertex " + std::to_string(row));
    });
  }

  std::optional<double> read_value(const Type& type) {
    std::array<char, 8> bytes{};
    if (!lines_.read_fully(bytes.data(), type.bytes)) return std::nullopt;
    if (encoding_ == Encoding::kBig) std::reverse(bytes.begin(), bytes.begin() + type.bytes);
    const auto bits = read_little<std::uint64_t>(bytes.data());
    if (type.kind == Kind::kReal) {
      if (type.bytes == 8) return std::bit_cast<double>(bits);
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
    if (type.kind == Kind::kUnsigned) return static_cast<double>(bits);
    const int unused = 64 - 8 * type.bytes;
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }

  bool skip(std::uint64_t bytes) {
    std::array<char, 4096> nowhere;
    while (bytes > 0) {
      const std::size_t some = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, nowhere.size()));
      if (!lines_.read_fully(nowhere.data(), some)) return false;
      bytes -= some;
    }
    return true;
  }

  template <class Fail>
  std::optional<Error> take_row(const Fail& fail) {
    const Position at{row_[axes_[0]], row_[axes_[1]], row_[axes_[2]]};
    if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z))
      return fail(Code::kNotFinite, "a coordinate is not a finite number");
    mesh_.points.push_back(at);
    return std::nullopt;
  }

  const ReadLimits& limits_;
  LineReader lines_;
  Checkpoint checkpoint_;
  MeshPoints mesh_;
  Encoding encoding_ = Encoding::kText;
  std::vector<Element> elements_;
  const Element* vertices_ = nullptr;
  std::array<std::size_t, 3> axes_{};
  std::array<double, kMostProperties> row_{};
};

}  // namespace

Result<MeshPoints> read_ply(ByteReader& bytes, const ReadLimits& limits) {
  return PlyReader(bytes, limits).read();
}

}  // namespace proto::formats
