#include "files/hdf5_file.h"
#include "generate/replay.h"
#include "generate/validate.h"
#include "generate/validate_noise.h"
#include "generate/validate_projection.h"

namespace toile::generate {

Validation validate_file(const std::string& path, const ValidateOptions& options) {
    bool projection = false, problem = false, noise = false, replay = false;
    {
        const files::Hdf5File file = files::Hdf5File::open(path);
        replay = files::is_replay(file);
        projection = file.has("/samples/projected");
        noise = file.has("/samples/spread");
        problem = file.has("/samples/predicted") && !file.has("/samples/cloth");
    }
    if (replay) return validate_replay(path);
    if (projection) return validate_projection(path, options);
    if (noise) return validate_noise(path, options);
    if (problem) return validate_problem(path, options);
    return validate_dataset(path, options);
}

}  // namespace toile::generate
