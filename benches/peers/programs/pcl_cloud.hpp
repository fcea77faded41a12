// The points as PCL has them.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "program.hpp"

namespace peers {

inline pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(const Run& run) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(run.size());
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double* p = run.point(i);
    cloud->emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
  }
  return cloud;
}

}  // namespace peers
