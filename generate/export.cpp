#include "generate/export.h"

#include <charconv>
#include <filesystem>

#include "cloth/error.h"
#include "generate/export_formats.h"

namespace toile::generate {
namespace {

namespace fs = std::filesystem;

/// What the name of the output must end in; empty for folders.
std::string extension_of(ExportFormat format) {
    switch (format) {
        case ExportFormat::npz:
            return ".npz";
        case ExportFormat::gltf:
            return ".glb";
        case ExportFormat::xdmf:
            return ".xdmf";
        default:
            return {};
    }
}

void check_options(const ExportOptions& options) {
    const std::string extension = extension_of(options.format);
    if (!extension.empty() && fs::path(options.out).extension() != extension)
        throw Error("the name of the file to write does not end in " + extension, options.out);
    if (!(options.rate > 0 && options.rate <= 1e6)) throw Error("the rate is not above 0 and at most 1e6", "--rate");
}

[[noreturn]] void fail_empty(const ExportSamples& samples, const ExportOptions& options) {
    const std::string all = std::to_string(samples.dataset_count());
    if (samples.not_finite() > 0) throw Error("no selected sample is finite; the data set has " + all, options.dataset);
    throw Error("no sample is selected; the data set has " + all, options.dataset,
                options.failed ? "choose others with --pose or --split"
                               : "choose others with --pose or --split; --status all keeps those that failed too");
}

std::vector<std::string> write_format(const ExportSamples& samples, const ExportOptions& options) {
    switch (options.format) {
        case ExportFormat::npz:
            return export_npz(samples, options);
        case ExportFormat::obj:
        case ExportFormat::ply:
            return export_meshes(samples, options);
        case ExportFormat::pc2:
            return export_point_cache(samples, options);
        case ExportFormat::gltf:
            return export_gltf(samples, options);
        case ExportFormat::xdmf:
            return export_xdmf(samples, options);
    }
    return {};
}

std::uintmax_t size_on_disk(const std::string& path) {
    if (!fs::is_directory(path)) return fs::file_size(path);
    std::uintmax_t bytes = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) bytes += entry.file_size();
    return bytes;
}

/// The number that `text` is, nothing before or after it.
int64_t pose_number(std::string_view text, const std::string& whole) {
    int64_t number = -1;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (failure != std::errc() || end != text.data() + text.size() || number < 0)
        throw Error("'" + whole + "' is not a list of pose numbers", "--pose", "write it as 7 or 3,10-20");
    return number;
}

}  // namespace

ExportSummary export_dataset(const ExportOptions& options) {
    check_options(options);
    const ExportSamples samples(options);
    if (samples.count() == 0) fail_empty(samples, options);
    ExportSummary summary;
    summary.path = write_format(samples, options);
    summary.samples = samples.count();
    summary.not_finite = samples.not_finite();
    for (const std::string& path : summary.path) summary.bytes += size_on_disk(path);
    return summary;
}

std::vector<std::pair<int64_t, int64_t>> parse_pose_ranges(const std::string& text) {
    std::vector<std::pair<int64_t, int64_t>> range;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find(',', begin), text.size());
        const std::string_view item = std::string_view(text).substr(begin, end - begin);
        const size_t dash = item.find('-');
        const int64_t first = pose_number(item.substr(0, dash), text);
        const int64_t last = dash == item.npos ? first : pose_number(item.substr(dash + 1), text);
        if (last < first) throw Error("the poses of '" + std::string(item) + "' run backwards", "--pose");
        range.emplace_back(first, last);
        begin = end + 1;
    }
    return range;
}

}  // namespace toile::generate
