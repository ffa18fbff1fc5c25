#include "files/point_cache.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "cloth/error.h"

namespace toile::files {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

PointCacheWriter::PointCacheWriter(const std::string& path, int64_t points, int64_t samples)
    : file_(path), stream_(file_.partial(), std::ios::binary), points_(points), missing_(samples) {
    if (std::max(points, samples) > std::numeric_limits<int32_t>::max())
        throw Error("a PC2 file cannot count that many points or samples", path, "choose fewer samples with --pose");
    const int32_t version = 1, counts[2] = {static_cast<int32_t>(points), static_cast<int32_t>(samples)};
    const float first_frame = 0, frames_a_sample = 1;
    put("POINTCACHE2", 12);
    put(&version, 4);
    put(&counts[0], 4);
    put(&first_frame, 4);
    put(&frames_a_sample, 4);
    put(&counts[1], 4);
}

void PointCacheWriter::put(const void* data, size_t bytes) {
    errno = 0;
    if (!stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes)).flush())
        throw Error("cannot write the file: " + write_failure(errno != 0 ? errno : EIO), file_.path(),
                    "make room, or write to another disk");
}

void PointCacheWriter::append(const Positions& position) {
    if (position.rows() != points_ || missing_-- <= 0)
        throw std::logic_error("a sample that a PC2 file did not expect");
    const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> value = position.cast<float>();
    put(value.data(), sizeof(float) * static_cast<size_t>(value.size()));
}

void PointCacheWriter::commit() {
    if (missing_ != 0) throw std::logic_error("a PC2 file lacks samples");
    stream_.close();
    file_.commit();
}

}  // namespace toile::files
