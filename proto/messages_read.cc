#include <algorithm>
#include <limits>
#include <tuple>

#include "proto/crs_uri.h"
#include "proto/json_read.h"
#include "proto/messages.h"
#include "proto/messages_internal.h"
#include "proto/processes/process.h"
#include "proto/utf8.h"

namespace proto {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Duplicates;

namespace {

constexpr std::size_t kMaxTinId = 64;
constexpr std::size_t kMaxTitle = 512;
constexpr std::size_t kMaxUnit = 64;
constexpr std::size_t kMaxCrsName = 256;
constexpr std::size_t kMaxWord = 256;
constexpr std::size_t kMaxAuthor = 200;
constexpr std::size_t kMaxNote = 2000;
constexpr std::int64_t kMaxId = std::int64_t{1} << 53;  // ids are exact in every JSON reader up to here

bool is_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// Reads the members of one object; after the first error everything else is skipped and the error stays.
class Members {
 public:
  explicit Members(const Object& object) : object_(object) {}

  double number(std::string_view name) {
    return take<double>(name, [](Value value) { return value.number(); });
  }
  VertexId id(std::string_view name) {
    const auto read = [](Value value) { return value.integer(1, kMaxId); };
    return VertexId(static_cast<std::uint64_t>(take<std::int64_t>(name, read)));
  }
  Result<void> done() { return failed_ ? Result<void>(std::move(error_)) : Result<void>(); }

 private:
  template <class T, class Read>
  T take(std::string_view name, Read read) {
    if (failed_) return {};
    auto member = object_.require(name);
    if (!member) return fail<T>(std::move(member).error());
    auto value = read(*member);
    if (!value) return fail<T>(std::move(value).error());
    return *value;
  }

  template <class T>
  T fail(tin::base::Error error) {
    failed_ = true;
    error_ = std::move(error);
    return {};
  }

  const Object& object_;
  bool failed_ = false;
  tin::base::Error error_;
};

/// An array of exactly N numbers.
template <std::size_t N>
Result<std::array<double, N>> read_numbers(Value value) {
  auto array = value.array(std::numeric_limits<std::size_t>::max());
  if (!array) return std::move(array).error();
  if (array->size() != N) {
    return value.error(Code::kMalformed, "here must be " + std::to_string(N) + " numbers, not " +
                                             std::to_string(array->size()));
  }
  std::array<double, N> numbers{};
  std::size_t i = 0;
  for (const Value item : *array) {
    auto number = item.number();
    if (!number) return std::move(number).error();
    numbers[i++] = *number;
  }
  return numbers;
}

Result<std::optional<std::string>> read_crs(const Object& object) {
  const auto member = object.find("crs");
  if (!member) return std::optional<std::string>();
  auto text = member->string(kMaxCrsName);
  if (!text) return std::move(text).error();
  auto name = parse_crs(*text, member->pointer());
  if (!name) return std::move(name).error();
  return std::optional(std::move(*name));
}

Result<std::optional<std::string>> read_title(const Object& object) {
  const auto member = object.find("title");
  if (!member) return std::optional<std::string>();
  auto text = member->string(kMaxTitle);
  if (!text) return std::move(text).error();
  if (auto fine = check_title(*text, member->pointer()); !fine) return std::move(fine).error();
  return std::optional(std::string(*text));
}

/// One number for both axes, or [x, y].
Result<std::array<double, 2>> read_resolution(Value value) {
  std::array<double, 2> steps{};
  if (value.is_array()) {
    auto pair = read_numbers<2>(value);
    if (!pair) return std::move(pair).error();
    steps = *pair;
  } else {
    auto step = value.number();
    if (!step) return std::move(step).error();
    steps = {*step, *step};
  }
  if (steps[0] > 0 && steps[1] > 0) return steps;
  return value.error(Code::kInvalidValue, "a resolution must be greater than 0");
}

Result<std::vector<Position>> read_vertices(Value value, std::size_t max_vertices) {
  auto array = value.array(max_vertices);
  if (!array) return std::move(array).error();
  std::vector<Position> vertices;
  vertices.reserve(array->size());
  for (const Value item : *array) {
    auto numbers = read_numbers<3>(item);
    if (!numbers) return std::move(numbers).error();
    vertices.push_back({(*numbers)[0], (*numbers)[1], (*numbers)[2]});
  }
  return vertices;
}

Result<void> read_create_placing(const Object& object, CreateTin& create) {
  if (const auto member = object.find("resolution")) {
    auto resolution = read_resolution(*member);
    if (!resolution) return std::move(resolution).error();
    create.resolution = *resolution;
  }
  if (const auto member = object.find("origin")) {
    auto origin = read_numbers<2>(*member);
    if (!origin) return std::move(origin).error();
    create.origin = Position2{(*origin)[0], (*origin)[1]};
  }
  if (const auto member = object.find("verticalUnit")) {
    const auto text = member->string(kMaxUnit);
    if (!text) return text.error();
    create.vertical_unit = std::string(*text);
  }
  if (const auto member = object.find("duplicates")) {
    auto text = member->string(kMaxWord);
    if (!text) return std::move(text).error();
    auto duplicates = parse_duplicates(*text, member->pointer());
    if (!duplicates) return std::move(duplicates).error();
    create.duplicates = *duplicates;
  }
  return {};
}

Result<std::vector<Position2>> read_positions(Value value, std::size_t most) {
  auto array = value.array(most);
  if (!array) return std::move(array).error();
  std::vector<Position2> positions;
  positions.reserve(array->size());
  for (const Value item : *array) {
    auto numbers = read_numbers<2>(item);
    if (!numbers) return std::move(numbers).error();
    positions.push_back({(*numbers)[0], (*numbers)[1]});
  }
  return positions;
}

Result<EditOp> read_remove_within(Value value, std::size_t most_positions) {
  auto object = value.object({"op", "polygon"});
  if (!object) return std::move(object).error();
  auto member = object->require("polygon");
  if (!member) return std::move(member).error();
  auto polygon = read_positions(*member, most_positions);
  if (!polygon) return std::move(polygon).error();
  if (polygon->size() < 3)
    return member->error(Code::kInvalidValue, "a polygon has at least three positions");
  return EditOp(RemoveWithinOp{std::move(*polygon)});
}

Result<EditOp> read_op_named(std::string_view op, Value op_name, Value value, const EditLimits& limits) {
  const auto read = [&](std::initializer_list<std::string_view> names, auto make) -> Result<EditOp> {
    auto object = value.object(names);
    if (!object) return std::move(object).error();
    Members members(*object);
    EditOp made = make(members);
    if (auto done = members.done(); !done) return std::move(done).error();
    return made;
  };
  // Braces fix the order of evaluation: the first wrong member is the one that is named.
  if (op == "insert") {
    return read({"op", "x", "y", "z"}, [](Members& m) -> EditOp {
      return InsertOp{m.number("x"), m.number("y"), m.number("z")};
    });
  }
  if (op == "remove") {
    return read({"op", "id"}, [](Members& m) -> EditOp { return RemoveOp{m.id("id")}; });
  }
  if (op == "move") {
    return read({"op", "id", "x", "y"}, [](Members& m) -> EditOp {
      return MoveOp{m.id("id"), m.number("x"), m.number("y")};
    });
  }
  if (op == "set-z") {
    return read({"op", "id", "z"}, [](Members& m) -> EditOp { return SetZOp{m.id("id"), m.number("z")}; });
  }
  if (op == "remove-within") return read_remove_within(value, limits.polygon_positions);
  return op_name.error(Code::kInvalidValue,
                       "there is no op \"" + utf8_prefix(op, 32) +
                           "\"; there are insert, remove, move, set-z and remove-within");
}

Result<EditOp> read_op(Value value, const EditLimits& limits) {
  auto object = value.any_object();
  if (!object) return std::move(object).error();
  auto member = object->require("op");
  if (!member) return std::move(member).error();
  auto name = member->string(kMaxWord);
  if (!name) return std::move(name).error();
  return read_op_named(*name, *member, value, limits);
}

}  // namespace

bool is_tin_id(std::string_view id) {
  return !id.empty() && id.size() <= kMaxTinId && is_alphanumeric(id.front()) &&
         std::all_of(id.begin(), id.end(), [](char c) { return is_alphanumeric(c) || c == '_' || c == '-'; });
}

Result<void> check_remark(const Remark& remark, std::string author_where, std::string note_where) {
  const auto check = [](std::string_view text, std::size_t most, std::string where) -> Result<void> {
    if (text.size() > most)
      return error(Code::kTooLarge, "there must be at most " + std::to_string(most) + " bytes here", std::move(where));
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t length = utf8_length(text.substr(at));
      if (length == 0) return error(Code::kInvalidValue, "there must be UTF-8 here", std::move(where));
      const auto byte = static_cast<unsigned char>(text[at]);
      if (byte < 0x20 && byte != '\n' && byte != '\t')
        return error(Code::kInvalidValue, "there must be no control characters here", std::move(where));
      at += length;
    }
    return {};
  };
  if (auto fine = check(remark.author, kMaxAuthor, std::move(author_where)); !fine) return fine;
  return check(remark.note, kMaxNote, std::move(note_where));
}

Result<Remark> read_remark(const Object& object) {
  Remark remark;
  std::string author_where, note_where;
  for (const auto& [name, most, text, where] :
       {std::tuple("author", kMaxAuthor, &remark.author, &author_where),
        std::tuple("note", kMaxNote, &remark.note, &note_where)}) {
    const auto member = object.find(name);
    if (!member) continue;
    auto given = member->string(most);
    if (!given) return std::move(given).error();
    *text = *given;
    *where = member->pointer();
  }
  if (auto fine = check_remark(remark, author_where, note_where); !fine) return std::move(fine).error();
  return remark;
}

Result<void> check_title(std::string_view title, std::string where) {
  if (title.size() > kMaxTitle) {
    return error(Code::kTooLarge, "a title has at most " + std::to_string(kMaxTitle) + " bytes",
                 std::move(where));
  }
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::any_of(title.begin(), title.end(), is_control)) {
    return error(Code::kInvalidValue, "a title has no control characters", std::move(where));
  }
  return {};
}

Result<Duplicates> parse_duplicates(std::string_view text, std::string where) {
  static constexpr std::pair<std::string_view, Duplicates> kPolicies[] = {
      {"replace", Duplicates::kReplace}, {"keep", Duplicates::kKeep}, {"mean", Duplicates::kMean},
      {"max", Duplicates::kMax},         {"min", Duplicates::kMin},   {"reject", Duplicates::kReject},
  };
  for (const auto& [name, policy] : kPolicies) {
    if (text == name) return policy;
  }
  return error(Code::kInvalidValue, "duplicates is one of replace, keep, mean, max, min and reject",
               std::move(where));
}

Result<Voids> parse_voids(std::string_view text, std::string where) {
  if (text == "keep") return Voids::kKeep;
  if (text == "fill") return Voids::kFill;
  return error(Code::kInvalidValue, "voids is keep or fill", std::move(where));
}

Result<tin::query::Interpolation> parse_interpolation(std::string_view text, std::string where) {
  if (text == "linear") return tin::query::Interpolation::kLinear;
  if (text == "natural-neighbour") return tin::query::Interpolation::kNaturalNeighbour;
  return error(Code::kInvalidValue, "The interpolations are linear and natural-neighbour.", std::move(where));
}

Result<CreateTin> read_create_tin(std::string_view body, std::size_t max_vertices) {
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  auto object = document->root().object(
      {"id", "title", "crs", "resolution", "origin", "verticalUnit", "duplicates", "vertices"});
  if (!object) return std::move(object).error();
  CreateTin create;
  auto id = read_optional_tin_id(*object, "id");
  if (!id) return std::move(id).error();
  create.id = std::move(*id);
  auto title = read_title(*object);
  if (!title) return std::move(title).error();
  create.title = std::move(*title);
  auto crs = read_crs(*object);
  if (!crs) return std::move(crs).error();
  create.crs = std::move(*crs);
  if (auto placed = read_create_placing(*object, create); !placed) return std::move(placed).error();
  if (const auto member = object->find("vertices")) {
    auto vertices = read_vertices(*member, max_vertices);
    if (!vertices) return std::move(vertices).error();
    create.vertices = std::move(*vertices);
  }
  return create;
}

Result<EditRequest> read_edit_request(std::string_view body, const EditLimits& limits) {
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  auto object = document->root().object({"ops", "crs", "author", "note"});
  if (!object) return std::move(object).error();
  EditRequest request;
  auto crs = read_crs(*object);
  if (!crs) return std::move(crs).error();
  request.crs = std::move(*crs);
  auto remark = read_remark(*object);
  if (!remark) return std::move(remark).error();
  request.remark = std::move(*remark);
  auto member = object->require("ops");
  if (!member) return std::move(member).error();
  auto ops = member->array(limits.ops);
  if (!ops) return std::move(ops).error();
  request.ops.reserve(ops->size());
  std::size_t areas = 0;
  for (const Value item : *ops) {
    auto op = read_op(item, limits);
    if (!op) return std::move(op).error();
    if (std::holds_alternative<RemoveWithinOp>(*op) && ++areas > limits.areas) {
      return item.error(Code::kTooLarge, "a request may have at most " + std::to_string(limits.areas) +
                                             " operations that concern an area");
    }
    request.ops.push_back(std::move(*op));
  }
  return request;
}

Result<ElevationRequest> read_elevation_request(std::string_view body, std::size_t max_positions) {
  auto document = Document::parse(body);
  if (!document) return std::move(document).error();
  auto object = document->root().object({"positions", "crs", "voids", "interpolation"});
  if (!object) return std::move(object).error();
  ElevationRequest request;
  auto crs = read_crs(*object);
  if (!crs) return std::move(crs).error();
  request.crs = std::move(*crs);
  if (const auto member = object->find("voids")) {
    auto text = member->string(kMaxWord);
    if (!text) return std::move(text).error();
    auto voids = parse_voids(*text, member->pointer());
    if (!voids) return std::move(voids).error();
    request.voids = *voids;
  }
  if (const auto member = object->find("interpolation")) {
    auto text = member->string(kMaxWord);
    if (!text) return std::move(text).error();
    auto by = parse_interpolation(*text, member->pointer());
    if (!by) return std::move(by).error();
    request.interpolation = *by;
  }
  auto member = object->require("positions");
  if (!member) return std::move(member).error();
  auto positions = read_positions(*member, max_positions);
  if (!positions) return std::move(positions).error();
  request.positions = std::move(*positions);
  return request;
}

}  // namespace proto
