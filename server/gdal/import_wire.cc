#include "server/gdal/import_wire.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

#include "tin/exact/point.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Progress;
using tin::base::Result;
using tin::terrain::Placement;
using tin::terrain::SourceGrid;

constexpr char kProgress = 'P', kHead = 'H', kPlacements = 'V', kMask = 'G', kHeights = 'S', kRows = 'R',
               kError = 'E', kEnd = 'Z';
constexpr std::size_t kFrameHead = 5;  // the kind, and the length in four bytes
constexpr std::size_t kMostFrameBytes = std::size_t{1} << 20;
constexpr std::size_t kMostTextBytes = 64 * 1024;
constexpr std::size_t kHeightsAtOnce =
    tin::base::kPaceBytes / sizeof(double);  // between two words about them
static_assert(std::is_trivially_copyable_v<Placement> && sizeof(Placement) == 16);

tin::base::Error nonsense() {
  return error(Code::kMalformed, "The decoder of the file sent what makes no sense");
}

/// Both ends are the same program on the same machine, so numbers travel as they are.
class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    const auto size = static_cast<std::uint32_t>(std::min(text.size(), kMostTextBytes));
    put(size);
    bytes_.append(text, 0, size);
  }
  void put(const std::vector<std::uint8_t>& bytes) { put(std::string(bytes.begin(), bytes.end())); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what a Writer wrote; after the first thing that does not fit it gives zeros and is not good().
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  void get(T& value) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    value = {};
    if ((good_ = good_ && bytes_.size() >= sizeof value)) {
      std::memcpy(&value, bytes_.data(), sizeof value);
      bytes_.remove_prefix(sizeof value);
    }
  }
  void get(bool& truth) {
    char value = 0;
    get(value);
    truth = value != 0;
  }
  void get(std::string& text) {
    std::uint32_t size = 0;
    get(size);
    if ((good_ = good_ && size <= kMostTextBytes && size <= bytes_.size())) {
      text.assign(bytes_.substr(0, size));
      bytes_.remove_prefix(size);
    }
  }
  void get(std::vector<std::uint8_t>& bytes) {
    std::string text;
    get(text);
    bytes.assign(text.begin(), text.end());
  }
  bool good() const { return good_; }
  bool done() const { return good_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool good_ = true;
};

bool send_frame(char kind, std::string_view body, const Sink& sink) {
  std::string head(1, kind);
  const auto size = static_cast<std::uint32_t>(body.size());
  head.append(reinterpret_cast<const char*>(&size), sizeof size);
  return sink(head) && (body.empty() || sink(body));
}

/// Sends an array in as many frames as it takes.
template <class T>
bool send_array(char kind, std::span<const T> items, const Sink& sink) {
  const std::size_t at_once = kMostFrameBytes / sizeof(T);
  for (std::size_t i = 0; i < items.size(); i += at_once) {
    const std::size_t count = std::min(at_once, items.size() - i);
    if (!send_frame(kind, {reinterpret_cast<const char*>(&items[i]), count * sizeof(T)}, sink)) return false;
  }
  return true;
}

/// One list of members for both directions. A structured binding names them all, so that a member which is
/// added there does not compile until it travels, too.
template <class Options, class Visit>
void visit_options(Options& options, Visit visit) {
  auto& [file_name, content_type, format, crs, resolution_x, resolution_y, layer, z_field, classes, max_samples,
         max_pixels, max_unpacked_bytes, heights_only, memory, look] = options;
  static_cast<void>(memory), static_cast<void>(look);  // each end has its own
  visit(file_name), visit(content_type), visit(format), visit(crs);
  visit(resolution_x), visit(resolution_y), visit(layer), visit(z_field);
  visit(classes), visit(max_samples), visit(max_pixels), visit(max_unpacked_bytes), visit(heights_only);
}

template <class Frame, class Visit>
void visit_frame(Frame& frame, Visit visit) {
  auto& [crs, x, y, vertical_unit, vertical_unit_m] = frame;
  visit(crs), visit(vertical_unit), visit(vertical_unit_m);
  for (auto* axis : {&x, &y}) visit(axis->origin), visit(axis->unit), visit(axis->parts);
}

/// All of a grid but its mask.
template <class Grid, class Visit>
void visit_grid(Grid& grid, double& nodata, char& has_nodata, Visit visit) {
  auto& [width, height, x0, y0, dx, dy, geotransform, nodata_member, data_type, valid] = grid;
  static_cast<void>(nodata_member);
  static_cast<void>(valid);
  visit(width), visit(height), visit(x0), visit(y0), visit(dx), visit(dy);
  for (auto& number : geotransform) visit(number);
  visit(has_nodata), visit(nodata), visit(data_type);
}

bool finite(double value) {
  return std::isfinite(value);
}

bool sound(const tin::frame::Frame& frame) {
  const auto sound_axis = [](const tin::frame::Axis& axis) {
    return finite(axis.origin) && finite(axis.unit) && axis.unit > 0 && axis.parts > 0;
  };
  return sound_axis(frame.x) && sound_axis(frame.y) && finite(frame.vertical_unit_m) &&
         frame.vertical_unit_m > 0;
}

/// Whether pixel centres lie on the lattice and the pixels are within the limit.
bool sound(const SourceGrid& grid, std::uint64_t max_pixels) {
  if (grid.width <= 0 || grid.height <= 0 || grid.dx <= 0 || grid.dy == 0) return false;
  if (static_cast<std::uint64_t>(grid.width) * static_cast<std::uint64_t>(grid.height) > max_pixels)
    return false;
  const auto on_lattice = [](std::int64_t v) {
    return v >= -tin::exact::kLatticeHalf && v < tin::exact::kLatticeHalf;
  };
  const std::int64_t x1 = grid.x0 + std::int64_t{grid.width - 1} * grid.dx;
  const std::int64_t y1 = grid.y0 + std::int64_t{grid.height - 1} * grid.dy;
  return on_lattice(grid.x0) && on_lattice(grid.y0) && on_lattice(x1) && on_lattice(y1) &&
         std::all_of(grid.geotransform.begin(), grid.geotransform.end(), finite);
}

/// Makes the array of that kind, empty. False if there is no such kind or the shift is out of all reason.
bool choose_kind(tin::terrain::SourceSamples::Heights& heights, char kind, std::pmr::memory_resource* memory) {
  constexpr int kMostShift = 60;
  if (heights.shift < -kMostShift || heights.shift > kMostShift) return false;
  switch (kind) {
    case 0:
      heights.stored.emplace<0>(memory);
      return true;
    case 1:
      heights.stored.emplace<1>(memory);
      return true;
    case 2:
      heights.stored.emplace<2>(memory);
      return true;
    case 3:
      heights.stored.emplace<3>(memory);
      return true;
    default:
      return false;
  }
}
static_assert(std::variant_size_v<decltype(tin::terrain::SourceSamples::Heights::stored)> == 4);

/// Whether every pixel that counts as a sample has a height.
bool sound_heights(const Import& import) {
  if (import.heights.stored.index() < 2) return true;  // whole numbers
  const std::size_t count = import.heights.size();
  const tin::base::Pace pace(import.heights.memory());
  for (std::size_t i = 0; i < count; ++i) {
    const auto& valid = import.grid->valid;
    if (i % kHeightsAtOnce == 0) pace.touched(1, kHeightsAtOnce * sizeof(double));
    const bool is_sample = valid.empty() || ((valid[i / 64] >> (i % 64)) & 1U) != 0;
    if (is_sample && !finite(import.heights.at(i))) return false;
  }
  return true;
}

}  // namespace

std::string encode_options(const ImportOptions& options) {
  Writer out;
  visit_options(options, [&](const auto& member) { out.put(member); });
  return out.take();
}

Result<ImportOptions> decode_options(std::string_view bytes) {
  ImportOptions options;
  Reader in(bytes);
  visit_options(options, [&](auto& member) { in.get(member); });
  if (!in.done()) return error(Code::kMalformed, "The order to the decoder cannot be read");
  return options;
}

bool send_progress(double fraction, const Sink& sink) {
  Writer out;
  out.put(fraction);
  return send_frame(kProgress, out.take(), sink);
}

namespace {

bool send_head(const Import& import, bool in_rows, const Sink& sink) {
  const auto& [frame, placements, grid, heights, driver, bands] = import;
  Writer out;
  const auto put = [&](const auto& member) { out.put(member); };
  visit_frame(frame, put);
  out.put(driver);
  out.put(bands);
  out.put(std::uint64_t{placements.size()});
  out.put(static_cast<char>(heights.stored.index()));
  out.put(heights.shift);
  out.put(std::uint64_t{heights.size()});
  out.put(static_cast<char>(in_rows));
  out.put(static_cast<char>(grid != nullptr));
  if (grid) {
    char has_nodata = grid->nodata.has_value() ? 1 : 0;
    double nodata = grid->nodata.value_or(0);
    visit_grid(*grid, nodata, has_nodata, put);
    out.put(std::uint64_t{grid->valid.size()});
  }
  return send_frame(kHead, out.take(), sink);
}

}  // namespace

bool send_import(const Import& import, const Sink& sink) {
  const auto& [frame, placements, grid, heights, driver, bands] = import;
  return send_head(import, false, sink) && send_array(kPlacements, std::span(placements), sink) &&
         (!grid || send_array(kMask, std::span(std::as_const(grid->valid)), sink)) &&
         std::visit([&](const auto& numbers) { return send_array(kHeights, std::span(numbers), sink); },
                    heights.stored) &&
         send_end(sink);
}

bool send_beginning(const Import& import, const Sink& sink) {
  return send_head(import, true, sink);
}

bool send_rows(std::span<const double> heights, const Sink& sink) {
  return send_array(kRows, heights, sink);
}

bool send_end(const Sink& sink) {
  return send_frame(kEnd, {}, sink);
}

bool send_error(const tin::base::Error& problem, const Sink& sink) {
  Writer out;
  out.put(static_cast<std::uint32_t>(problem.code));
  out.put(problem.message);
  out.put(problem.where);
  return send_frame(kError, out.take(), sink);
}

ImportReceiver::ImportReceiver(const ImportOptions& limits, Progress* progress)
    : max_samples_(limits.max_samples),
      max_pixels_(limits.max_pixels),
      memory_(limits.memory),
      progress_(progress) {}

ImportReceiver::~ImportReceiver() = default;

Result<void> ImportReceiver::take(std::string_view bytes) {
  pending_.append(bytes);
  std::size_t used = 0;
  while (pending_.size() - used >= kFrameHead) {
    const std::string_view rest = std::string_view(pending_).substr(used);
    std::uint32_t size = 0;
    std::memcpy(&size, rest.data() + 1, sizeof size);
    if (size > kMostFrameBytes || whole()) return nonsense();
    if (rest.size() - kFrameHead < size) break;
    if (auto fine = take_frame(rest[0], rest.substr(kFrameHead, size)); !fine) return fine;
    used += kFrameHead + size;
  }
  pending_.erase(0, used);
  return {};
}

Result<Import> ImportReceiver::outcome() && {
  TIN_CHECK(whole());
  return *std::move(outcome_);
}

Result<void> ImportReceiver::take_frame(char kind, std::string_view body) {
  if (kind == kProgress) {
    double fraction = 0;
    Reader in(body);
    in.get(fraction);
    if (!in.done() || !(fraction >= 0 && fraction <= 1)) return nonsense();
    if (progress_ != nullptr) progress_->report(fraction);
    return {};
  }
  if (kind == kError) return take_error(body);
  if (kind == kHead && !import_) return take_head(body);
  if (!import_) return nonsense();
  if (kind == kPlacements) return take_placements(body);
  if (kind == kMask) return take_mask(body);
  if (kind == kHeights) return take_heights(body);
  if (kind == kRows) return take_rows(body);
  return kind == kEnd && body.empty() ? conclude() : nonsense();
}

Result<void> ImportReceiver::take_head(std::string_view body) {
  Import import;
  Reader in(body);
  const auto get = [&](auto& member) { in.get(member); };
  visit_frame(import.frame, get);
  in.get(import.driver);
  in.get(import.bands);
  in.get(placements_);
  char kind_of_heights = 0;
  in.get(kind_of_heights);
  in.get(import.heights.shift);
  in.get(heights_);
  char in_rows = 0;
  in.get(in_rows);
  if (!in.good() || !choose_kind(import.heights, kind_of_heights, memory_)) return nonsense();
  char has_grid = 0;
  in.get(has_grid);
  if (has_grid != 0) {
    auto grid = std::make_shared<SourceGrid>();
    char has_nodata = 0;
    double nodata = 0;
    visit_grid(*grid, nodata, has_nodata, get);
    in.get(mask_words_);
    if (has_nodata != 0) grid->nodata = nodata;
    if (!in.good() || !sound(*grid, max_pixels_)) return nonsense();
    const auto pixels = static_cast<std::uint64_t>(grid->width) * static_cast<std::uint64_t>(grid->height);
    if (mask_words_ != 0 && mask_words_ != (pixels + 63) / 64) return nonsense();
    if (heights_ != 0 && heights_ != pixels) return nonsense();
    grid->valid.reserve(mask_words_);
    if (in_rows != 0) {
      if (heights_ != 0 || mask_words_ != 0) return nonsense();
      heights_ = pixels;
      grid->valid.assign((pixels + 63) / 64, 0);
    }
    import.grid = std::move(grid);
  }
  if (!in.done() || !sound(import.frame) || placements_ > max_samples_) return nonsense();
  if (heights_ != 0 && !import.grid) return nonsense();
  import.placements.reserve(placements_);
  if (in_rows != 0) {
    if (!import.grid || placements_ != 0) return nonsense();
    rows_.emplace(heights_, memory_);
    import_ = std::move(import);
    return {};
  }
  std::visit([this](auto& numbers) { numbers.reserve(heights_); }, import.heights.stored);
  import_ = std::move(import);
  return {};
}

Result<void> ImportReceiver::take_placements(std::string_view body) {
  auto& placements = import_->placements;
  const std::size_t count = body.size() / sizeof(Placement);
  if (body.size() % sizeof(Placement) != 0 || count > placements_ - placements.size()) return nonsense();
  const std::size_t before = placements.size();
  placements.resize(before + count);
  std::memcpy(static_cast<void*>(placements.data() + before), body.data(), body.size());
  const bool good =
      std::all_of(placements.begin() + static_cast<std::ptrdiff_t>(before), placements.end(),
                  [](const Placement& p) { return tin::exact::in_lattice(p.at.x, p.at.y) && finite(p.z); });
  if (!good) return nonsense();
  return {};
}

Result<void> ImportReceiver::take_mask(std::string_view body) {
  if (!import_->grid) return nonsense();
  auto& valid = import_->grid->valid;
  const std::size_t count = body.size() / sizeof(std::uint64_t);
  if (rows_ || body.size() % sizeof(std::uint64_t) != 0 || count > mask_words_ - valid.size())
    return nonsense();
  const std::size_t before = valid.size();
  valid.resize(before + count);
  std::memcpy(valid.data() + before, body.data(), body.size());
  return {};
}

Result<void> ImportReceiver::take_rows(std::string_view body) {
  if (!rows_ || body.size() % sizeof(double) != 0 || body.size() / sizeof(double) > heights_ - rows_->size())
    return nonsense();
  auto& valid = import_->grid->valid;
  for (; !body.empty(); body.remove_prefix(sizeof(double))) {
    double height = 0;
    std::memcpy(&height, body.data(), sizeof height);
    if (std::isnan(height)) {
      rows_->skip();
      continue;
    }
    if (!finite(height)) return nonsense();
    const std::size_t bit = rows_->size();
    rows_->add(height);
    valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
    ++valid_;
  }
  if (progress_ != nullptr)
    progress_->report(static_cast<double>(rows_->size()) / static_cast<double>(heights_));
  return {};
}

Result<void> ImportReceiver::take_heights(std::string_view body) {
  if (rows_) return nonsense();
  const bool taken = std::visit(
      [&](auto& numbers) {
        using Number = typename std::decay_t<decltype(numbers)>::value_type;
        const std::size_t before = numbers.size(), count = body.size() / sizeof(Number);
        if (body.size() % sizeof(Number) != 0 || count > heights_ - before) return false;
        numbers.resize(before + count);
        std::memcpy(numbers.data() + before, body.data(), body.size());
        tin::base::Pace(memory_).touched(1, body.size());
        return true;
      },
      import_->heights.stored);
  if (!taken) return nonsense();
  return {};
}

Result<void> ImportReceiver::take_error(std::string_view body) {
  std::uint32_t code = 0;
  tin::base::Error problem;
  Reader in(body);
  in.get(code);
  in.get(problem.message);
  in.get(problem.where);
  if (!in.done() || code > static_cast<std::uint32_t>(Code::kInternal)) return nonsense();
  problem.code = static_cast<Code>(code);
  outcome_ = Result<Import>(std::move(problem));
  return {};
}

Result<void> ImportReceiver::conclude() {
  if (rows_) {
    if (rows_->size() != heights_ || valid_ == 0) return nonsense();
    if (valid_ == heights_) import_->grid->valid.clear();
    import_->heights = std::move(*rows_).finish();
    outcome_ = Result<Import>(*std::move(import_));
    return {};
  }
  if (import_->placements.size() != placements_) return nonsense();
  if (import_->grid && import_->grid->valid.size() != mask_words_) return nonsense();
  if (import_->heights.size() != heights_ || !sound_heights(*import_)) return nonsense();
  outcome_ = Result<Import>(*std::move(import_));
  return {};
}

}  // namespace server::gdal
