// The samples that a TIN must stay close to, and the question that simplification asks all the time: how far
// are those over this triangle from it?
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tin/base/progress.h"
#include "tin/exact/point.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace tin::simplify {

/// Names a sample: an order that depends on the set of samples only, so that ties decided by it are
/// reproducible.
using SampleIndex = std::uint32_t;

/// A sample with all that scans want to know of it when it is a triangle's corner.
struct Site {
  exact::Point at;
  std::int32_t column = -1, row = -1;  // cell of the raster that it is the centre of; -1: none
  double z = 0;
  SampleIndex sample = 0;
};

/// What the samples over a triangle say.
struct Scan {
  double error = 0;        // largest vertical distance, rounded
  SampleIndex sample = 0;  // the one it belongs to, the first of equals; one over the tolerance if any is
  bool over = false;       // whether a sample is over the tolerance: exact
};

/// How much a scan should find out.
enum class Depth {
  kWorst,      // the worst sample
  kFirstOver,  // may stop once a sample is over the tolerance: `error` and `sample` are then any such
};

/// Where the samples lie.
struct Extent {
  terrain::Box box;
  std::int64_t step_x = 1, step_y = 1;  // lattice steps between neighbours in a raster; both 1 elsewhere
  std::size_t samples = 0;              // in a raster: cells, voids among them
};

/// Safe to be asked by several threads at once.
class Samples {
 public:
  virtual ~Samples() = default;

  /// Looks at all samples in the closed triangle. Requires: corners not collinear, tolerance finite and >= 0.
  /// A scan that is cancelled ends early with an answer of no worth: ask before using it.
  virtual Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const = 0;

  virtual Site site(SampleIndex sample) const = 0;
  /// Appends the sites of the samples from `begin` to before `end`.
  virtual void sites(SampleIndex begin, SampleIndex end, std::vector<Site>& out) const;
  virtual exact::Point position(SampleIndex sample) const = 0;
  /// The sample at `p`, if there is one.
  virtual std::optional<SampleIndex> find(exact::Point p) const = 0;
  /// One past the largest index. Not every index below it is a sample; neighbours in this order are often neighbours on
  /// the ground.
  virtual SampleIndex end() const = 0;
  virtual bool exists(SampleIndex sample) const = 0;

  /// The sample so many columns and rows from one on a raster; nothing where there is none.
  virtual std::optional<SampleIndex> neighbour(SampleIndex sample, std::int32_t columns, std::int32_t rows) const = 0;

  virtual Extent extent() const = 0;
  /// Appends samples of the closed box, among them all corners of their convex hull.
  virtual void outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const = 0;
};

/// The corners of the convex hull of the samples in the closed box; fewer than three when they are all in a line.
std::vector<SampleIndex> hull_corners(const Samples& samples, const terrain::Box& box);

/// The samples of `source`, those that are people's `own`, and the vertices of `terrain` where neither has a sample. `terrain` or
/// `source` may be null, not both. On the raster where most of them are, else as scattered points. Nothing when cancelled.
/// Borrows all. Requires: as simplify().
std::unique_ptr<Samples> make_samples(const terrain::Terrain* terrain, const terrain::SourceSamples* source,
                                      std::span<const terrain::Placement> own, base::Progress* progress);

}  // namespace tin::simplify
