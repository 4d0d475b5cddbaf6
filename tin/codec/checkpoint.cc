#include "tin/codec/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tin/base/check.h"
#include "tin/codec/bytes_internal.h"
#include "tin/exact/predicates.h"

namespace tin::codec {
namespace {

using terrain::Amendments;
using terrain::EditedTriangle;
using terrain::OwnSample;
using terrain::SourceGrid;
using terrain::SourceKind;

constexpr std::string_view kMagic = "TNSC";
constexpr std::uint16_t kVersion = 3;
constexpr std::uint16_t kPlainVersion = 1;   // without amendments
constexpr std::uint16_t kUntoldVersion = 2;  // amendments that do not tell which edit made them
constexpr std::size_t kSmallestPosition = 2;
constexpr std::size_t kSmallestTriangle = 3 * kSmallestPosition + 1;
constexpr std::size_t kSmallestDeed = 1 + 8 + 1 + 1;
constexpr std::size_t kSmallestOwn = kSmallestPosition + 8;
constexpr std::size_t kSmallestVertex = 1 + (1 + 1 + 8);  // id, placement
constexpr std::uint8_t kDuplicatePolicies = 6;

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

bool sound(const frame::Axis& axis) {
  return std::isfinite(axis.origin) && positive(axis.unit) && axis.parts > 0;
}

// Everything about a grid but its mask: asked before centre() or the number of pixels is computed from it.
bool sound_geometry(const SourceGrid& grid) {
  if (grid.width < 1 || grid.height < 1 || grid.dx < 1 || grid.dy == 0) return false;
  if (std::int64_t{grid.width} * grid.height > kMaxGridPixels) return false;
  const std::int64_t last_x = grid.x0 + std::int64_t{grid.width - 1} * grid.dx;
  const std::int64_t last_y = grid.y0 + std::int64_t{grid.height - 1} * grid.dy;
  return exact::in_lattice(grid.x0, grid.y0) && exact::in_lattice(last_x, last_y);
}

std::size_t pixels(const SourceGrid& grid) {
  return static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
}

std::size_t mask_words(const SourceGrid& grid) {
  return (pixels(grid) + 63) / 64;
}

void write_axis(Writer& out, const frame::Axis& axis) {
  TIN_CHECK(sound(axis));
  out.f64(axis.origin);
  out.f64(axis.unit);
  out.varint(static_cast<std::uint64_t>(axis.parts));
}

frame::Axis read_axis(Reader& in) {
  frame::Axis axis;
  axis.origin = in.f64();
  axis.unit = in.f64();
  axis.parts = static_cast<std::int64_t>(in.varint());
  in.require(sound(axis), "an axis of the frame makes no sense");
  return axis;
}

void write_frame(Writer& out, const frame::Frame& frame) {
  TIN_CHECK(positive(frame.vertical_unit_m));
  out.text(frame.crs);
  write_axis(out, frame.x);
  write_axis(out, frame.y);
  out.text(frame.vertical_unit);
  out.f64(frame.vertical_unit_m);
}

frame::Frame read_frame(Reader& in) {
  frame::Frame frame;
  frame.crs = in.text();
  frame.x = read_axis(in);
  frame.y = read_axis(in);
  frame.vertical_unit = in.text();
  frame.vertical_unit_m = in.f64();
  in.require(positive(frame.vertical_unit_m), "the vertical unit makes no sense");
  return frame;
}

std::array<double, 2> read_open_resolution(Reader& in, terrain::VertexId next_id) {
  std::array<double, 2> resolution{};
  for (double& value : resolution) {
    value = in.f64();
    in.require(std::isfinite(value) && value >= 0, "the resolution of an open frame makes no sense");
  }
  in.require(next_id.value() == 1, "the frame of a terrain that had vertices is open");
  return resolution;
}

void write_vertices(Writer& out, const Checkpoint& checkpoint) {
  out.varint(checkpoint.vertices.size());
  std::uint64_t previous = 0;
  for (const terrain::Vertex& vertex : checkpoint.vertices) {
    TIN_CHECK(vertex.id.value() > previous);
    out.varint(vertex.id.value() - previous);
    out.placement({vertex.at, vertex.z});
    previous = vertex.id.value();
  }
  TIN_CHECK(previous < checkpoint.next_id.value());
}

std::vector<terrain::Vertex> read_vertices(Reader& in, terrain::VertexId next_id) {
  const std::size_t count = in.count(kSmallestVertex);
  std::vector<terrain::Vertex> vertices;
  vertices.reserve(count);
  std::uint64_t previous = 0;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const std::uint64_t step = in.varint();
    in.require(step >= 1 && step < next_id.value() - previous,
               "vertex ids do not ascend, or pass the next id");
    const terrain::Placement placement = in.placement();
    if (!in.ok()) break;
    previous += step;
    vertices.push_back({terrain::VertexId(previous), placement.at, placement.z});
  }
  return vertices;
}

// Run lengths, in turn of valid and of void pixels.
void write_mask(Writer& out, const SourceGrid& grid) {
  TIN_CHECK(grid.valid.size() == mask_words(grid));
  const std::size_t total = pixels(grid);
  bool value = true;
  std::uint64_t run = 0;
  for (std::size_t bit = 0; bit < total; ++bit) {
    if ((((grid.valid[bit / 64] >> (bit % 64)) & 1U) != 0) == value) {
      ++run;
      continue;
    }
    out.varint(run);
    value = !value;
    run = 1;
  }
  out.varint(run);
}

void set_bits(std::vector<std::uint64_t>& words, std::size_t begin, std::size_t end) {
  while (begin < end) {
    const std::size_t in_word = begin % 64;
    const std::size_t bits = std::min(std::size_t{64} - in_word, end - begin);
    words[begin / 64] |= (~std::uint64_t{0} >> (64 - bits)) << in_word;
    begin += bits;
  }
}

std::vector<std::uint64_t> read_mask(Reader& in, const SourceGrid& grid) {
  if (!in.ok()) return {};
  const std::size_t total = pixels(grid);
  std::vector<std::uint64_t> words(mask_words(grid));
  bool value = true;
  for (std::size_t done = 0; done < total && in.ok();) {
    const std::uint64_t run = in.varint();
    in.require(run <= total - done && (run > 0 || (value && done == 0)),
               "the runs of the mask make no sense");
    if (!in.ok()) break;
    if (value) set_bits(words, done, done + run);
    done += run;
    value = !value;
  }
  return words;
}

void write_grid(Writer& out, const SourceGrid& grid) {
  TIN_CHECK(sound_geometry(grid));
  out.varint(static_cast<std::uint64_t>(grid.width));
  out.varint(static_cast<std::uint64_t>(grid.height));
  for (const std::int32_t value : {grid.x0, grid.y0, grid.dx, grid.dy}) out.zigzag(value);
  for (const double value : grid.geotransform) out.f64(value);
  out.u8(grid.nodata ? 1 : 0);
  if (grid.nodata) out.f64(*grid.nodata);
  out.text(grid.data_type);
  out.u8(grid.valid.empty() ? 0 : 1);
  if (!grid.valid.empty()) write_mask(out, grid);
}

bool read_flag(Reader& in) {
  const std::uint8_t flag = in.u8();
  in.require(flag <= 1, "a flag is neither 0 nor 1");
  return flag == 1;
}

template <class Read>
std::int32_t read_int32(Reader& in, Read read) {
  const auto value = (in.*read)();
  const bool fits = std::in_range<std::int32_t>(value);
  in.require(fits, "a number of the grid is too large");
  return fits ? static_cast<std::int32_t>(value) : 0;
}

SourceGrid read_grid(Reader& in) {
  SourceGrid grid;
  grid.width = read_int32(in, &Reader::varint);
  grid.height = read_int32(in, &Reader::varint);
  for (std::int32_t* value : {&grid.x0, &grid.y0, &grid.dx, &grid.dy})
    *value = read_int32(in, &Reader::zigzag);
  if (in.ok()) in.require(sound_geometry(grid), "the grid is empty, too large or outside the lattice");
  for (double& value : grid.geotransform) value = in.f64();
  if (read_flag(in)) grid.nodata = in.f64();
  grid.data_type = in.text();
  if (read_flag(in)) grid.valid = read_mask(in, grid);
  return grid;
}

void write_amendments(Writer& out, const Amendments& amendments) {
  const Amendments::Parts parts = amendments.parts();
  out.u8(static_cast<std::uint8_t>(parts.kind));
  out.u8(parts.thinned ? 1 : 0);
  out.varint(parts.next_deed);
  out.varint(parts.deeds.size());
  for (const terrain::Deed& deed : parts.deeds) {
    out.varint(deed.number);
    out.u64(deed.fingerprint);
    out.varint(deed.triangles);
    out.u8(deed.shrank ? 1 : 0);
  }
  out.varint(parts.touches.size());
  for (const terrain::Touch& touch : parts.touches) {
    out.at(touch.at);
    out.varint(touch.deed);
  }
  out.varint(parts.areas.size());
  for (const EditedTriangle& t : parts.areas) {
    for (const exact::Point p : t.corners) out.at(p);
    out.u8(t.inner);
  }
  out.varint(parts.own.size());
  for (const OwnSample& one : parts.own) {
    out.placement(one.sample);
    out.varint(one.maker);
  }
}

std::vector<terrain::Deed> read_deeds(Reader& in, std::uint64_t next_deed) {
  std::vector<terrain::Deed> deeds(in.count(kSmallestDeed));
  std::uint64_t before = 0;
  for (terrain::Deed& deed : deeds) {
    if (!in.ok()) break;
    deed.number = in.varint();
    in.require(deed.number > before && deed.number < next_deed, "the numbers of edits make no sense");
    before = deed.number;
    deed.fingerprint = in.u64();
    deed.triangles = in.varint();
    deed.shrank = read_flag(in);
  }
  return deeds;
}

/// That of an edit which stands, or of none.
terrain::DeedNumber read_deed_number(Reader& in, const Amendments::Parts& parts) {
  if (in.version() == kUntoldVersion) return 0;
  const terrain::DeedNumber number = in.varint();
  const auto& deeds = parts.deeds;
  const auto deed = std::lower_bound(deeds.begin(), deeds.end(), number,
                                     [](const terrain::Deed& one, terrain::DeedNumber other) { return one.number < other; });
  in.require(number == 0 || (deed != deeds.end() && deed->number == number), "there is no edit of a number");
  return number;
}

void read_touches(Reader& in, Amendments::Parts& parts) {
  auto& touches = parts.touches;
  touches.resize(in.count(kSmallestPosition));
  for (std::size_t i = 0; i < touches.size() && in.ok(); ++i) {
    touches[i].at = in.at();
    touches[i].deed = read_deed_number(in, parts);
    if (i == 0) continue;
    const auto &a = touches[i - 1], &b = touches[i];
    in.require(a.at < b.at || (a.at == b.at && a.deed < b.deed), "touched positions do not ascend");
  }
}

void read_areas(Reader& in, Amendments::Parts& parts) {
  parts.areas.resize(in.count(kSmallestTriangle));
  for (EditedTriangle& t : parts.areas) {
    if (!in.ok()) break;
    for (exact::Point& p : t.corners) p = in.at();
    t.inner = in.u8();
    in.require(t.inner < 8 && exact::orientation(t.corners[0], t.corners[1], t.corners[2]) > 0,
               "an edited triangle makes no sense");
    if (in.version() == kUntoldVersion) t = with_least_first(t);
    in.require(t == with_least_first(t), "an edited triangle does not begin with its least corner");
  }
  std::uint64_t left = parts.areas.size();
  for (const terrain::Deed& deed : parts.deeds) {
    in.require(deed.triangles <= left, "there are fewer edited triangles than edits have");
    left -= std::min(left, deed.triangles);
  }
}

void read_own(Reader& in, Amendments::Parts& parts) {
  auto& own = parts.own;
  own.resize(in.count(kSmallestOwn));
  for (std::size_t i = 0; i < own.size() && in.ok(); ++i) {
    own[i].sample = in.placement();
    own[i].maker = read_deed_number(in, parts);
    if (i == 0) continue;
    const auto &a = own[i - 1], &b = own[i];
    in.require(a.sample.at < b.sample.at || (a.sample.at == b.sample.at && a.maker < b.maker),
               "people's samples do not ascend");
  }
}

Amendments read_amendments(Reader& in, const Checkpoint& checkpoint) {
  Amendments::Parts parts;
  const std::uint8_t kind = in.u8();
  in.require(kind <= static_cast<std::uint8_t>(SourceKind::kPoints), "an unknown kind of source");
  parts.kind = static_cast<SourceKind>(kind);
  in.require(parts.kind != SourceKind::kRaster || checkpoint.grid, "the source is a raster without a grid");
  parts.thinned = read_flag(in);
  if (in.version() != kUntoldVersion) {
    parts.next_deed = in.varint();
    in.require(parts.next_deed >= 1, "the next edit has no number");
    parts.deeds = read_deeds(in, parts.next_deed);
  }
  read_touches(in, parts);
  read_areas(in, parts);
  read_own(in, parts);
  Amendments amendments(std::move(parts));
  in.require(!(amendments == Amendments()), "amendments that are none");
  return amendments;
}

}  // namespace

std::string encode_checkpoint(const Checkpoint& checkpoint) {
  const bool plain = checkpoint.amendments == Amendments();
  Writer out(kMagic, plain ? kPlainVersion : kVersion);
  out.reserve(1024 + 16 * checkpoint.vertices.size());
  out.varint(checkpoint.revision);
  out.text(checkpoint.digest);
  TIN_CHECK(checkpoint.next_id.value() >= 1);
  out.varint(checkpoint.next_id.value());
  out.u8(static_cast<std::uint8_t>(checkpoint.duplicates));
  write_frame(out, checkpoint.frame);
  out.u8(checkpoint.open_resolution ? 1 : 0);
  if (checkpoint.open_resolution) {
    TIN_CHECK(checkpoint.next_id.value() == 1);
    for (const double resolution : *checkpoint.open_resolution) out.f64(resolution);
  }
  write_vertices(out, checkpoint);
  out.u8(checkpoint.grid ? 1 : 0);
  if (checkpoint.grid) write_grid(out, *checkpoint.grid);
  if (!plain) write_amendments(out, checkpoint.amendments);
  return out.finish();
}

base::Result<Checkpoint> decode_checkpoint(std::string_view bytes) {
  Reader in(bytes, kMagic, kVersion, "checkpoint");
  Checkpoint checkpoint;
  checkpoint.revision = in.varint();
  checkpoint.digest = in.text();
  checkpoint.next_id = terrain::VertexId(in.varint());
  in.require(checkpoint.next_id.value() >= 1, "the next vertex id is 0");
  const std::uint8_t duplicates = in.u8();
  in.require(duplicates < kDuplicatePolicies, "an unknown policy for duplicates");
  checkpoint.duplicates = static_cast<terrain::Duplicates>(duplicates);
  checkpoint.frame = read_frame(in);
  if (read_flag(in)) checkpoint.open_resolution = read_open_resolution(in, checkpoint.next_id);
  checkpoint.vertices = read_vertices(in, checkpoint.next_id);
  if (read_flag(in)) checkpoint.grid = std::make_shared<const SourceGrid>(read_grid(in));
  if (in.version() != kPlainVersion) checkpoint.amendments = read_amendments(in, checkpoint);
  in.finish();
  if (!in.ok()) return in.error();
  return checkpoint;
}

}  // namespace tin::codec
