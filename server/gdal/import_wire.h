// How a decoder process is told what to read, and how it tells what it found: frames of a kind, a length and
// bytes, on a pipe between two processes of one program. What comes from a decoder is checked like an upload,
// since a hostile file may have taken it over. For this folder and its tests only.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/gdal/import.h"
#include "tin/base/result.h"
#include "tin/terrain/heights_builder.h"

namespace server::gdal {

/// The order to a decoder, and back. Errors: kMalformed.
std::string encode_options(const ImportOptions& options);
tin::base::Result<ImportOptions> decode_options(std::string_view bytes);

/// Takes bytes in the order in which they are sent; false when nobody listens any more.
using Sink = std::function<bool(std::string_view bytes)>;

bool send_progress(double fraction, const Sink& sink);
bool send_import(const Import& import, const Sink& sink);
/// An import whose heights follow, row by row, and then its end.
bool send_beginning(const Import& import, const Sink& sink);
bool send_rows(std::span<const double> heights, const Sink& sink);
bool send_end(const Sink& sink);
bool send_error(const tin::base::Error& error, const Sink& sink);

/// Puts an import together from the bytes of its decoder, whatever they are: never more samples or pixels
/// than the limits, finite numbers, lattice points, a grid on the lattice.
class ImportReceiver {
 public:
  explicit ImportReceiver(const ImportOptions& limits, tin::base::Progress* progress);
  ~ImportReceiver();

  /// Takes what has arrived. Errors: kMalformed; then there is no use in going on.
  tin::base::Result<void> take(std::string_view bytes);

  /// The import or the decoder's error, once it is whole.
  bool whole() const { return outcome_.has_value(); }
  tin::base::Result<Import> outcome() &&;

 private:
  tin::base::Result<void> take_frame(char kind, std::string_view body);
  tin::base::Result<void> take_head(std::string_view body);
  tin::base::Result<void> take_placements(std::string_view body);
  tin::base::Result<void> take_mask(std::string_view body);
  tin::base::Result<void> take_heights(std::string_view body);
  tin::base::Result<void> take_rows(std::string_view body);
  tin::base::Result<void> take_error(std::string_view body);
  tin::base::Result<void> conclude();

  const std::uint64_t max_samples_, max_pixels_;
  std::pmr::memory_resource* const memory_;  // of heights
  tin::base::Progress* const progress_;
  std::string pending_;           // a frame that is not whole yet
  std::optional<Import> import_;  // since its head came
  std::uint64_t placements_ = 0;  // that the head promised
  std::uint64_t mask_words_ = 0;
  std::uint64_t heights_ = 0;
  std::optional<tin::terrain::HeightsBuilder> rows_;  // if the heights come row by row
  std::uint64_t valid_ = 0;                           // of these
  std::optional<tin::base::Result<Import>> outcome_;
};

}  // namespace server::gdal
