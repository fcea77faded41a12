// PCL: the plane of most points by RANSAC, again and again among the points that are left, as its tutorials have it.
#include <pcl/ModelCoefficients.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include "pcl_cloud.hpp"

namespace {

using Point = pcl::PointXYZ;

// Of the points of a plane the largest group without gaps above the tolerance.
pcl::Indices largest_group(const pcl::PointCloud<Point>::Ptr& cloud, const pcl::Indices& inliers, double tolerance) {
  pcl::IndicesPtr indices(new pcl::Indices(inliers));
  pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
  tree->setInputCloud(cloud, indices);
  pcl::EuclideanClusterExtraction<Point> extraction;
  extraction.setClusterTolerance(tolerance);
  extraction.setMinClusterSize(1);
  extraction.setMaxClusterSize(std::numeric_limits<int>::max());
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  extraction.setIndices(indices);
  std::vector<pcl::PointIndices> groups;
  extraction.extract(groups);
  return groups.empty() ? pcl::Indices() : groups.front().indices;
}

}  // namespace

// dist: of points to their plane; cluster: the largest gap within a plane, 0 for any; min: points of a plane; planes: how many
// at most; fails: how many planes in turn may fall apart into groups that are too small.
int main(int argc, char** argv) {
  return peers::run(argc, argv,
                    {{"dist", 0.03}, {"iters", 1000}, {"prob", 0.99}, {"cluster", 0}, {"min", 500}, {"planes", 40}, {"fails", 3}},
                    [](peers::Run& run) {
    const auto cloud = peers::cloud(run);
    run.begin();
    const auto least = run.whole<std::size_t>("min");
    pcl::SACSegmentation<Point> segmentation;
    segmentation.setOptimizeCoefficients(true);
    segmentation.setModelType(pcl::SACMODEL_PLANE);
    segmentation.setMethodType(pcl::SAC_RANSAC);
    segmentation.setDistanceThreshold(run["dist"]);
    segmentation.setMaxIterations(run.whole<int>("iters"));
    segmentation.setProbability(run["prob"]);
    segmentation.setInputCloud(cloud);

    pcl::IndicesPtr rest(new pcl::Indices(run.size()));
    for (std::size_t i = 0; i < run.size(); ++i) (*rest)[i] = static_cast<pcl::index_t>(i);
    std::int32_t label = 0;
    for (int fails = 0; label < run.whole<std::int32_t>("planes") && fails < run.whole<int>("fails") && rest->size() >= least;) {
      pcl::PointIndices inliers;
      pcl::ModelCoefficients plane;
      segmentation.setIndices(rest);
      segmentation.segment(inliers, plane);
      if (inliers.indices.size() < least) break;
      const auto taken = run["cluster"] > 0 ? largest_group(cloud, inliers.indices, run["cluster"]) : inliers.indices;
      if (taken.size() < least) {
        ++fails;
        continue;
      }
      fails = 0;
      ++label;
      for (const int i : taken) run.labels[i] = label;
      pcl::IndicesPtr left(new pcl::Indices);
      for (const int i : *rest)
        if (run.labels[i] == 0) left->push_back(i);
      rest = left;
    }
    run.end();
  });
}
