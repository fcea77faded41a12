// PCL: regions grown over normals.
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>

#include "pcl_cloud.hpp"

// k: neighbours of a normal; kg: of a point while it grows; angle: in degrees; curv: of seeds; smooth: 1 compares with the
// point that grows, 0 with the first of the region, which does not drift around corners; min: points of a plane.
int main(int argc, char** argv) {
  return peers::run(argc, argv, {{"k", 30}, {"kg", 30}, {"angle", 4}, {"curv", 0.05}, {"smooth", 1}, {"min", 500}}, [](peers::Run& run) {
    const auto cloud = peers::cloud(run);
    run.begin();
    pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
    pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(tree);
    estimation.setKSearch(run.whole<int>("k"));
    estimation.compute(*normals);
    run.normals_done();

    pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
    growing.setInputCloud(cloud);
    growing.setInputNormals(normals);
    growing.setSearchMethod(tree);
    growing.setNumberOfNeighbours(run.whole<unsigned>("kg"));
    growing.setSmoothnessThreshold(static_cast<float>(run["angle"] / 180.0 * M_PI));
    growing.setCurvatureThreshold(static_cast<float>(run["curv"]));
    growing.setSmoothModeFlag(run["smooth"] > 0);
    growing.setMinClusterSize(run.whole<int>("min"));
    growing.setMaxClusterSize(std::numeric_limits<int>::max());
    std::vector<pcl::PointIndices> regions;
    growing.extract(regions);
    std::int32_t label = 0;
    for (const auto& region : regions) {
      ++label;
      for (const int i : region.indices) run.labels[i] = label;
    }
    run.end();
  });
}
