#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "tests/support/oracle.h"

namespace support {

std::vector<Corners> cgal_delaunay(std::span<const tin::exact::Point> points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Delaunay_triangulation_2<Kernel> triangulation;
  std::vector<Kernel::Point_2> copy;
  copy.reserve(points.size());
  for (const auto p : points) copy.emplace_back(p.x, p.y);
  triangulation.insert(copy.begin(), copy.end());
  std::vector<Corners> out;
  const auto back = [](const Kernel::Point_2& p) {
    return tin::exact::Point{static_cast<std::int32_t>(p.x()), static_cast<std::int32_t>(p.y())};
  };
  for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
    out.push_back(canonical({back(face->vertex(0)->point()), back(face->vertex(1)->point()), back(face->vertex(2)->point())}));
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace support
