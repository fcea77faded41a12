#!/usr/bin/env python3
"""Open3D: planar patches, or the plane of most points by RANSAC again and again.

    open3d_planes.py patches|ransac points.npy labels.npy costs.json [NAME=VALUE...]

Files and costs are those of the C++ programs beside this one.

patches: kn: neighbours of a normal; nvd: how far normals of a patch may differ, cop: how near to a right angle to its
normal its points lie, both in degrees; out: share of outliers; edge: least edge of a patch; start: points a patch begins
with, 0 for a thousandth of all; ks: neighbours while a patch grows. Patches are boxes without points. dist: they own the points this
far from their plane; min: points of a plane, others are dropped.

ransac: dist: of points to their plane; cluster: the largest gap within a plane, 0 for any; min: points of a plane; planes:
how many at most; fails: how many planes in turn may fall apart into groups that are too small.
"""
import json
import resource
import sys
from pathlib import Path

import numpy as np
import open3d as o3d

DEFAULTS = {
    "patches": dict(kn=30, nvd=60.0, cop=75.0, out=0.75, edge=0.0, start=0, ks=30, dist=0.05, min=0),
    "ransac": dict(dist=0.03, iters=1000, prob=0.99999999, cluster=0.0, min=500, planes=40, fails=3, seed=1),
}


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def peak_mib():
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) / 1024


def patches(points, cloud, p):
    """Labels, and the CPU seconds when normals and patches were there."""
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(int(p["kn"])), fast_normal_computation=False)
    normals = cpu_seconds()
    boxes = cloud.detect_planar_patches(
        normal_variance_threshold_deg=p["nvd"], coplanarity_deg=p["cop"], outlier_ratio=p["out"],
        min_plane_edge_length=p["edge"], min_num_points=int(p["start"]),
        search_param=o3d.geometry.KDTreeSearchParamKNN(int(p["ks"])))
    found = cpu_seconds()
    # Each point goes to the nearest plane whose box holds it.
    labels = np.zeros(len(points), np.int32)
    nearest = np.full(len(points), np.inf)
    for label, box in enumerate(boxes, 1):
        local = np.abs((points - box.center) @ np.asarray(box.R))
        half = np.asarray(box.extent) / 2
        half[2] = max(half[2], p["dist"])
        nearer = (local <= half).all(axis=1) & (local[:, 2] < nearest)
        nearest[nearer] = local[nearer, 2]
        labels[nearer] = label
    labels[np.bincount(labels)[labels] < p["min"]] = 0
    return labels, normals, found


def largest_group(cloud, inliers, tolerance):
    groups = np.asarray(cloud.select_by_index(inliers).cluster_dbscan(tolerance, 10))
    sizes = np.bincount(groups[groups >= 0], minlength=1)
    return inliers[groups == sizes.argmax()]


def ransac(points, cloud, p):
    begin = cpu_seconds()
    o3d.utility.random.seed(int(p["seed"]))
    labels = np.zeros(len(points), np.int32)
    rest = np.arange(len(points))
    label = fails = 0
    while label < p["planes"] and fails < p["fails"] and len(rest) >= p["min"]:
        _, inliers = cloud.segment_plane(p["dist"], 3, int(p["iters"]), p["prob"])
        inliers = np.asarray(inliers)
        if len(inliers) < p["min"]:
            break
        taken = largest_group(cloud, inliers, p["cluster"]) if p["cluster"] > 0 else inliers
        if len(taken) < p["min"]:
            fails += 1
            continue
        fails = 0
        label += 1
        labels[rest[taken]] = label
        rest = np.delete(rest, taken)
        cloud = cloud.select_by_index(taken, invert=True)
    return labels, begin, cpu_seconds()


def main():
    method, points_path, labels_path, costs_path, *words = sys.argv[1:]
    settings = dict(DEFAULTS[method])
    for word in words:
        name, value = word.split("=")
        if name not in settings:
            sys.exit(f"unknown setting {word}")
        settings[name] = float(value)
    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    points = np.load(points_path)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    loaded, begin = peak_mib(), cpu_seconds()
    labels, normals, found = {"patches": patches, "ransac": ransac}[method](points, cloud, settings)
    peak = peak_mib()
    np.save(labels_path, labels)
    costs = dict(cpu_seconds=found - begin, cpu_normals=normals - begin, loaded_mb=loaded, peak_mb=peak)
    Path(costs_path).write_text(json.dumps(costs))


main()
