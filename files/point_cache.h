#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "cloth/types.h"
#include "files/new_file.h"

namespace toile::files {

/// Writes a PC2 point cache, a sample after the other: the header "POINTCACHE2\0", int32 version 1, int32 points,
/// float32 first frame 0, float32 frames a sample 1, int32 samples; then the samples' positions as float32 triples, all
/// little-endian. The file appears whole or not at all. Throws Error with the system's reason where it cannot be
/// written, and where there are more points or samples than an int32 counts.
class PointCacheWriter {
  public:
    PointCacheWriter(const std::string& path, int64_t points, int64_t samples);
    void append(const Positions& position);  ///< `[points x 3]`
    void commit();

  private:
    void put(const void* data, size_t bytes);

    NewFile file_;
    std::ofstream stream_;
    int64_t points_, missing_;
};

}  // namespace toile::files
