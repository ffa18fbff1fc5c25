#include "evaluate/image_study.h"

#include <spdlog/fmt/fmt.h>

#include <memory>

#include "cloth/error.h"
#include "evaluate/prior_sweep.h"
#include "pattern/pattern_image.h"

namespace toile::evaluate {
namespace {

/// A size of image, prepared once for the mesh.
struct SizedImage {
    int size = 0;
    std::unique_ptr<pattern::PatternImage> pattern;
    std::vector<std::vector<float>> image;  // [N]
    std::vector<Positions> read_back;       // [N]

    double megabytes() const { return 4e-6 * pattern->channels() * size * static_cast<double>(size); }
};

std::vector<std::unique_ptr<SizedImage>> make_images(const RuntimeSamples& samples, const ImageSweep& sweep,
                                                     Study& study) {
    std::vector<std::unique_ptr<SizedImage>> images;
    for (const int size : sweep.size) {
        auto one = std::make_unique<SizedImage>();
        one->size = size;
        pattern::ImageOptions options;
        options.size = size;
        try {
            one->pattern = std::make_unique<pattern::PatternImage>(samples.header.mesh, std::vector<int>(), options);
        } catch (const Error& error) {
            study.left_out.push_back(fmt::format("{} pixels: {}", size, error.what()));
            continue;
        }
        one->image.resize(samples.count());
        one->read_back.resize(samples.count());
        images.push_back(std::move(one));
    }
    return images;
}

void prepare_results(Study& study) {
    study.curves.push_back({"image-error",
                            "Error of what is read back from an image against the time to write and read it",
                            "Bars: quartiles over the samples.",
                            {"seconds to write and read an image", "s", true},
                            {"distance of what is read back", "mm", true},
                            {{"root mean square", {}}, {"largest", {}}}});
    study.table.push_back({"image-table",
                           "Images: size",
                           "Memory of one sample's image in single precision.",
                           {{"size", "pixels"},
                            {"write", "ms"},
                            {"read", "ms"},
                            {"both", "ratio"},
                            {"error, rms", "mm"},
                            {"largest", "mm"},
                            {"memory", "MB"}},
                           {}});
}

Spread milliseconds(const Spread& seconds) {
    return {1e3 * seconds.low, 1e3 * seconds.middle, 1e3 * seconds.high};
}

Spread sum(const Spread& a, const Spread& b) {
    return {a.low + b.low, a.middle + b.middle, a.high + b.high};
}

void add_result(Study& study, const SizedImage& image, const RuntimeSamples& samples, const Timings& timings, int write,
                int read) {
    std::vector<double> rms, largest;
    for (int s = 0; s < samples.count(); ++s) {
        pattern::ResamplingError error;
        error.add(samples.record[s].displacement, image.read_back[s]);
        rms.push_back(1e3 * error.root_mean_square());
        largest.push_back(1e3 * error.largest);
    }
    const std::string name = fmt::format("{}px", image.size), label = fmt::format("{} pixels", image.size);
    add_time_metrics(study, name + "/write", timings, write, samples.count());
    add_time_metrics(study, name + "/read", timings, read, samples.count());
    add_metric(study, name + "/rms", quartiles(rms), "mm", samples.count(), 0.2);
    add_metric(study, name + "/largest", quartiles(largest), "mm", samples.count());
    const double memory = image.megabytes();
    add_metric(study, name + "/memory", {memory, memory, memory}, "MB", samples.count(), 0.01);
    const Spread both = sum(timings.seconds(write), timings.seconds(read));
    study.curves[0].series[0].point.push_back({label, both, quartiles(rms)});
    study.curves[0].series[1].point.push_back({label, both, quartiles(largest)});
    study.table[0].row.push_back({double(image.size), milliseconds(timings.seconds(write)),
                                  milliseconds(timings.seconds(read)), sum(timings.units(write), timings.units(read)),
                                  quartiles(rms), quartiles(largest), memory});
}

}  // namespace

Study study_images(const RuntimeSamples& samples, const ImageSweep& sweep, const RepeatOptions& repeat,
                   const Clock& clock) {
    Study study;
    study.name = "image";
    study.title = "Images: size";
    if (!samples.header.embedding) {
        study.left_out.push_back("the data set has no displacements: there is nothing to make images of");
        return study;
    }
    const auto images = make_images(samples, sweep, study);
    std::vector<TimedTask> task;
    for (const auto& one : images) {
        task.push_back({"write", [&samples, image = one.get()](int s) {
                            image->image[s] = image->pattern->image(samples.record[s].displacement);
                        }});
        task.push_back(
            {"read", [image = one.get()](int s) { image->read_back[s] = image->pattern->read(image->image[s]); }});
    }
    const auto unit = unit_of(samples);
    const Timings timings = time_interleaved(task, samples.count(), factorisation(unit), repeat, clock);
    study.text.push_back(timing_note(samples, timings, *unit));
    prepare_results(study);
    for (size_t k = 0; k < images.size(); ++k)
        add_result(study, *images[k], samples, timings, static_cast<int>(2 * k), static_cast<int>(2 * k + 1));
    return study;
}

}  // namespace toile::evaluate
