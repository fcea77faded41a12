// What all programs share: arguments, points in, labels and costs out.
//
//   PROGRAM points.npy labels.npy costs.json [NAME=VALUE...]
//
// points.npy holds N x 3 doubles; labels.npy gets N int32, 0 for no plane; costs.json the CPU seconds of the normals and of
// the whole, without loading, and the memory in MiB after loading and at the peak.
#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

inline double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Not from getrusage, whose peak includes that of the process which started this one.
inline double peak_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") {
      double kib = 0;
      status >> kib;
      return kib / 1024.0;
    }
  }
  throw std::runtime_error("no VmHWM in /proc/self/status");
}

inline std::vector<double> read_points(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char start[10] = {};
  if (!file.read(start, sizeof start) || start[6] != 1) throw std::runtime_error(path + ": no NPY file of version 1");
  const std::size_t length = static_cast<unsigned char>(start[8]) + 256U * static_cast<unsigned char>(start[9]);
  std::string header(length, ' ');
  file.read(header.data(), static_cast<std::streamsize>(length));
  const auto shape = header.find('(');
  if (header.find("<f8") == std::string::npos || header.find("False") == std::string::npos || shape == std::string::npos)
    throw std::runtime_error(path + ": no doubles in C order");
  std::vector<double> numbers(3 * std::stoull(header.substr(shape + 1)));
  if (!file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(sizeof(double) * numbers.size())))
    throw std::runtime_error(path + ": too short");
  return numbers;
}

inline void write_labels(const std::string& path, const std::vector<std::int32_t>& labels) {
  std::string header = "{'descr': '<i4', 'fortran_order': False, 'shape': (" + std::to_string(labels.size()) + ",), }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::ofstream file(path, std::ios::binary);
  file.write("\x93NUMPY\x01\x00", 8);
  file.put(static_cast<char>(header.size() & 0xff)).put(static_cast<char>(header.size() >> 8));
  file << header;
  file.write(reinterpret_cast<const char*>(labels.data()), static_cast<std::streamsize>(4 * labels.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

class Run {
 public:
  Run(int argc, char** argv, std::map<std::string, double> defaults) : settings_(std::move(defaults)) {
    if (argc < 4) throw std::runtime_error("points.npy labels.npy costs.json [NAME=VALUE...]");
    labels_path_ = argv[2];
    costs_path_ = argv[3];
    for (int i = 4; i < argc; ++i) {
      const std::string word = argv[i];
      const auto equals = word.find('=');
      const auto setting = settings_.find(word.substr(0, equals));
      if (equals == std::string::npos || setting == settings_.end()) throw std::runtime_error("unknown setting " + word);
      setting->second = std::stod(word.substr(equals + 1));
    }
    points = read_points(argv[1]);
    labels.assign(points.size() / 3, 0);
  }

  std::size_t size() const { return labels.size(); }
  const double* point(std::size_t i) const { return &points[3 * i]; }
  double operator[](const char* setting) const { return settings_.at(setting); }
  template <class Whole>
  Whole whole(const char* setting) const { return static_cast<Whole>(settings_.at(setting)); }

  // The points are where the library wants them.
  void begin() {
    loaded_ = peak_mib();
    begin_ = normals_ = cpu_seconds();
  }
  void normals_done() { normals_ = cpu_seconds(); }
  void end() {
    const double end = cpu_seconds();
    write_labels(labels_path_, labels);
    std::ofstream costs(costs_path_);
    costs << "{\"cpu_seconds\": " << end - begin_ << ", \"cpu_normals\": " << normals_ - begin_
          << ", \"loaded_mb\": " << loaded_ << ", \"peak_mb\": " << peak_mib() << "}\n";
    if (!costs.flush()) throw std::runtime_error("cannot write " + costs_path_);
  }

  std::vector<double> points;
  std::vector<std::int32_t> labels;

 private:
  std::map<std::string, double> settings_;
  std::string labels_path_, costs_path_;
  double loaded_ = 0, begin_ = 0, normals_ = 0;
};

template <class Body>
int run(int argc, char** argv, std::map<std::string, double> defaults, Body body) {
  try {
    Run run(argc, argv, std::move(defaults));
    body(run);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}

}  // namespace peers
