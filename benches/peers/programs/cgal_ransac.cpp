// CGAL: "efficient RANSAC" (Schnabel and others, 2007).
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Random.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>

#include "program.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Numbered = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::size_t>;
using Points = std::vector<Numbered>;
using PointMap = CGAL::Nth_of_tuple_property_map<0, Numbered>;
using NormalMap = CGAL::Nth_of_tuple_property_map<1, Numbered>;
using Traits = CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Points, PointMap, NormalMap>;
using Ransac = CGAL::Shape_detection::Efficient_RANSAC<Traits>;

}  // namespace

// kn: neighbours of a normal; eps: distance of points to their plane; normal: cosine of the angle of their normals to it;
// cluster: the largest gap within a plane; min: points of a plane; prob: of missing the best candidate.
int main(int argc, char** argv) {
  return peers::run(argc, argv,
                    {{"kn", 24}, {"eps", 0.03}, {"normal", 0.9}, {"cluster", 0.1}, {"min", 300}, {"prob", 0.01}, {"seed", 1}},
                    [](peers::Run& run) {
    Points points;
    points.reserve(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) {
      const double* p = run.point(i);
      points.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), Kernel::Vector_3(), i);
    }
    CGAL::get_default_random() = CGAL::Random(run.whole<unsigned>("seed"));
    run.begin();
    CGAL::pca_estimate_normals<CGAL::Sequential_tag>(
        points, run.whole<unsigned>("kn"), CGAL::parameters::point_map(PointMap()).normal_map(NormalMap()));
    run.normals_done();

    Ransac ransac;
    ransac.set_input(points);
    ransac.add_shape_factory<CGAL::Shape_detection::Plane<Traits>>();
    Ransac::Parameters parameters;
    parameters.probability = run["prob"];
    parameters.min_points = run.whole<std::size_t>("min");
    parameters.epsilon = run["eps"];
    parameters.cluster_epsilon = run["cluster"];
    parameters.normal_threshold = run["normal"];
    ransac.detect(parameters);
    std::int32_t label = 0;
    for (const auto& shape : ransac.shapes()) {
      ++label;
      // The detection puts the points into another order.
      for (const std::size_t i : shape->indices_of_assigned_points()) run.labels[std::get<2>(points[i])] = label;
    }
    run.end();
  });
}
