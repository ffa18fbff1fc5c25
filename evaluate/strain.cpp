#include "evaluate/strain.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cloth/error.h"
#include "evaluate/strain_blocks.h"
#include "evaluate/strain_colour.h"
#include "evaluate/strain_columns.h"
#include "evaluate/strain_frames.h"
#include "files/metric_file.h"
#include "files/strain_file.h"
#include "generate/ordered_work.h"
#include "generate/output_folder.h"

namespace toile::evaluate {
namespace {

constexpr int window = 5;  // frames that the rates of one need, itself included

void check(const StrainOptions& options) {
    if (!std::isfinite(options.normal_weight) || options.normal_weight < 0)
        throw Error("--normal-weight must be a number from 0 on", "command line");
    if (!std::isfinite(options.time_step) || options.time_step < 0)
        throw Error("--time-step must be a positive number of seconds", "command line");
    if (options.dataset.empty() == options.sequence.empty())
        throw Error("name either meshes or a data set", "command line",
                    "--rest A --deformed B, --sequence FRAMES or --dataset FILE");
    if (options.dataset.empty()) return;
    if (options.time_step > 0)
        throw Error("a data set has no rates: its samples have no time between them", options.dataset,
                    "leave --time-step out, or name a sequence of meshes");
    if (!options.rest.empty())
        throw Error("a data set is measured from its own rest state", options.dataset, "leave --rest out");
}

/// F of all triangles and vertices of one frame, for the rates.
struct FrameGradients {
    std::vector<Eigen::Matrix3d> triangle, vertex;
};

/// One run over the frames.
class StrainRun {
  public:
    StrainRun(const StrainOptions& options, const StrainFrames& frames)
        : options_(options),
          frames_(frames),
          rest_(strain_rest(frames.mesh(), frames.rest_name())),
          around_(find_neighbourhoods(rest_, options.neighbourhood, options.jobs)),
          fit_(rest_, around_, options.normal_weight, options.jobs) {}

    StrainSummary measure(files::StrainWriter& writer) {
        StrainSummary summary =
            empty_summary(options_.time_step > 0, frames_.mesh().triangle_count(), rest_.vertex_count);
        const int count = frames_.count();
        for (int k = 0; k < count; ++k) {
            step("measuring strain", k, count);
            measure_frame(k, writer, summary);
            if (!summary.rates) continue;
            for (; next_rate_ < count && ready(next_rate_, k); ++next_rate_) measure_rates(next_rate_, writer, summary);
        }
        return summary;
    }

    /// Coloured meshes of some frames, read once more.
    std::vector<std::string> write_look(const generate::OutputFolder& into) {
        std::vector<std::string> path;
        const int count = std::min(options_.look, frames_.count());
        for (int k = 0; k < count; ++k) {
            step("writing coloured meshes", k, count);
            const int frame =
                count == 1 ? 0 : static_cast<int>(static_cast<long>(k) * (frames_.count() - 1) / (count - 1));
            const Positions position = frames_.read(frame);
            path.push_back(into.file("strain_" + padded(frame) + "." + options_.look_format));
            write_coloured_mesh(path.back(), rest_, position, triangle_strain(rest_, position, options_.jobs));
        }
        return path;
    }

    const StrainRest& rest() const { return rest_; }

  private:
    std::string padded(int frame) const {
        const std::string digits = std::to_string(frame);
        return std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
    }

    void step(const char* stage, int done, int total) const {
        if (options_.interrupted && options_.interrupted->load())
            throw generate::Interrupted("interrupted: no results were written");
        if (options_.progress) options_.progress({stage, done, total, 0});
    }

    /// Whether frame `last` is the last one that the rates of frame k need.
    bool ready(int k, int last) const { return last >= std::min(std::max(k + 2, window - 1), frames_.count() - 1); }

    void measure_frame(int k, files::StrainWriter& writer, StrainSummary& summary) {
        const Positions position = frames_.read(k);
        const std::vector<TriangleStrain> triangle = triangle_strain(rest_, position, options_.jobs);
        const std::vector<VertexStrain> vertex = fit_.fit(position, options_.jobs);
        add_frame(summary, frames_.name(k), triangle, vertex);
        writer.write(k, strain_columns(triangle, options_.stretches_only),
                     strain_columns(vertex, options_.stretches_only));
        if (!summary.rates) return;
        FrameGradients& kept = recent_.emplace_back();
        for (const TriangleStrain& one : triangle) kept.triangle.push_back(one.surface_gradient);
        for (const VertexStrain& one : vertex) kept.vertex.push_back(one.gradient);
        if (recent_.size() > window) {
            recent_.pop_front();
            ++first_recent_;
        }
    }

    void measure_rates(int k, files::StrainWriter& writer, StrainSummary& summary) {
        const RateStencil stencil = rate_stencil(k, frames_.count());
        const auto rates_of = [&](const auto member, int index, const Eigen::Vector3d& normal) {
            std::vector<Eigen::Matrix3d> gradient;
            for (const FrameGradients& frame : recent_) gradient.push_back((frame.*member)[index]);
            return strain_rate(stencil, k, first_recent_, gradient, normal, options_.time_step);
        };
        std::vector<StrainRate> triangle(rest_.frame.size()), vertex(static_cast<size_t>(rest_.vertex_count));
        for_blocks(static_cast<int>(triangle.size()), options_.jobs, [&](int f) {
            const Eigen::Matrix<double, 3, 2>& axis = rest_.frame[f].axis;
            triangle[f] = rates_of(&FrameGradients::triangle, f, axis.col(0).cross(axis.col(1)));
        });
        for_blocks(static_cast<int>(vertex.size()), options_.jobs, [&](int v) {
            const int centre = around_.centre[v];
            const Eigen::Vector3d normal = centre < 0 ? Eigen::RowVector3d(0, 0, 1) : rest_.normal.row(centre);
            vertex[v] = rates_of(&FrameGradients::vertex, v, normal);
        });
        add_rates(summary, k, triangle, vertex);
        writer.write_rates(k, rate_columns(triangle, options_.stretches_only),
                           rate_columns(vertex, options_.stretches_only));
    }

    const StrainOptions& options_;
    const StrainFrames& frames_;
    const StrainRest rest_;
    const Neighbourhoods around_;
    const VertexStrainFit fit_;
    std::deque<FrameGradients> recent_;  ///< the first is frame `first_recent_`
    int first_recent_ = 0, next_rate_ = 0;
};

std::string source_of(const StrainOptions& options, const StrainFrames& frames) {
    if (!options.dataset.empty()) return options.dataset;
    return frames.count() == 1 ? frames.name(0) : frames.name(0) + " ... " + frames.name(frames.count() - 1);
}

files::StrainHeader header_of(const StrainOptions& options, const StrainFrames& frames, const StrainRest& rest) {
    files::StrainHeader header;
    header.mesh = frames.mesh();
    for (const StrainRest::Triangle& one : rest.frame)
        header.triangle_axis.insert(header.triangle_axis.end(), one.axis.data(), one.axis.data() + 6);
    header.source = source_of(options, frames);
    header.rest = frames.rest_name() + (rest.from_pattern ? " (its pattern)" : " (its positions)");
    header.neighbourhood = options.neighbourhood.text();
    header.normal_weight = options.normal_weight;
    header.time_step = options.time_step;
    for (int k = 0; k < strain_fault_count; ++k)
        header.faults.push_back(strain_fault_name(static_cast<StrainFault>(k)));
    header.program_version = TOILE_VERSION;
    return header;
}

std::vector<std::string> notes_of(const StrainOptions& options, const StrainFrames& frames) {
    std::vector<std::string> note = frames.notes();
    if (!options.dataset.empty())
        note.push_back("no rates: the samples of a data set are drapes at rest, with no time between them");
    else if (options.time_step == 0)
        note.push_back("no rates: they need a sequence with --time-step");
    else if (frames.count() < 4)
        note.push_back("the rates have no estimate of the time step's error at some frames: it needs five of them");
    return note;
}

void write_results(const StrainSummary& summary, const files::StrainHeader& header, const StrainOptions& options,
                   const std::string& path) {
    files::MetricFile file;
    file.kind = "strain";
    file.about = {{options.dataset.empty() ? "frames" : "dataset", header.source},
                  {"rest", header.rest},
                  {"neighbourhood", header.neighbourhood}};
    if (!options.command.empty()) file.about.push_back({"command", options.command});
    nlohmann::ordered_json own = strain_members(summary);
    if (header.time_step > 0) own["time_step"] = header.time_step;
    file.metric = strain_metrics(summary);
    files::write_metric_file(path, file, own);
}

}  // namespace

StrainSummary evaluate_strain(const StrainOptions& options) {
    check(options);
    const std::unique_ptr<StrainFrames> frames = options.dataset.empty()
                                                     ? mesh_frames(options.rest, options.sequence)
                                                     : dataset_frames(options.dataset, options.split);
    if (options.time_step > 0 && frames->count() < 2)
        throw Error("rates need at least two frames", frames->name(0), "leave --time-step out");
    const generate::OutputFolder into(options.folder, generate::OutputFolder::For::results);
    StrainRun run(options, *frames);
    const files::StrainHeader header = header_of(options, *frames, run.rest());
    files::StrainWriter writer(into.file("strain.h5"), header, frames->count());
    StrainSummary summary = run.measure(writer);
    summary.note = notes_of(options, *frames);
    std::vector<std::string> name;
    for (int k = 0; k < frames->count(); ++k) name.push_back(frames->name(k));
    writer.finish(name);
    summary.path = {into.file("strain.h5"), into.file("strain.json")};
    write_results(summary, header, options, summary.path[1]);
    for (std::string& path : run.write_look(into)) summary.path.push_back(std::move(path));
    return summary;
}

}  // namespace toile::evaluate
