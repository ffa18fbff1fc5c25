#include "generate/sample_tally.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "simulate/certificate.h"

namespace toile::generate {

std::string replay_path(const std::string& folder, std::int64_t pose) {
    char name[40];
    std::snprintf(name, sizeof name, "pose_%06lld.h5", static_cast<long long>(pose));
    return (std::filesystem::path(folder) / "replay" / name).string();
}

void SampleTally::add(const files::SampleRecord& sample, const std::string& folder) {
    const files::CertificateRecord& c = sample.certificate;
    ++samples;
    if (std::isfinite(c.seconds)) drape_seconds += c.seconds;
    if (sample.status != 0) {
        const auto status = static_cast<simulate::DrapeStatus>(sample.status);
        failed.push_back({sample.id, std::string(simulate::status_reason(status)), replay_path(folder, sample.id)});
        return;
    }
    ++accepted;
    climbed += c.detail && c.detail->tries > 1;
    worst_penetration = std::max(worst_penetration, c.body_penetration);
    worst_stretch = std::max(worst_stretch, c.max_stretch);
    worst_residual = std::max(worst_residual, c.residual_force);
    image_error_max = std::max(image_error_max, sample.resampling_error[0]);
    image_error_square += sample.resampling_error[1] * sample.resampling_error[1];
}

void SampleTally::add(const SampleTally& other) {
    samples += other.samples;
    accepted += other.accepted;
    climbed += other.climbed;
    failed.insert(failed.end(), other.failed.begin(), other.failed.end());
    drape_seconds += other.drape_seconds;
    worst_penetration = std::max(worst_penetration, other.worst_penetration);
    worst_stretch = std::max(worst_stretch, other.worst_stretch);
    worst_residual = std::max(worst_residual, other.worst_residual);
    image_error_max = std::max(image_error_max, other.image_error_max);
    image_error_square += other.image_error_square;
}

std::map<std::string, std::int64_t> SampleTally::failed_by_reason() const {
    std::map<std::string, std::int64_t> count;
    for (const FailedSample& one : failed) ++count[one.reason];
    return count;
}

double SampleTally::image_error_rms() const {
    return accepted > 0 ? std::sqrt(image_error_square / static_cast<double>(accepted)) : 0.0;
}

}  // namespace toile::generate
