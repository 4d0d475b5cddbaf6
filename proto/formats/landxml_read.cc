// LandXML of anyone, event by event.
#include <expat.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "proto/formats/frame_note.h"
#include "proto/formats/landxml.h"
#include "proto/formats/text_internal.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

namespace {

constexpr std::size_t kDeepest = 64, kLongestPoint = 1024;
constexpr std::int64_t kLongestToken = std::int64_t{1} << 20;
constexpr int kPiece = 64 * 1024;

std::string_view local_name(const char* name) {
  const std::string_view whole(name);
  return whole.substr(whole.rfind(':') + 1);  // npos + 1 is 0
}

std::string_view attribute(const char** attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2) {
    if (name == attributes[0]) return attributes[1];
  }
  return {};
}

std::optional<LengthUnit> length_unit(std::string_view name) {
  if (name == "meter") return LengthUnit{"metre", 1};
  if (name == "kilometer") return LengthUnit{"kilometre", 1000};
  if (name == "centimeter") return LengthUnit{"centimetre", 0.01};
  if (name == "millimeter") return LengthUnit{"millimetre", 0.001};
  if (name == "foot" || name == "feet") return LengthUnit{"foot", 0.3048};
  if (name == "USSurveyFoot") return LengthUnit{"US survey foot", 1200.0 / 3937};
  if (name == "inch") return LengthUnit{"inch", 0.0254};
  if (name == "mile" || name == "miles") return LengthUnit{"mile", 1609.344};
  return std::nullopt;
}

/// Which points are shown: ids to points where ids are numbers as small as their count allows, as is usual.
class Shown {
 public:
  void add_point(std::string_view id, std::size_t index) {
    const auto number = to_integer(id);
    if (!number || *number < 0 || *number > 4 * static_cast<std::int64_t>(index) + 1'000'000) {
      usable_ = false;
      return;
    }
    const auto at = static_cast<std::size_t>(*number);
    if (usable_ && at >= point_of_.size()) point_of_.resize(at + at / 2 + 1, kNone);
    if (usable_) point_of_[at] = static_cast<std::uint32_t>(index);
  }
  void add_face(std::string_view text, bool hidden) {
    Words words(text);
    for (std::string_view word = words.next(); usable_ && !word.empty(); word = words.next()) {
      const auto number = to_integer(word);
      if (!number || *number < 0 || static_cast<std::size_t>(*number) >= point_of_.size()) continue;
      const std::uint32_t point = point_of_[static_cast<std::size_t>(*number)];
      if (point == kNone) continue;
      if (use_.size() <= point) use_.resize(point_of_.size());
      use_[point] = static_cast<std::uint8_t>(use_[point] | (hidden ? kHidden : kVisible));
    }
  }
  bool only_hidden(std::size_t index) const {
    return usable_ && index < use_.size() && use_[index] == kHidden;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::uint8_t kVisible = 1, kHidden = 2;
  bool usable_ = true;
  std::vector<std::uint32_t> point_of_;
  std::vector<std::uint8_t> use_;
};

class LandXmlReader {
 public:
  LandXmlReader(ByteReader& bytes, const std::string& surface, const ReadLimits& limits)
      : bytes_(bytes), wanted_(surface), limits_(limits), parser_(XML_ParserCreate(nullptr)) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), on_start, on_end);
    XML_SetCharacterDataHandler(parser_.get(), on_text);
    XML_SetStartDoctypeDeclHandler(parser_.get(), on_doctype);
  }

  Result<MeshPoints> read() {
    for (bool last = false; !last;) {
      void* const buffer = XML_GetBuffer(parser_.get(), kPiece);
      if (buffer == nullptr) return error(Code::kTooLarge, "The LandXML file cannot be held in memory");
      const std::size_t got = bytes_.read(static_cast<char*>(buffer), kPiece);
      if (bytes_.failed()) return error(Code::kStorage, "The file could not be read");
      last = got == 0;
      read_ += got;
      const auto status = XML_ParseBuffer(parser_.get(), static_cast<int>(got), last ? 1 : 0);
      if (failure_) return *std::move(failure_);
      if (status != XML_STATUS_OK) return fail(Code::kMalformed, xml_complaint());
      const auto parsed = XML_GetCurrentByteIndex(parser_.get());
      if (parsed >= 0 && static_cast<std::int64_t>(read_) - parsed > kLongestToken + kPiece)
        return fail(Code::kTooLarge, "a tag is too long");
      if (limits_.check) {
        if (auto going = limits_.check(read_); !going) return going.error();
      }
    }
    return finish();
  }

 private:
  struct Free {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

  static LandXmlReader& self(void* data) { return *static_cast<LandXmlReader*>(data); }
  static void XMLCALL on_start(void* data, const char* name, const char** attributes) {
    if (!self(data).failure_) self(data).start(local_name(name), attributes);
  }
  static void XMLCALL on_end(void* data, const char* name) {
    if (!self(data).failure_) self(data).end(local_name(name));
  }
  static void XMLCALL on_text(void* data, const char* text, int length) {
    self(data).text(std::string_view(text, static_cast<std::size_t>(length)));
  }
  static void XMLCALL on_doctype(void* data, const char*, const char*, const char*, int) {
    self(data).stop(Code::kUnsupported, "a document type declaration is not read");
  }

  std::string xml_complaint() const { return XML_ErrorString(XML_GetErrorCode(parser_.get())); }
  Error fail(Code code, const std::string& what) const {
    return at_line(code, what, XML_GetCurrentLineNumber(parser_.get()));
  }
  void stop(Code code, const std::string& what) { stop(fail(code, what)); }
  void stop(Error error) {
    if (!failure_) failure_ = std::move(error);
    XML_StopParser(parser_.get(), XML_FALSE);
  }
  bool within(std::string_view parent, std::string_view grandparent) const {
    const std::size_t depth = path_.size();  // the element itself stands last
    return depth >= 3 && path_[depth - 2] == parent && path_[depth - 3] == grandparent;
  }

  void start(std::string_view name, const char** attributes) {
    if (path_.size() == kDeepest) return stop(Code::kTooLarge, "the elements are too deep");
    if (path_.empty() && name != "LandXML") return stop(Code::kMalformed, "this is not LandXML");
    path_.emplace_back(name);
    if (name == "Metric" || name == "Imperial") return take_units(attributes);
    if (name == "CoordinateSystem") return take_crs(attributes);
    if (name == "Surface") {
      // Once one has given points, the others are passed over.
      const bool asked = wanted_.empty() || wanted_ == attribute(attributes, "name");
      taking_ = asked && mesh_.points.empty();
      seen_ = seen_ || asked;
    } else if (taking_ && name == "Property" && within("Feature", "Surface")) {
      if (attribute(attributes, "label") == "frame" && frame_feature_) take_frame(attributes);
    } else if (taking_ && name == "Feature") {
      frame_feature_ = attribute(attributes, "code") == kFrameNoteName;
    } else if (taking_ && name == "P" && within("Pnts", "Definition")) {
      if (!attribute(attributes, "pntRef").empty())
        return stop(Code::kUnsupported, "points that refer to other points are not read");
      id_ = attribute(attributes, "id");
      text_.clear();
      collecting_ = true;
    } else if (taking_ && name == "F" && within("Faces", "Definition")) {
      hidden_ = attribute(attributes, "i") == "1";
      text_.clear();
      collecting_ = true;
    }
  }

  void end(std::string_view name) {
    if (collecting_ && name == "P") take_point();
    if (collecting_ && name == "F") shown_.add_face(text_, hidden_);
    if (name == "P" || name == "F") collecting_ = false;
    if (!path_.empty()) path_.pop_back();
  }

  void text(std::string_view piece) {
    if (!collecting_ || failure_) return;
    if (text_.size() + piece.size() > kLongestPoint)
      return stop(Code::kTooLarge, "a point or face is too long");
    text_ += piece;
    std::replace(text_.begin(), text_.end(), '\n', ' ');
  }

  void take_units(const char** attributes) {
    mesh_.horizontal = length_unit(attribute(attributes, "linearUnit"));
    mesh_.vertical = length_unit(attribute(attributes, "elevationUnit"));
    if (!mesh_.vertical) mesh_.vertical = mesh_.horizontal;
  }

  void take_crs(const char** attributes) {
    std::string_view code = attribute(attributes, "epsgCode");
    code = code.substr(code.rfind(':') + 1);
    const bool digits = !code.empty() && code.size() < 10 &&
                        std::all_of(code.begin(), code.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (digits && code.find_first_not_of('0') != std::string_view::npos) {
      mesh_.crs = "EPSG:" + std::string(code);
    } else {
      mesh_.crs = attribute(attributes, "ogcWktCode");
    }
  }

  void take_frame(const char** attributes) {
    auto frame = read_frame_note(attribute(attributes, "value"));
    if (!frame) return stop(Code::kMalformed, "the note on the lattice is damaged");
    mesh_.frame = *std::move(frame);
  }

  void take_point() {
    Words words(text_);
    const auto at = read_position(words);
    if (!at) return stop(at.error().code, at.error().message);
    shown_.add_point(id_, mesh_.points.size());
    if (auto added = add_point(mesh_, {at->y, at->x, at->z}, limits_); !added) stop(added.error());
  }

  Result<MeshPoints> finish() {
    if (!seen_ && !wanted_.empty())
      return error(Code::kInvalidValue, "The file has no surface of this name", "query:layer");
    if (!mesh_.frame) {
      std::size_t index = 0;
      std::erase_if(mesh_.points, [&](const Position&) { return shown_.only_hidden(index++); });
    }
    return std::move(mesh_);
  }

  ByteReader& bytes_;
  const std::string& wanted_;
  const ReadLimits& limits_;
  std::unique_ptr<XML_ParserStruct, Free> parser_;
  std::optional<Error> failure_;
  std::uint64_t read_ = 0;

  std::vector<std::string> path_;
  bool seen_ = false, taking_ = false, collecting_ = false, hidden_ = false, frame_feature_ = false;
  std::string id_, text_;
  Shown shown_;
  MeshPoints mesh_;
};

}  // namespace

Result<MeshPoints> read_landxml(ByteReader& bytes, const std::string& surface, const ReadLimits& limits) {
  return LandXmlReader(bytes, surface, limits).read();
}

}  // namespace proto::formats
