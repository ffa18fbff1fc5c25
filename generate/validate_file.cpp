#include "cloth/error.h"
#include "files/hdf5_file.h"
#include "generate/replay.h"
#include "generate/validate.h"
#include "generate/validate_noise.h"
#include "generate/validate_predictions.h"
#include "generate/validate_projection.h"
#include "generate/validate_recompute.h"

namespace toile::generate {
namespace {

/// Samples are made again before the checks, which start threads.
Validation validate_data_set(const std::string& path, const ValidateOptions& options) {
    Validation again;
    std::optional<Error> failure;
    try {
        if (options.recompute) recompute_samples(path, options, again);
    } catch (const Error& error) {
        failure = error;
    }
    Validation result = validate_dataset(path, options);
    if (failure && result.defect.empty()) throw Error(*failure);
    if (failure) result.remark.push_back(failure->what());
    result.defect.insert(result.defect.end(), again.defect.begin(), again.defect.end());
    result.remark.insert(result.remark.end(), again.remark.begin(), again.remark.end());
    result.recomputed = again.recomputed;
    return result;
}

}  // namespace

Validation validate_file(const std::string& path, const ValidateOptions& options) {
    bool projection = false, problem = false, predictions = false, noise = false, replay = false;
    {
        const files::Hdf5File file = files::Hdf5File::open(path);
        replay = files::is_replay(file);
        projection = file.has("/samples/projected");
        noise = file.has("/samples/spread");
        predictions = is_predictions(file);
        problem = file.has("/samples/predicted") && !file.has("/samples/cloth");
    }
    const bool data_set = !(replay || projection || noise || problem);
    if (options.recompute && !data_set) throw Error("only samples of a data set can be made again", path);
    if (!options.dataset.empty() && !predictions) throw Error("only predictions are compared with a data set", path);
    if (replay) return validate_replay(path);
    if (projection) return validate_projection(path, options);
    if (noise) return validate_noise(path, options);
    if (predictions) return validate_predictions(path, options);
    if (problem) return validate_problem(path, options);
    return validate_data_set(path, options);
}

}  // namespace toile::generate
