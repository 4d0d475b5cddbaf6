// Samples anywhere on the lattice, in a tree that clusters do not slow down.
#pragma once

#include <array>
#include <vector>

#include "tin/simplify/facet.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

/// A balanced tree over the samples, split at medians along the longer side of each box; leaves of up to
/// eight.
class PointSamples final : public Samples {
 public:
  /// Of one sample with its part of the tree, while it is made.
  static constexpr std::size_t kBytesPerSample = 48;

  /// `first` is the index that the samples' own start from. Requires: distinct positions.
  PointSamples(std::vector<Facet::Corner> samples, SampleIndex first, const base::Progress* progress,
               Footprint* footprint = nullptr);

  Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override;
  void narrow(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const override;
  Site site(SampleIndex sample) const override;
  exact::Point position(SampleIndex sample) const override { return samples_[sample - first_].at; }
  std::optional<SampleIndex> find(exact::Point p) const override;
  SampleIndex end() const override { return first_ + static_cast<SampleIndex>(samples_.size()); }
  bool exists(SampleIndex sample) const override { return sample >= first_ && sample < end(); }
  std::optional<Site> beside(const Site&, std::int32_t, std::int32_t) const override { return std::nullopt; }
  bool has_neighbours() const override { return false; }
  Footprint* footprint() const override { return footprint_; }
  Extent extent() const override;
  void outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const override;

  bool empty() const { return samples_.empty(); }

 private:
  struct Box {
    exact::Point low, high;
  };
  struct Ground;
  void build(std::size_t node, std::size_t begin, std::size_t end);
  template <class Leaf>
  bool visit(const Ground& ground, std::size_t node, std::size_t begin, std::size_t end, const Leaf& leaf) const;
  template <class Visit>
  void visit_box(const Box& wanted, const Visit& visit) const;

  static constexpr std::size_t kLeaf = 8;
  std::vector<Facet::Corner> samples_;
  std::vector<Box> boxes_;  // of node i; its children are 2i + 1 and 2i + 2
  SampleIndex first_;
  const base::Progress* progress_;
  Footprint* footprint_;
};

}  // namespace tin::simplify
