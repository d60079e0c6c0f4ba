#include "bake/slope_solver.hpp"

#include <cmath>
#include <utility>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

// Residual of the normal equations, relative to the first one in the preconditioner's norm.
constexpr double tolerance = 1e-7;
constexpr std::size_t most_iterations = 3000;

struct halfedge {
  std::uint32_t from, to;
  double weight;  // area / length^2
  double rise_m;
  double area;
};

double dot(const std::vector<double>& a, const std::vector<double>& b) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Multiplies edge by edge and stores no matrix. third_party_notes/not-taken.md compares it with Eigen's solvers.
class slope_system {
 public:
  slope_system(const refined_mesh& mesh, std::size_t originals,
               const std::function<double(std::size_t, std::size_t)>& rise, const std::function<bool()>& keep_going)
      : mesh_(mesh), originals_(originals), diagonal_(mesh.positions.size(), 0.0) {
    edges_.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (t % 4096 == 0 && keep_going && !keep_going()) return;
      const auto& v = mesh.triangles[t];
      const double area = 0.5 * glm::length(area_normal(corners(mesh.positions, v)));
      for (std::size_t k = 0; k < 3; ++k) {
        const vec3 way = mesh.positions[v[(k + 1) % 3]] - mesh.positions[v[k]];
        const double weight = area / glm::dot(way, way);
        edges_.push_back({v[k], v[(k + 1) % 3], weight, rise(t, k), area});
        diagonal_[v[k]] += weight;
        diagonal_[v[(k + 1) % 3]] += weight;
      }
    }
  }

  [[nodiscard]] std::vector<double> right_side() const {
    std::vector<double> out(diagonal_.size(), 0.0);
    for (const halfedge& e : edges_) {
      out[e.to] += e.weight * e.rise_m;
      out[e.from] -= e.weight * e.rise_m;
    }
    return out;
  }

  void apply(const std::vector<double>& x, std::vector<double>& y) const {
    y.assign(x.size(), 0.0);
    for (const halfedge& e : edges_) {
      const double flow = e.weight * (x[e.to] - x[e.from]);
      y[e.to] += flow;
      y[e.from] -= flow;
    }
  }

  // A function is its values at the original vertices, plus at every added one what it differs from the mean of the
  // edge's ends. In this basis the system is nearly diagonal, whatever the number of vertices.
  void precondition(const std::vector<double>& r, std::vector<double>& z) const {
    z = r;
    for (std::size_t i = z.size(); i-- > originals_;) {
      const auto& [a, b] = mesh_.parents[i - originals_];
      z[a] += 0.5 * z[i];
      z[b] += 0.5 * z[i];
    }
    for (std::size_t i = 0; i < z.size(); ++i) z[i] /= diagonal_[i];
    for (std::size_t i = originals_; i < z.size(); ++i) {
      const auto& [a, b] = mesh_.parents[i - originals_];
      z[i] += 0.5 * (z[a] + z[b]);
    }
  }

  void measure(slope_solution& out) const {
    double area = 0.0;
    double slopes = 0.0;
    double left = 0.0;
    for (const halfedge& e : edges_) {
      const double miss = out.heights_m[e.to] - out.heights_m[e.from] - e.rise_m;
      area += e.area;
      slopes += e.weight * e.rise_m * e.rise_m;
      left += e.weight * miss * miss;
    }
    // Along one direction out of two: the slope itself is larger by the root of 2.
    out.slope_rms = std::sqrt(2.0 * slopes / area);
    out.residual_rms = std::sqrt(2.0 * left / area);
  }

 private:
  const refined_mesh& mesh_;
  std::size_t originals_;
  std::vector<double> diagonal_;
  std::vector<halfedge> edges_;
};

// Takes the mean height off every component.
void centre(const refined_mesh& mesh, std::vector<double>& heights) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  std::vector<double> area(net.components, 0.0);
  std::vector<double> sum(net.components, 0.0);
  std::vector<std::uint32_t> component(heights.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double third = glm::length(area_normal(corners(mesh.positions, mesh.triangles[t]))) / 6.0;
    for (const std::uint32_t v : mesh.triangles[t]) {
      component[v] = net.component[t];
      area[net.component[t]] += third;
      sum[net.component[t]] += third * heights[v];
    }
  }
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] -= sum[component[v]] / area[component[v]];
}

}  // namespace

slope_solution solve_slopes(const refined_mesh& mesh, std::size_t originals,
                            const std::function<double(std::size_t t, std::size_t k)>& rise,
                            const std::function<bool()>& keep_going) {
  const slope_system system(mesh, originals, rise, keep_going);
  slope_solution out;
  std::vector<double> r = system.right_side();
  std::vector<double> z;
  std::vector<double> q;
  out.heights_m.assign(r.size(), 0.0);
  system.precondition(r, z);
  std::vector<double> p = z;
  double rz = dot(r, z);
  const double enough = tolerance * tolerance * rz;
  out.converged = rz == 0.0;
  while (!out.converged && out.iterations < most_iterations) {
    if (keep_going && !keep_going()) return out;
    ++out.iterations;
    system.apply(p, q);
    const double step = rz / dot(p, q);
    for (std::size_t i = 0; i < r.size(); ++i) {
      out.heights_m[i] += step * p[i];
      r[i] -= step * q[i];
    }
    system.precondition(r, z);
    const double next = dot(r, z);
    out.converged = next <= enough;
    const double turn = next / rz;
    rz = next;
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + turn * p[i];
  }
  system.measure(out);
  centre(mesh, out.heights_m);
  return out;
}

}  // namespace asperity::bake
