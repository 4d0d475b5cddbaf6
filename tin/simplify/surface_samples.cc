#include "tin/simplify/surface_samples.h"

#include <array>
#include <utility>

#include "tin/simplify/narrowing.h"
#include "tin/simplify/ranking.h"
#include "tin/simplify/wrapped_samples.h"

namespace tin::simplify {

namespace {

class SurfaceSamples final : public WrappedSamples {
 public:
  SurfaceSamples(std::unique_ptr<Samples> samples, std::shared_ptr<const SourceMesh> mesh)
      : WrappedSamples(std::move(samples)), mesh_(std::move(mesh)) {}

  bool has_surface() const override { return true; }

  Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override {
    Scan found = inner().scan(a, b, c, tolerance, depth);
    for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &c), std::pair(&c, &a)}) {
      if (found.over && depth == Depth::kFirstOver) return found;
      // The same way from both sides, so that both find the same.
      const bool turned = to->at < from->at;
      scan_side(turned ? *to : *from, turned ? *from : *to, tolerance, depth, found);
    }
    return found;
  }

  void narrow(const Site& a, const Site& b, const Site& c, double tolerance,
              Heights& heights) const override {
    inner().narrow(a, b, c, tolerance, heights);
    for (const Site* other : {&b, &c}) {
      Narrowing narrowing(1, tolerance);
      mesh_->visit_crossings(a, *other, [&](const SourceMesh::Crossing& at) {
        const double along = static_cast<double>(at.from_a) / static_cast<double>(at.whole());
        narrowing.take(1 - along, along * other->z, mesh_->height(at));
        return narrowing.any();
      });
      narrowing.narrow(heights);
    }
  }

  EdgeScan scan_edge(const Site& a, const Site& b, double tolerance) const override {
    EdgeScan found;
    mesh_->visit_crossings(a, b, [&](const SourceMesh::Crossing& at) {
      const Verdict verdict = mesh_->judge(at, a, b, tolerance);
      ++found.crossings;
      found.over = found.over || !verdict.within;
      if (verdict.error <= found.error) return true;
      found.error = verdict.error;
      found.from = mesh_->sample(at.p);
      found.to = mesh_->sample(at.q);
      found.along = static_cast<double>(at.to_p) / static_cast<double>(at.whole());
      found.height = mesh_->height(at);
      return true;
    });
    return found;
  }

 private:
  void scan_side(const Site& a, const Site& b, double tolerance, Depth depth, Scan& found) const {
    mesh_->visit_crossings(a, b, [&](const SourceMesh::Crossing& at) {
      const Verdict verdict = mesh_->judge(at, a, b, tolerance);
      // The nearer end of the edge that is crossed is likely to help most.
      SampleIndex near = mesh_->sample(at.p), far = mesh_->sample(at.q);
      if (at.to_p > at.to_q) std::swap(near, far);
      keep_worse(found, {verdict.error, near, !verdict.within, far});
      return !(found.over && depth == Depth::kFirstOver);
    });
  }

  std::shared_ptr<const SourceMesh> mesh_;
};

}  // namespace

std::unique_ptr<Samples> with_surface(std::unique_ptr<Samples> samples,
                                      std::shared_ptr<const SourceMesh> mesh) {
  return std::make_unique<SurfaceSamples>(std::move(samples), std::move(mesh));
}

}  // namespace tin::simplify
