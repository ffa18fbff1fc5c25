#include "generate/validate_projection.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "files/problem_file.h"
#include "files/projection_file.h"
#include "generate/file_structure.h"
#include "prior/inextensibility.h"
#include "prior/quasistatic.h"

namespace toile::generate {
namespace {

using Lines = std::vector<std::string>;
using Span = std::span<const double>;

constexpr int64_t samples_at_once = 16;

bool all_finite(Span value) {
    return std::all_of(value.begin(), value.end(), [](double x) { return std::isfinite(x); });
}
bool all_nan(Span value) {
    return std::all_of(value.begin(), value.end(), [](double x) { return std::isnan(x); });
}

std::optional<prior::RestState> rest_of(const ClothMesh& mesh, Lines& defect) {
    try {
        return prior::rest_state(mesh);
    } catch (const Error& error) {
        defect.push_back(std::string("/mesh: ") + error.what());
        return std::nullopt;
    }
}

std::vector<Feature> projection_table(bool limits, bool gradient) {
    std::vector<Feature> table{
        {"mesh", true, {{"/mesh/triangle", "int32", "F 3"}, {"/mesh/rest_position", "float64", "V 3"}}},
        {"pattern", false, {{"/mesh/pattern_position", "float64", "P 2"}, {"/mesh/pattern_triangle", "int32", "F 3"}}},
        {"mass", false, {{"/mesh/mass", "float64", "V"}}},
        {"samples",
         true,
         {{"/samples/predicted", "float64", "N V 3"},
          {"/samples/projected", "float64", "N V 3"},
          {"/samples/status", "int8", "N"},
          {"/samples/seconds", "float64", "N"},
          {"/samples/iterations", "int32", "N"},
          {"/samples/residual", "float64", "N"},
          {"/model/target_stiffness", "float64", "V"}}}};
    if (limits)
        table.push_back({"inextensibility",
                         true,
                         {{"/model/edge", "int32", "E 2"},
                          {"/model/edge_max_length", "float64", "E"},
                          {"/samples/multiplier", "float64", "N E"}}});
    else
        table.push_back({"quasistatic",
                         true,
                         {{"/model/edge_spring", "int32", "E 2"},
                          {"/model/edge_stiffness", "float64", "E"},
                          {"/model/edge_rest_length", "float64", "E"},
                          {"/model/bending_spring", "int32", "B 2"},
                          {"/model/bending_stiffness", "float64", "B"},
                          {"/model/bending_rest_length", "float64", "B"},
                          {"/model/axial_spring", "int32", "A 4"},
                          {"/model/axial_weight", "float64", "A 2"},
                          {"/model/axial_stiffness", "float64", "A"}}});
    if (!gradient) return table;
    table.push_back({"gradient",
                     true,
                     {{"/samples/loss", "float64", "N"},
                      {"/samples/gradient", "float64", "N V 3"},
                      {"/samples/gradient_seconds", "float64", "N"}}});
    if (limits)
        table.back().field.push_back({"/samples/weakly_active", "int32", "N"});
    else
        for (const Field& field :
             {Field{"/samples/gradient_mu", "float64", "N"}, Field{"/samples/gradient_mu_vertex", "float64", "N V"}})
            table.back().field.push_back(field);
    return table;
}

void check_positive(const char* name, const Eigen::VectorXd& value, bool zero_too, Lines& defect) {
    for (Eigen::Index i = 0; i < value.size(); ++i) {
        if (std::isfinite(value[i]) && (value[i] > 0 || (zero_too && value[i] == 0))) continue;
        defect.push_back(
            fmt::format("{}[{}]: is {}, expected {}", name, i, value[i], zero_too ? "0 or more" : "a positive number"));
        return;
    }
}

template <typename Rows>
void check_vertices(const char* name, const Rows& rows, int vertices, Lines& defect) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        if (rows.row(i).minCoeff() >= 0 && rows.row(i).maxCoeff() < vertices) continue;
        defect.push_back(fmt::format("{}[{}]: refers to a vertex that is not there", name, i));
        return;
    }
}

/// Whether `value` is one multiple of `base`.
bool proportional(const Eigen::VectorXd& value, const Eigen::VectorXd& base) {
    if (value.size() == 0) return true;
    const Eigen::ArrayXd ratio = value.array() / base.array();
    return ratio.maxCoeff() - ratio.minCoeff() <= 1e-9 * ratio.maxCoeff();
}

void check_edges(const char* name, const Edges& edge, const prior::RestState& rest, Lines& defect) {
    if (edge.rows() != rest.edge.rows() || edge != rest.edge)
        defect.push_back(std::string(name) + ": these are not the edges of /mesh");
}

void check_model(const files::ProjectionHeader& header, const prior::RestState& rest, Lines& defect) {
    const int vertices = header.mesh.vertex_count();
    check_positive("/model/target_stiffness", header.target_stiffness, false, defect);
    if (header.limits) {
        check_edges("/model/edge", header.limits->edge, rest, defect);
        check_positive("/model/edge_max_length", header.limits->edge_max_length, false, defect);
        if (defect.empty() && !proportional(header.limits->edge_max_length, rest.edge_rest_length))
            defect.push_back("/model/edge_max_length: is not one multiple of the rest lengths");
        if (defect.empty() && !proportional(header.target_stiffness, rest.mass))
            defect.push_back("/model/target_stiffness: is not proportional to the masses");
        return;
    }
    const files::SpringTables& springs = *header.springs;
    check_edges("/model/edge_spring", springs.edge_spring, rest, defect);
    check_positive("/model/edge_stiffness", springs.edge_stiffness, true, defect);
    if (defect.empty() && !springs.edge_rest_length.isApprox(rest.edge_rest_length, 1e-9))
        defect.push_back("/model/edge_rest_length: these are not the rest lengths of /mesh");
    check_vertices("/model/bending_spring", springs.bending_spring, vertices, defect);
    check_positive("/model/bending_stiffness", springs.bending_stiffness, true, defect);
    check_positive("/model/bending_rest_length", springs.bending_rest_length, true, defect);
    check_vertices("/model/axial_spring", springs.axial_spring, vertices, defect);
    check_positive("/model/axial_stiffness", springs.axial_stiffness, true, defect);
    if (!springs.axial_weight.allFinite()) defect.push_back("/model/axial_weight: is not finite");
}

/// Checks samples against the model of their file.
class ProjectionChecker {
  public:
    explicit ProjectionChecker(const files::ProjectionHeader& header) : header_(header) {
        const int vertices = header.mesh.vertex_count();
        if (header.limits)
            limits_ = {vertices, header.limits->edge, header.limits->edge_max_length, header.target_stiffness};
        else
            springs_ = spring_model();
    }

    /// Sample `i` of `rows`, which has the number `sample` in the file.
    Lines defects(const files::StoredProjection& rows, size_t i, int64_t sample) const {
        const auto width = 3 * static_cast<size_t>(header_.mesh.vertex_count());
        const Span predicted = Span(rows.predicted).subspan(i * width, width);
        const Span projected = Span(rows.projected).subspan(i * width, width);
        Lines lines;
        auto add = [&](const char* name, const std::string& what) {
            lines.push_back(fmt::format("/samples/{}[{}]: {}", name, sample, what));
        };
        const int status = rows.status[i];
        if (status < 0 || status > 2) add("status", fmt::format("is {}, expected 0, 1 or 2", status));
        if (header_.gradient) check_gradient(rows, i, status == 2, add);
        if (status == 2) {
            if (!all_nan(projected)) add("projected", "is not NaN, though the sample was rejected");
            if (all_finite(predicted)) add("status", "is 2, though the prediction is finite");
            return lines;
        }
        if (!all_finite(predicted)) add("status", fmt::format("is {}, though the prediction is not finite", status));
        if (!all_finite(projected)) add("projected", "is not finite");
        if (!lines.empty()) return lines;
        const auto edges = static_cast<size_t>(header_.edge_count());
        const Span multiplier = header_.limits ? Span(rows.multiplier).subspan(i * edges, edges) : Span();
        if (header_.limits) check_limits(projected, multiplier, status == 0, add);
        check_residual(predicted, projected, multiplier, rows.residual[i], status == 0, add);
        return lines;
    }

  private:
    prior::QuasistaticModel spring_model() const {
        const files::SpringTables& s = *header_.springs;
        prior::QuasistaticModel model;
        model.vertex_count = header_.mesh.vertex_count();
        model.edge_spring = s.edge_spring;
        model.edge_stiffness = s.edge_stiffness;
        model.edge_rest_length = s.edge_rest_length;
        model.bending_spring = s.bending_spring;
        model.bending_stiffness = s.bending_stiffness;
        model.bending_rest_length = s.bending_rest_length;
        model.axial_spring = s.axial_spring;
        model.axial_weight = s.axial_weight;
        model.axial_stiffness = s.axial_stiffness;
        model.target_stiffness = header_.target_stiffness;
        model.target_unit = header_.target_stiffness;
        return model;
    }

    template <typename Add>
    void check_gradient(const files::StoredProjection& rows, size_t i, bool rejected, const Add& add) const {
        const auto width = 3 * static_cast<size_t>(header_.mesh.vertex_count());
        const Span gradient = Span(rows.gradient).subspan(i * width, width);
        const bool none = std::isnan(rows.loss[i]);
        if (rejected && !none) add("loss", "is not NaN, though the sample was rejected");
        if (none ? !all_nan(gradient) : !all_finite(gradient))
            add("gradient", none ? "is not NaN where the loss is" : "is not finite");
        if (!none && !(rows.loss[i] >= 0 && std::isfinite(rows.loss[i]))) add("loss", "is not a sum of squares");
    }

    template <typename Add>
    void check_limits(Span projected, Span multiplier, bool converged, const Add& add) const {
        for (Eigen::Index e = 0; e < limits_.edge.rows(); ++e) {
            const auto lambda = multiplier[static_cast<size_t>(e)];
            if (!(lambda >= 0 && std::isfinite(lambda))) {
                add("multiplier", fmt::format("edge {} has {}, expected 0 or more", e, lambda));
                break;
            }
        }
        if (!converged) return;
        const Eigen::Map<const Positions> position(projected.data(), header_.mesh.vertex_count(), 3);
        for (Eigen::Index e = 0; e < limits_.edge.rows(); ++e) {
            const int a = limits_.edge(e, 0), b = limits_.edge(e, 1);
            const double part = (position.row(a) - position.row(b)).norm() / limits_.edge_max_length[e];
            if (part <= 1 + header_.tolerance * (1 + 1e-6)) continue;
            add("projected", fmt::format("edge ({}, {}) is {:.8f} times as long as it may be", a, b, part));
            break;
        }
    }

    template <typename Add>
    void check_residual(Span predicted, Span projected, Span multiplier, double stored, bool converged,
                        const Add& add) const {
        const double residual = header_.limits
                                    ? prior::inextensibility_residual(limits_, predicted, projected, multiplier)
                                    : prior::quasistatic_residual(springs_, predicted, projected);
        if (converged && !(residual <= header_.tolerance * (1 + 1e-6)))
            add("residual", fmt::format("is {:.3e} and not within the tolerance {:.0e}, as status 0 promises", residual,
                                        header_.tolerance));
        // beyond rounding, which depends on the order of sums
        if (!(std::abs(residual - stored) <= 1e-3 * std::max(std::abs(residual), std::abs(stored)) + 1e-12))
            add("residual", fmt::format("is stored as {:.3e}, and is {:.3e}", stored, residual));
    }

    const files::ProjectionHeader& header_;
    prior::InextensibilityModel limits_;  ///< the one of the two that the header has
    prior::QuasistaticModel springs_;
};

void check_samples(const files::ProjectionReader& reader, const ValidateOptions& options, Validation& result) {
    const ProjectionChecker checker(reader.header());
    const int64_t count = reader.sample_count();
    for (int64_t first = 0; first < count; first += samples_at_once) {
        const int64_t here = std::min(samples_at_once, count - first);
        const files::StoredProjection rows = reader.read(first, here);
        std::vector<Lines> lines(static_cast<size_t>(here));
        parallel_for(static_cast<int>(here), std::max(options.jobs, 1),
                     [&](int, int i) { lines[i] = checker.defects(rows, static_cast<size_t>(i), first + i); });
        for (const Lines& one : lines) result.defect.insert(result.defect.end(), one.begin(), one.end());
        result.accepted += static_cast<int>(std::count(rows.status.begin(), rows.status.end(), 0));
        if (options.step) options.step(static_cast<int>(first + here), static_cast<int>(count));
    }
}

Lines structure_of(const std::string& path) {
    const files::Hdf5File file = files::Hdf5File::open(path);
    Lines defect;
    try {
        const bool limits = file.string_attribute("/", "prior") == "inextensibility";
        check_structure(file, projection_table(limits, file.has("/samples/gradient")), defect);
    } catch (const Error& error) {
        defect.push_back(std::string("/: ") + error.what());
    }
    return defect;
}

}  // namespace

Validation validate_problem(const std::string& path, const ValidateOptions& options) {
    Validation result;
    try {
        const files::ProblemFile problem(path);
        rest_of(problem.mesh(), result.defect);
        const auto width = 3 * static_cast<size_t>(problem.mesh().vertex_count());
        result.samples = static_cast<int>(problem.sample_count());
        auto check = [&](const char* name, const std::vector<double>& value, int64_t sample) {
            if (!all_finite(Span(value).first(width)))
                result.defect.push_back(fmt::format("{}[{}]: is not finite", name, sample));
        };
        for (int64_t i = 0; i < problem.sample_count(); ++i) {
            const size_t before = result.defect.size();
            check("/samples/predicted", problem.predicted(i, 1), i);
            if (problem.has_target()) check("/samples/target", problem.target(i, 1), i);
            result.accepted += result.defect.size() == before;
            if (options.step) options.step(static_cast<int>(i + 1), result.samples);
        }
    } catch (const Error& error) {
        result.defect.push_back(error.what() + (error.where().empty() ? "" : " (" + error.where() + ")"));
    }
    return result;
}

Validation validate_projection(const std::string& path, const ValidateOptions& options) {
    Validation result;
    result.defect = structure_of(path);
    if (!result.defect.empty()) return result;
    try {
        const files::ProjectionReader reader(path);
        result.samples = static_cast<int>(reader.sample_count());
        const std::optional<prior::RestState> rest = rest_of(reader.header().mesh, result.defect);
        if (rest) check_model(reader.header(), *rest, result.defect);
        if (result.defect.empty()) check_samples(reader, options, result);
    } catch (const Error& error) {  // a chunk that cannot be read: the file is ours, but damaged
        result.defect.push_back(error.what());
    }
    return result;
}

}  // namespace toile::generate
