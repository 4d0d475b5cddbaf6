// Samples that add a demand to others.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "tin/simplify/samples.h"

namespace tin::simplify {

/// Answers as what it wraps does; those who derive from it say where they differ.
class WrappedSamples : public Samples {
 public:
  explicit WrappedSamples(std::unique_ptr<Samples> inner) : inner_(std::move(inner)) {}

  Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override {
    return inner_->scan(a, b, c, tolerance, depth);
  }
  void narrow(const Site& a, const Site& b, const Site& c, double tolerance,
              Heights& heights) const override {
    inner_->narrow(a, b, c, tolerance, heights);
  }
  EdgeScan scan_edge(const Site& a, const Site& b, double tolerance) const override {
    return inner_->scan_edge(a, b, tolerance);
  }
  bool has_surface() const override { return inner_->has_surface(); }
  bool is_level(SampleIndex sample) const override { return inner_->is_level(sample); }
  bool may_float(SampleIndex sample) const override { return inner_->may_float(sample); }
  double fineness() const override { return inner_->fineness(); }
  double most() const override { return inner_->most(); }
  Site site(SampleIndex sample) const override { return inner_->site(sample); }
  void sites(SampleIndex begin, SampleIndex end, std::vector<Site>& out) const override {
    inner_->sites(begin, end, out);
  }
  exact::Point position(SampleIndex sample) const override { return inner_->position(sample); }
  std::optional<SampleIndex> find(exact::Point p) const override { return inner_->find(p); }
  SampleIndex end() const override { return inner_->end(); }
  bool exists(SampleIndex sample) const override { return inner_->exists(sample); }
  std::optional<Site> beside(const Site& sample, std::int32_t columns, std::int32_t rows) const override {
    return inner_->beside(sample, columns, rows);
  }
  bool has_neighbours() const override { return inner_->has_neighbours(); }
  Footprint* footprint() const override { return inner_->footprint(); }
  Extent extent() const override { return inner_->extent(); }
  void outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const override {
    inner_->outermost(box, out);
  }

 protected:
  const Samples& inner() const { return *inner_; }

 private:
  std::unique_ptr<Samples> inner_;
};

}  // namespace tin::simplify
