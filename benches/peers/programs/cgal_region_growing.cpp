// CGAL: regions grown around the points whose neighbours are the flattest, each with a plane fitted anew as it grows.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing_on_point_set.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>

#include "program.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oriented = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Points = std::vector<Oriented>;
using PointMap = CGAL::First_of_pair_property_map<Oriented>;
using NormalMap = CGAL::Second_of_pair_property_map<Oriented>;
using Neighbours = CGAL::Shape_detection::Point_set::K_neighbor_query<Kernel, Points, PointMap>;
using Region = CGAL::Shape_detection::Point_set::Least_squares_plane_fit_region<Kernel, Points, PointMap, NormalMap>;
using Sorting = CGAL::Shape_detection::Point_set::Least_squares_plane_fit_sorting<Kernel, Points, Neighbours, PointMap>;
using Growing = CGAL::Shape_detection::Region_growing<Points, Neighbours, Region, Sorting::Seed_map>;

}  // namespace

// kn: neighbours of a normal; k: of a point while it grows; dist: of points to their plane; angle: of normals to that of the
// plane, in degrees; min: points of a plane.
int main(int argc, char** argv) {
  return peers::run(argc, argv, {{"kn", 24}, {"k", 12}, {"dist", 0.05}, {"angle", 20}, {"min", 300}}, [](peers::Run& run) {
    Points points;
    points.reserve(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) {
      const double* p = run.point(i);
      points.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), Kernel::Vector_3());
    }
    run.begin();
    CGAL::pca_estimate_normals<CGAL::Sequential_tag>(
        points, run.whole<unsigned>("kn"), CGAL::parameters::point_map(PointMap()).normal_map(NormalMap()));
    run.normals_done();

    Neighbours neighbours(points, run.whole<std::size_t>("k"));
    Sorting sorting(points, neighbours);
    sorting.sort();
    Region region(points, run["dist"], run["angle"], run.whole<std::size_t>("min"));
    Growing growing(points, neighbours, region, sorting.seed_map());
    std::vector<std::vector<std::size_t>> regions;
    growing.detect(std::back_inserter(regions));
    std::int32_t label = 0;
    for (const auto& found : regions) {
      ++label;
      for (const std::size_t i : found) run.labels[i] = label;
    }
    run.end();
  });
}
