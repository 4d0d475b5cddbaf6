#include "tin/mesh/validate.h"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tin::mesh {
namespace {

using exact::Point;

mpz_class wide(std::int64_t value) { return mpz_class(static_cast<long>(value)); }

/// Sign of the turn a, b, c.
int turn(Point a, Point b, Point c) {
  const mpz_class u = wide(b.x) - a.x, v = wide(b.y) - a.y, s = wide(c.x) - a.x, t = wide(c.y) - a.y;
  return sgn(u * t - v * s);
}

/// Sign of the 3 x 3 determinant of rows (x, y, x^2 + y^2) relative to d, in floating point with a bound, or
/// by GMP.
int circle_sign(Point a, Point b, Point c, Point d) {
  const std::array<Point, 3> row{a, b, c};
  std::array<double, 3> x{}, y{}, s{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = double(row[i].x) - d.x;
    y[i] = double(row[i].y) - d.y;
    s[i] = x[i] * x[i] + y[i] * y[i];
  }
  double sum = 0, size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    sum += s[i] * (x[j] * y[k] - x[k] * y[j]);
    size += s[i] * (std::abs(x[j] * y[k]) + std::abs(x[k] * y[j]));
  }
  if (std::abs(sum) > size * 0x1p-48) return sum > 0 ? 1 : -1;
  mpz_class exact = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const mpz_class xi(x[i]), yi(y[i]), xj(x[j]), yj(y[j]), xk(x[k]), yk(y[k]);
    exact += (xi * xi + yi * yi) * (xj * yk - xk * yj);
  }
  return sgn(exact);
}

/// Sign of the lifted determinant of a, b, c (counter-clockwise) and d when each lift gets an infinitesimal
/// that grows with (x, y): expanded by the lifts, each infinitesimal's coefficient is a turn of the other
/// three points.
int perturbed_circle_sign(Point a, Point b, Point c, Point d) {
  if (const int sign = circle_sign(a, b, c, d); sign != 0) return sign;
  struct Term {
    Point point;
    int coefficient;
  };
  std::array<Term, 4> terms{
      {{a, turn(b, c, d)}, {b, -turn(a, c, d)}, {c, turn(a, b, d)}, {d, -turn(a, b, c)}}};
  std::sort(terms.begin(), terms.end(), [](const Term& l, const Term& r) { return l.point > r.point; });
  for (const Term& term : terms) {
    if (term.coefficient != 0) return term.coefficient;
  }
  return 0;
}

std::string name(TriangleSlot t) { return "triangle " + std::to_string(t.value()); }
std::string name(VertexSlot v) { return "vertex " + std::to_string(v.value()); }

class Judge {
 public:
  explicit Judge(const Mesh& mesh) : mesh_(mesh) {}

  std::optional<std::string> judge() {
    if (mesh_.dimension() < 2) return line();
    for (auto check :
         {&Judge::links, &Judge::stars, &Judge::counts, &Judge::turns, &Judge::hull, &Judge::circles}) {
      if (auto broken = (this->*check)()) return broken;
    }
    return std::nullopt;
  }

 private:
  using Verdict = std::optional<std::string>;

  template <class F>
  Verdict each_triangle(F f) const {
    for (std::uint32_t i = 0; i < mesh_.triangle_slots(); ++i) {
      if (!mesh_.is_alive(TriangleSlot(i))) continue;
      if (Verdict broken = f(TriangleSlot(i))) return broken;
    }
    return std::nullopt;
  }

  Verdict line() const {
    const auto vertices = mesh_.line();
    if (vertices.size() != mesh_.vertex_count()) return "I0: the line misses vertices";
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (!mesh_.is_alive(vertices[i])) return "I0: dead " + name(vertices[i]) + " on the line";
      if (i > 0 && !(mesh_.point(vertices[i - 1]) < mesh_.point(vertices[i])))
        return "I0: the line is out of order";
      if (i > 1 && turn(mesh_.point(vertices[0]), mesh_.point(vertices[1]), mesh_.point(vertices[i])) != 0) {
        return "I0: " + name(vertices[i]) + " is off the line";
      }
    }
    return std::nullopt;
  }

  Verdict links() {
    if (!mesh_.line().empty()) return "I1: a line in a mesh of dimension 2";
    return each_triangle([this](TriangleSlot t) -> Verdict {
      const auto& [a, b, c] = mesh_.triangle(t).vertices;
      if (a == b || b == c || c == a) return "I1: " + name(t) + " repeats a vertex";
      for (int i = 0; i < 3; ++i) {
        const HalfEdge here(t, i), there = mesh_.twin(here);
        if (there.triangle().value() >= mesh_.triangle_slots() || !mesh_.is_alive(there.triangle()) ||
            there.index() > 2) {
          return "I1: " + name(t) + " has no neighbour " + std::to_string(i);
        }
        if (!(mesh_.twin(there) == here) || mesh_.origin(here) != mesh_.destination(there) ||
            mesh_.destination(here) != mesh_.origin(there)) {
          return "I1: " + name(t) + " and its neighbour " + std::to_string(i) + " disagree";
        }
        if (!mesh_.is_alive(mesh_.vertex(t, i))) return "I1: " + name(t) + " has a dead vertex";
      }
      ++triangles_;
      return std::nullopt;
    });
  }

  /// Each vertex's triangles form one cycle around it, reached from triangle_at(): together they are all
  /// corners.
  Verdict stars() {
    std::size_t corners = 0;
    std::vector<HalfEdge> star;
    for (std::uint32_t i = 0; i < mesh_.vertex_slots(); ++i) {
      const VertexSlot v(i);
      if (!mesh_.is_alive(v)) continue;
      const TriangleSlot t = mesh_.triangle_at(v);
      if (t.value() >= mesh_.triangle_slots() || !mesh_.is_alive(t))
        return "I2: " + name(v) + " has no triangle";
      const auto& vertices = mesh_.triangle(t).vertices;
      if (std::find(vertices.begin(), vertices.end(), v) == vertices.end())
        return "I2: " + name(v) + " is not in its triangle";
      mesh_.link(v, star);
      corners += star.size();
      ++vertices_;
    }
    if (corners != 3 * triangles_) return "I2: the triangles around some vertex are not one cycle";
    return std::nullopt;
  }

  Verdict counts() {
    if (vertices_ != mesh_.vertex_count() + 1) return "I3: the vertex count is wrong";
    if (triangles_ != 2 * vertices_ - 4) return "I3: Euler's relation fails";
    return std::nullopt;
  }

  Verdict turns() {
    return each_triangle([this](TriangleSlot t) -> Verdict {
      if (mesh_.is_infinite(t)) return std::nullopt;
      const auto& [a, b, c] = mesh_.triangle(t).vertices;
      if (turn(mesh_.point(a), mesh_.point(b), mesh_.point(c)) <= 0)
        return "I4: " + name(t) + " is not counter-clockwise";
      return std::nullopt;
    });
  }

  /// The hull, clockwise as the infinite vertex sees it, never turns left and goes around once.
  Verdict hull() {
    std::vector<HalfEdge> edges;
    mesh_.link(kInfinite, edges);
    std::size_t tops = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Point a = mesh_.point(mesh_.origin(edges[i])), b = mesh_.point(mesh_.destination(edges[i]));
      const Point c = mesh_.point(mesh_.destination(edges[(i + 1) % edges.size()]));
      if (turn(a, b, c) > 0) return "I5: the hull is not convex at " + name(mesh_.destination(edges[i]));
      if (a < b && c < b) ++tops;
    }
    if (tops != 1) return "I5: the hull does not go around once";
    return std::nullopt;
  }

  Verdict circles() {
    return each_triangle([this](TriangleSlot t) -> Verdict {
      if (mesh_.is_infinite(t)) return std::nullopt;
      const auto& [a, b, c] = mesh_.triangle(t).vertices;
      for (int i = 0; i < 3; ++i) {
        const HalfEdge there = mesh_.twin(t, i);
        if (there.triangle() < t || mesh_.is_infinite(there.triangle())) continue;
        if (perturbed_circle_sign(mesh_.point(a), mesh_.point(b), mesh_.point(c),
                                  mesh_.point(mesh_.apex(there))) > 0) {
          return "I6: " + name(mesh_.apex(there)) + " lies in the circle of " + name(t);
        }
      }
      return std::nullopt;
    });
  }

  const Mesh& mesh_;
  std::size_t triangles_ = 0;
  std::size_t vertices_ = 0;  // with the infinite one
};

}  // namespace

std::optional<std::string> validate(const Mesh& mesh) { return Judge(mesh).judge(); }

}  // namespace tin::mesh
