// Heights of a source, gathered one by one without a list of doubles.
//
//   HeightsBuilder builder(pixels);
//   for (double z : row) std::isnan(z) ? builder.skip() : builder.add(z);
//   auto source = SourceSamples::restored_raster(grid, std::move(builder).finish(), grid->valid);
#pragma once

#include <cstddef>
#include <memory_resource>

#include "tin/terrain/source_samples.h"

namespace tin::terrain {

/// Begins with 16-bit integers and goes to a wider form when a height does not fit the present one: amortised
/// O(1) each. Memory: the present form, and for a moment the next one beside it.
class HeightsBuilder {
 public:
  explicit HeightsBuilder(std::size_t expected,
                          std::pmr::memory_resource* memory = std::pmr::get_default_resource());

  /// Requires: finite.
  void add(double z);
  /// A height that means nothing, as of a void pixel.
  void skip();
  std::size_t size() const { return heights_.size(); }
  SourceSamples::Heights finish() && { return std::move(heights_); }

 private:
  bool try_add(double z);
  void widen();
  void note_one();

  std::size_t expected_;
  std::pmr::memory_resource* memory_;
  base::Pace pace_;
  std::size_t since_noted_ = 0;
  SourceSamples::Heights heights_;
};

}  // namespace tin::terrain
