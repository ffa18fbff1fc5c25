#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace toile::generate {

struct Validation {
    int samples = 0, accepted = 0;
    int recomputed = 0;               ///< samples made again
    std::vector<std::string> defect;  ///< one line each: "/samples/cloth[3]: what is wrong"
    std::vector<std::string> remark;  ///< what is no defect, but good to know
};

/// How many samples to make again: so many where `count` is positive, else a share of them.
struct RecomputeChoice {
    double share = 0;
    std::int64_t count = 0;
};

struct ValidateOptions {
    std::optional<RecomputeChoice> recompute;       ///< of a data set (`recompute_samples`)
    std::string dataset;                            ///< of predictions: the data set they are for; may be empty
    int jobs = 1;                                   ///< samples checked side by side; the result does not depend on it
    std::function<void(int done, int total)> step;  ///< called after each sample, one call at a time
};

/// Checks any file of ours: a data set, a projection, a problem, predictions, a noise floor, or a replay, told apart by
/// their datasets.
Validation validate_file(const std::string& path, const ValidateOptions& options = {});

/// Checks a dataset file from the file alone and returns everything that is wrong with it, in a fixed order:
///
/// - the contract's datasets, their types, shapes and attributes (if these fail, nothing further is read);
/// - the garment's mesh (`check_cloth_mesh`), masses, the body (indices, skeleton, rigid bind transforms, weights that
///   sum to one), embedding and image layout;
/// - every sample: digest, status, split; an accepted one also finite values, unit quaternions, r = r̃ + q·d·q⁻¹ to
///   1e-6 m, r̃ on the posed body to 1e-5 m (linear or dual quaternion skinning), the image read as the contract says
///   within `resampling_error`, and the certificate: within the gate's bounds (the attributes of /certificate), and its
///   stretch and penetration as the cloth itself gives them;
/// - ids that repeat, and poses in different splits nearer than `duplicate_angle` in every joint.
///
/// A value that occurs many times in one array is one line with their number. Throws Error if the file cannot be read
/// at all or is not one of toile's.
Validation validate_dataset(const std::string& path, const ValidateOptions& options = {});

}  // namespace toile::generate
