#include "generate/generate.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "cloth/error.h"
#include "files/new_file.h"
#include "generate/dataset_header.h"
#include "generate/image_size.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"
#include "generate/replay.h"

namespace toile::generate {
namespace {

using Clock = std::chrono::steady_clock;

/// One run: what its stages share.
struct Run {
    const GenerateOptions& options;
    const DressedScene& dressed;
    std::vector<int> split;  ///< `[N]`
    ReplayFolder& replays;
    GenerateSummary& summary;

    int count() const { return static_cast<int>(dressed.scene.pose_number.size()); }
};

std::vector<int> split_samples(const DressedScene& dressed) {
    const skin::PoseSplits splits = dressed.scene.poses->splits(dressed.scene.pose_number, dressed.scene.config.split);
    std::vector<int> split;
    for (const skin::Split one : splits.split) split.push_back(static_cast<int>(one));
    return split;
}

void count_sample(const files::SampleRecord& record, const std::string& replay, GenerateSummary& summary) {
    const files::CertificateRecord& c = record.certificate;
    ++summary.samples;
    summary.mean_drape_seconds += (c.seconds - summary.mean_drape_seconds) / summary.samples;
    if (record.status != 0) {
        const auto status = static_cast<simulate::DrapeStatus>(record.status);
        summary.failed.push_back({record.id, std::string(simulate::status_reason(status)), replay});
        return;
    }
    ++summary.accepted;
    summary.climbed += c.detail && c.detail->tries > 1;
    summary.worst_penetration = std::max(summary.worst_penetration, c.body_penetration);
    summary.worst_stretch = std::max(summary.worst_stretch, c.max_stretch);
    summary.worst_residual = std::max(summary.worst_residual, c.residual_force);
}

void report(const Run& run, std::string_view stage, int done) {
    if (run.options.progress)
        run.options.progress({stage, done, run.count(), static_cast<int>(run.summary.failed.size())});
}

files::SampleRecord drape_record(const Run& run, int index, std::unique_ptr<files::ReplayRecord>& replay) {
    Sample sample = make_sample(run.dressed, run.dressed.scene.pose_number[index]);
    replay = replay_record(run.dressed, sample);
    return sample_record(std::move(sample), run.split[index]);
}

/// The image, and the error of reading it back.
void add_image(const pattern::PatternImage& image, files::SampleRecord& record) {
    record.image = image.image(record.displacement);
    pattern::ResamplingError error;
    error.add(record.displacement, image.read(record.image));
    record.resampling_error = {error.largest, error.root_mean_square()};
}

void note_images(const pattern::PatternImage& image, const std::string& dataset, GenerateSummary& summary) {
    const files::DatasetReader reader(dataset);
    summary.image_width = summary.image_height = image.layout().size;
    summary.image_channels = image.channels();
    summary.image_error_max = (*reader.header().resampling_error)[0];
    summary.image_error_rms = (*reader.header().resampling_error)[1];
}

/// Drapes and rasterises in one go: without images, or where their size is given.
void write_at_once(const Run& run, const std::string& path, const pattern::PatternImage* image) {
    const int compression = run.dressed.scene.config.output.compression;
    files::DatasetWriter writer(path, dataset_header(run.dressed, image), run.count(), compression);
    std::vector<std::unique_ptr<files::ReplayRecord>> replay(static_cast<size_t>(run.count()));
    report(run, "draping", 0);
    make_in_order(
        run.count(), run.options.jobs,
        [&](int index) {
            files::SampleRecord record = drape_record(run, index, replay[index]);
            if (image) add_image(*image, record);
            return record;
        },
        [&](int index, files::SampleRecord record) {
            count_sample(record, replay[index] ? run.replays.write(*replay[index]) : std::string(), run.summary);
            replay[index].reset();
            writer.write(index, std::move(record));
            report(run, "draping", index + 1);
        },
        run.options.interrupted);
    writer.finish();
    if (image) note_images(*image, path, run.summary);
}

/// Drapes into a file without images, finds the image size that serves them all, and rasterises from there: any number
/// of samples in bounded memory.
void write_in_two_passes(const Run& run, const std::string& path, const std::string& drapes_path) {
    write_at_once(run, drapes_path, nullptr);
    const ScratchFile scratch(drapes_path), scratch_timing(files::timing_path(drapes_path));
    const files::DatasetReader drapes(drapes_path);
    const SceneConfig& config = run.dressed.scene.config;
    const pattern::ImageOptions sized = fitting_image(run.dressed, drapes, run.summary.remarks);
    const pattern::PatternImage image(run.dressed.mesh, run.dressed.scene.garment.triangle_panel, sized);
    files::DatasetWriter writer(path, dataset_header(run.dressed, &image), run.count(), config.output.compression);
    make_in_order(
        run.count(), run.options.jobs,
        [&](int index) {
            files::SampleRecord record = drapes.read(index);
            add_image(image, record);
            return record;
        },
        [&](int index, files::SampleRecord record) {
            writer.write(index, std::move(record));
            report(run, "rasterising", index + 1);
        },
        run.options.interrupted);
    writer.finish();
    note_images(image, path, run.summary);
}

void check_complete(const SceneConfig& config) {
    if (!config.body)
        throw Error("this scene has no [body]: there are no poses to make samples of", config.file,
                    "drape it with toile simulate");
    if (!config.poses) throw Error("this scene has no [poses]: there is nothing to make samples of", config.file);
}

}  // namespace

GenerateSummary generate(const SceneConfig& config, const GenerateOptions& options) {
    const auto start = Clock::now();
    check_complete(config);
    const OutputFolder folder(options.folder);
    GenerateSummary summary;
    summary.dataset = folder.file("dataset.h5");
    files::NewFile config_copy(folder.file("config.toml"));
    config_copy.write(config.absolute_text.data(), config.absolute_text.size());

    if (options.progress) options.progress({"dressing the body in its neutral pose", 0, 0, 0});
    const DressedScene dressed = dress(build_scene(config));
    summary.remarks = dressed.scene.remarks;
    summary.vertices = dressed.mesh.vertex_count();
    summary.triangles = dressed.mesh.triangle_count();
    ReplayFolder replays(folder);
    const Run run{options, dressed, split_samples(dressed), replays, summary};
    if (config.image && config.image->size == 0) {
        write_in_two_passes(run, summary.dataset, folder.file("dataset.drapes.h5"));
    } else {
        std::unique_ptr<pattern::PatternImage> image;
        if (config.image)
            image = std::make_unique<pattern::PatternImage>(dressed.mesh, dressed.scene.garment.triangle_panel,
                                                            *config.image);
        write_at_once(run, summary.dataset, image.get());
    }
    summary.bytes = std::filesystem::file_size(summary.dataset);
    config_copy.commit();
    replays.keep();
    summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return summary;
}

}  // namespace toile::generate
