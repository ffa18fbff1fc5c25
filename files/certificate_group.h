#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "files/hdf5_file.h"

namespace toile::files {

/// What the certificate says beyond the contract's table, see simulate/certificate.h.
struct CertificateDetail {
    double moving_share = 0;
    int body_crossings = 0, iterations = 0, path_steps = 0, tries = 1, rung = 0;
    std::array<int, 4> rung_status = {-1, -1, -1, -1};  ///< by rung; -1: not tried
    std::array<double, 4> rung_residual_force = {-1, -1, -1, -1};
};

struct CertificateRecord {
    double residual_force = 0, body_penetration = 0, max_stretch = 0, min_stretch = 0, max_speed = 0, seconds = 0;
    int self_intersections = 0;
    std::optional<CertificateDetail> detail = {};  ///< all samples of a file have it, or none
};

/// /certificate/*, one value a sample, without `seconds`. Throws Error where some have details and some have not.
void write_certificates(Hdf5File& file, const std::vector<CertificateRecord>& certificate);

/// The same in pieces: the datasets for `count` samples, with details or without, then their rows from `first` on.
void create_certificates(Hdf5File& file, int64_t count, bool detailed);
void write_certificate_rows(Hdf5File& file, int64_t first, const std::vector<CertificateRecord>& certificate);

/// The certificate of sample `slot`; `seconds` is NaN where the file does not have it. Throws Error for what is missing
/// or has another type or shape.
CertificateRecord read_certificate(const Hdf5File& file, int slot);
std::vector<CertificateRecord> read_certificates(const Hdf5File& file, int64_t first, int64_t count);

/// The bytes a sample's digest takes from its certificate.
std::string certificate_bytes(const CertificateRecord& certificate);

}  // namespace toile::files
