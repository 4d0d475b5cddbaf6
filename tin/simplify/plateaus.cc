#include "tin/simplify/plateaus.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "tin/simplify/point_samples.h"
#include "tin/simplify/ranking.h"
#include "tin/simplify/wrapped_samples.h"

namespace tin::simplify {

using mesh::VertexSlot;

namespace {

constexpr std::size_t kBytesPerLevel =
    96;  // of a level sample in lists, with its neighbours beside, and in the tree

/// Who is beside whom.
class Neighbourhood {
 public:
  Neighbourhood(const Samples& samples, const SourceMesh* mesh) : samples_(samples), mesh_(mesh) {}

  std::span<const SampleIndex> of(SampleIndex sample) {
    found_.clear();
    if (samples_.has_neighbours()) {
      const Site site = samples_.site(sample);
      for (std::int32_t row = -1; row <= 1; ++row) {
        for (std::int32_t column = -1; column <= 1; ++column) {
          const auto beside = samples_.beside(site, column, row);
          if (beside && beside->sample != sample) found_.push_back(beside->sample);
        }
      }
    } else {
      mesh_->mesh().link(mesh_->slot(sample), link_);
      for (const mesh::HalfEdge e : link_) {
        const VertexSlot v = mesh_->mesh().origin(e);
        if (v != mesh::kInfinite) found_.push_back(mesh_->sample(v));
      }
    }
    return found_;
  }

 private:
  const Samples& samples_;
  const SourceMesh* mesh_;
  std::vector<SampleIndex> found_;
  std::vector<mesh::HalfEdge> link_;
};

class Finder {
 public:
  Finder(const Samples& samples, const SourceMesh* mesh, const base::Progress* progress)
      : samples_(samples), neighbourhood_(samples, mesh), progress_(progress) {}

  /// The level samples of all plateaus, ascending.
  std::vector<SampleIndex> find(std::size_t least) {
    const std::size_t count = find_level();
    if (Footprint* const footprint = samples_.footprint();
        footprint != nullptr && !footprint->take(count * kBytesPerLevel))
      return {};
    std::vector<SampleIndex> out, plateau;
    for (SampleIndex first = 0; first < samples_.end() && !cancelled(first); ++first) {
      if (!level_[first]) continue;
      collect(first, plateau);
      if (plateau.size() >= least) out.insert(out.end(), plateau.begin(), plateau.end());
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  /// Those on plateaus and those beside, ascending.
  std::vector<SampleIndex> with_rims(std::span<const SampleIndex> plateaus) {
    std::vector<SampleIndex> out(plateaus.begin(), plateaus.end());
    for (const SampleIndex sample : plateaus) {
      if (cancelled(sample)) break;
      for (const SampleIndex beside : neighbourhood_.of(sample)) {
        if (!std::binary_search(plateaus.begin(), plateaus.end(), beside)) out.push_back(beside);
      }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

 private:
  bool cancelled(SampleIndex sample) const {
    return sample % 4096 == 0 && progress_ != nullptr && progress_->cancelled();
  }

  /// How many there are.
  std::size_t find_level() {
    std::size_t count = 0;
    level_.assign(samples_.end(), false);
    for (SampleIndex sample = 0; sample < samples_.end() && !cancelled(sample); ++sample) {
      if (!samples_.exists(sample)) continue;
      const double z = samples_.site(sample).z;
      const auto around = neighbourhood_.of(sample);
      // In a corner of a raster there are three.
      level_[sample] =
          around.size() >= 3 && std::all_of(around.begin(), around.end(),
                                            [&](SampleIndex beside) { return samples_.site(beside).z == z; });
      if (level_[sample]) ++count;
    }
    return count;
  }

  /// The level samples that hang together with `first`; takes their marks away.
  void collect(SampleIndex first, std::vector<SampleIndex>& out) {
    out.assign(1, first);
    level_[first] = false;
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (const SampleIndex beside : neighbourhood_.of(out[i])) {
        if (!level_[beside]) continue;
        level_[beside] = false;
        out.push_back(beside);
      }
    }
  }

  const Samples& samples_;
  Neighbourhood neighbourhood_;
  const base::Progress* progress_;
  std::vector<bool> level_;
};

class PlateauSamples final : public WrappedSamples {
 public:
  PlateauSamples(std::unique_ptr<Samples> samples, std::vector<SampleIndex> flat,
                 std::vector<SampleIndex> still, const base::Progress* progress)
      : WrappedSamples(std::move(samples)),
        flat_(std::move(flat)),
        still_(std::move(still)),
        tree_(corners(), 0, progress) {
    names_.reserve(flat_.size());
    for (SampleIndex i = 0; i < tree_.end(); ++i) names_.push_back(*inner().find(tree_.position(i)));
  }

  Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override {
    Scan found = inner().scan(a, b, c, tolerance, depth);
    if (found.over && depth == Depth::kFirstOver) return found;
    Scan flat = tree_.scan(a, b, c, 0, depth);
    if (!flat.over) return found;
    flat.sample = names_[flat.sample];
    keep_worse(found, flat);
    return found;
  }
  bool is_level(SampleIndex sample) const override {
    return std::binary_search(flat_.begin(), flat_.end(), sample);
  }
  bool may_float(SampleIndex sample) const override {
    return inner().may_float(sample) && !std::binary_search(still_.begin(), still_.end(), sample);
  }

 private:
  std::vector<Facet::Corner> corners() const {
    std::vector<Facet::Corner> out;
    out.reserve(flat_.size());
    for (const SampleIndex sample : flat_) {
      const Site site = inner().site(sample);
      out.push_back({site.at, site.z});
    }
    return out;
  }

  std::vector<SampleIndex> flat_, still_;  // ascending
  PointSamples tree_;                      // of the flat ones
  std::vector<SampleIndex> names_;         // by their index in the tree
};

}  // namespace

std::unique_ptr<Samples> with_plateaus(std::unique_ptr<Samples> samples, const SourceMesh* mesh,
                                       std::size_t least, const base::Progress* progress) {
  Finder finder(*samples, mesh, progress);
  auto flat = finder.find(least);
  if (flat.empty()) return samples;
  auto still = finder.with_rims(flat);
  return std::make_unique<PlateauSamples>(std::move(samples), std::move(flat), std::move(still), progress);
}

}  // namespace tin::simplify
