#include "generate/run.h"

#include <filesystem>

#include "files/dataset_file.h"
#include "generate/look.h"

namespace toile::generate {
namespace {

/// The slots of the samples whose pose numbers the scene wants to see; pose numbers that are no samples are passed
/// over.
std::vector<int> look_slots(const std::string& dataset, const std::vector<int>& pose) {
    const std::vector<std::int64_t> id =
        files::Hdf5File::open(dataset).read<std::int64_t>("/samples/id", {files::any_size}).value;
    std::vector<int> slot;
    for (const int number : pose)
        for (size_t i = 0; i < id.size(); ++i)
            if (id[i] == number) slot.push_back(static_cast<int>(i));
    return slot;
}

}  // namespace

RunSummary run(const SceneConfig& config, const GenerateOptions& options) {
    RunSummary summary;
    summary.generated = generate(config, options);
    const std::string& dataset = summary.generated.dataset;
    const std::string folder = std::filesystem::path(dataset).parent_path().string();
    summary.look = write_look(dataset, folder, look_slots(dataset, config.output.look));
    ValidateOptions check;
    check.jobs = options.jobs;
    if (options.progress) check.step = [&](int done, int total) { options.progress({"checking", done, total, 0}); };
    summary.validation = validate_dataset(dataset, check);
    return summary;
}

}  // namespace toile::generate
