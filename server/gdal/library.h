// GDAL and PROJ as this server allows them to be: few drivers, no network, no sidecar files, no output of
// their own.
#pragma once

#include <span>
#include <string>

namespace server::gdal {

/// Prepares GDAL and PROJ, once per process: registers the allowed drivers and no others (so that neither VRT
/// nor a network driver can be reached), refuses every HTTP request, switches off sidecar files and PROJ's
/// grid downloads, and silences messages. Every entry of this folder calls it first. Thread-safe.
void prepare_library();

/// Short names of the drivers that may open an uploaded raster, or vector, file.
std::span<const char* const> raster_drivers();
std::span<const char* const> vector_drivers();

/// Collects, on this thread and while it lives, what GDAL has to complain about.
class Complaints {
 public:
  Complaints();
  ~Complaints();
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;

  bool any() const { return !first_.empty(); }
  /// " (GDAL: first complaint)" to follow a sentence, paths below `private_folder` shortened; empty when
  /// there is none.
  std::string aside(const std::string& private_folder = {}) const;

  /// Called by GDAL for each error.
  void add(const char* message);

 private:
  std::string first_;
};

}  // namespace server::gdal
