// The samples that a TIN must stay close to, and the question that simplification asks all the time: how far
// are those over this triangle from it?
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "tin/base/progress.h"
#include "tin/exact/point.h"
#include "tin/simplify/footprint.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace tin::simplify {

/// Names a sample: an order that depends on the set of samples only, so that ties decided by it are
/// reproducible.
using SampleIndex = std::uint32_t;
inline constexpr SampleIndex kNoSample = std::numeric_limits<SampleIndex>::max();

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
  /// Where an edge of the samples' surface is what is worst, its other end: one of both is no vertex.
  SampleIndex other = kNoSample;
};

/// How much a scan should find out.
enum class Depth {
  kWorst,      // the worst sample
  kFirstOver,  // may stop once a sample is over the tolerance: `error` and `sample` are then any such
};

/// What the edges of the samples' surface say where they cross a segment.
struct EdgeScan {
  std::size_t crossings = 0;
  double error = 0;               // the largest, rounded
  SampleIndex from = 0, to = 0;   // the ends of the edge that it belongs to
  double along = 0;               // what part of the way from one to the other
  double height = 0;              // of the surface there
  bool over = false;              // whether any is over the tolerance: exact
};

/// Heights that a vertex may have.
struct Heights {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool any() const { return low <= high; }
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

  /// Narrows the heights of the corner `a` down to those that keep the samples over the triangle within the tolerance, up to
  /// rounding: whether they are, scan() knows. May stop once none is left. Requires: as scan().
  virtual void narrow(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const = 0;
  /// Looks at the crossings of the segment between two vertices with the samples' surface, if that counts.
  virtual EdgeScan scan_edge(const Site&, const Site&, double) const { return {}; }
  /// Whether it does: then a scan of a triangle looks at its sides as well.
  virtual bool has_surface() const { return false; }
  /// Whether no distance at all is allowed to a sample, whatever the tolerance.
  virtual bool is_level(SampleIndex) const { return false; }
  /// Whether a vertex there may have another height than the sample.
  virtual bool may_float(SampleIndex) const { return true; }

  /// Heights of corners are whole multiples of it; 0: they may be any.
  virtual double fineness() const { return 0; }
  /// Nor may their absolute values be above it.
  virtual double most() const { return std::numeric_limits<double>::max(); }

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
  virtual std::optional<Site> beside(const Site& sample, std::int32_t columns, std::int32_t rows) const = 0;
  /// Whether beside() knows any: on a raster with nothing beside it.
  virtual bool has_neighbours() const = 0;

  /// What notes the memory that work on them takes; null: nobody does.
  virtual Footprint* footprint() const { return nullptr; }

  virtual Extent extent() const = 0;
  /// Appends samples of the closed box, among them all corners of their convex hull.
  virtual void outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const = 0;
};

/// The corners of the convex hull of the samples in the closed box; fewer than three when they are all in a line.
std::vector<SampleIndex> hull_corners(const Samples& samples, const terrain::Box& box);

/// What is asked of samples beside a tolerance.
struct Demands {
  /// Corners of triangles need not be samples: they may have heights that are much finer than the samples'.
  bool any_height = false;
  /// Of plateaus with so many samples that are level with all around them, these must lie on the TIN; 0: none.
  std::size_t keep_flat = 0;
  /// The surface that the samples make counts, and not only they.
  bool surface = false;
  unsigned threads = 1;
  /// For what is as large as the raster.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  /// Notes all else that is large; null: nobody does.
  Footprint* footprint = nullptr;
};

/// The samples of `source`, those that are people's `own`, and the vertices of `terrain` where neither has a
/// sample. `terrain` or `source` may be null, not both. On the raster where most of them are, else as
/// scattered points. Nothing when cancelled or when there is no room. Borrows all. Requires: as simplify().
std::unique_ptr<Samples> make_samples(const terrain::Terrain* terrain, const terrain::SourceSamples* source,
                                      std::span<const terrain::Placement> own, const Demands& demands, base::Progress* progress);

}  // namespace tin::simplify
