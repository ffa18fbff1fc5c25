#include "evaluate/stability_replay.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "cloth/error.h"
#include "evaluate/stability_priors.h"
#include "files/config_file.h"
#include "files/hdf5_file.h"
#include "files/mesh_file.h"
#include "files/problem_file.h"
#include "generate/dataset_header.h"
#include "generate/single.h"
#include "prior/quasistatic.h"
#include "prior/rest_state.h"

namespace toile::evaluate {

namespace fs = std::filesystem;

namespace {

constexpr const char* replay_folder = "stability_replay";

/// Letters and digits, all else as one underscore: a file's name on any system.
std::string as_file_name(const std::string& text) {
    std::string name;
    for (const char c : text) {
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '.')
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    return name;
}

std::string make_replay_folder(const std::string& folder) {
    const fs::path path = fs::path(folder) / replay_folder;
    std::error_code failure;
    fs::create_directory(path, failure);
    if (failure) throw Error("the folder of replays cannot be made: " + failure.message(), path.string());
    return path.string();
}

/// The table [case] of a replay's configuration.
struct CaseConfig {
    std::string name, solver;
    StabilityBudget budget;
    std::string text, hash;

    static CaseConfig from(const std::string& text, const std::string& source,
                           const std::vector<std::string>& overrides) {
        const files::ConfigFile file = files::ConfigFile::from_text(text, source, overrides);
        CaseConfig config;
        files::ConfigTable table = file.root().section("case", "of the stability suite");
        table.text("name", config.name, "which");
        table.text("solver", config.solver, "that it is draped with");
        table.integer_or("max_iterations", config.budget.iterations, "scene's", {.lower = 1, .upper = 1000000});
        table.integer_or("tries", config.budget.tries, "scene's", {.lower = 0, .upper = 3});
        file.refuse_unknown_keys();
        config.text = file.resolved(files::ConfigFile::Paths::absolute);
        config.hash = file.hash();
        return config;
    }
};

CaseConfig config_of(const StabilityOutcome& one, const StabilityBudget& budget) {
    std::string text = fmt::format("[case]\nname = '{}'\nsolver = \"{}\"\n", one.name, one.solver);
    if (budget.iterations) text += fmt::format("max_iterations = {}\n", *budget.iterations);
    if (budget.tries) text += fmt::format("tries = {}\n", *budget.tries);
    return CaseConfig::from(text, "stability suite", {});
}

StabilityCase case_named(const std::string& name, const std::string& where) {
    for (StabilityCase& one : stability_cases())
        if (one.name == name) return std::move(one);
    throw Error("this program's stability suite has no case \"" + name + "\"", where,
                "toile evaluate stability lists its cases");
}

/// μ' and masses m' with μ' m'_i / mean(m') = μ_i m_i / mean(m): the springs to the prediction of a μ by vertex.
double put_mu_into_mass(const StressProblem& problem, ClothMesh& mesh) {
    const Eigen::VectorXd mass = prior::rest_state(problem.mesh).mass;
    mesh.mass = mass.cwiseProduct(problem.mu_of_vertices());
    const double mu = mesh.mass.mean() / mass.mean();
    mesh.mass *= mass.mean() / mesh.mass.mean();
    return mu;
}

/// The keys of `toile project` that give the problem's model.
std::string project_keys(const StressProblem& problem, StressRoute route, double mu) {
    std::string keys =
        fmt::format(" --set method={} --set tolerance={}", method_name(problem.prior, route), problem.tolerance);
    if (problem.prior == PriorKind::inextensibility)
        return keys + fmt::format(" --set stretch_limit={}", problem.stretch_limit);
    const prior::QuasistaticStiffness k;
    return keys + fmt::format(
                      " --set mu={} --set stretch_stiffness={} --set bending_stiffness={} "
                      "--set axial_stiffness={}",
                      mu, k.stretch * problem.stretch, k.bending * problem.bending, k.axial * problem.axial);
}

/// r_T = r* - g / 2: the squared distance to it has the gradient g.
std::vector<double> target_of(const StressSolution& solution) {
    if (solution.loss_gradient.size() != solution.position.size()) return {};
    std::vector<double> target = solution.position;
    for (std::size_t k = 0; k < target.size(); ++k) target[k] -= 0.5 * solution.loss_gradient[k];
    return target;
}

}  // namespace

void keep_case(const std::string& folder, const StabilityScene* start, const simulate::DrapeResult* end,
               const StabilityBudget& budget, StabilityOutcome& outcome) {
    if (!start || !start->drape.mesh.rest_position.allFinite()) return;
    const CaseConfig config = config_of(outcome, budget);
    files::ReplayRecord record;
    record.config = config.text;
    record.config_hash = config.hash;
    record.program_version = TOILE_VERSION;
    record.reason = outcome.status;
    record.suite_case = outcome.name;
    record.mesh = start->drape.mesh;
    record.pose = start->pose ? Positions(*start->pose) : Positions(0, 3);
    record.start = start->drape.mesh.rest_position;
    record.cloth = end ? end->position : record.start;
    if (end) record.certificate = generate::certificate_record(end->certificate);
    const std::string name = as_file_name(outcome.solver + "_" + outcome.name) + ".h5";
    files::write_replay((fs::path(make_replay_folder(folder)) / name).string(), record);
    outcome.replay = (fs::path(replay_folder) / name).string();
    outcome.command = "toile simulate --replay " + outcome.replay + " --out cloth.obj";
}

void keep_problem(const std::string& folder, const StressProblem& problem, const StressDraw& draw, StressRoute route,
                  const StressSolution& solution, std::vector<StabilityOutcome>& outcomes) {
    if (std::all_of(outcomes.begin(), outcomes.end(), [](const StabilityOutcome& one) { return one.passed(); })) return;
    ClothMesh mesh = problem.mesh;
    const double mu =
        problem.mu_varies && problem.prior == PriorKind::quasistatic ? put_mu_into_mass(problem, mesh) : problem.mu;
    const std::string name = fmt::format("{}_{}_seed_{}_problem_{:06}.h5", evaluate::name(problem.prior),
                                         method_name(problem.prior, route), draw.seed, problem.number);
    const std::vector<double> target = target_of(solution);
    files::write_problem((fs::path(make_replay_folder(folder)) / name).string(), mesh, problem.predicted, target);
    const std::string path = (fs::path(replay_folder) / name).string();
    const std::string command =
        fmt::format("toile project {} {} --out projection.h5{}{}", evaluate::name(problem.prior), path,
                    target.empty() ? "" : " --gradient", project_keys(problem, route, mu));
    for (StabilityOutcome& one : outcomes) {
        if (one.passed()) continue;
        one.replay = path;
        one.command = command;
    }
}

void remove_other_replays(const std::string& folder, const std::vector<StabilityOutcome>& outcomes) {
    std::set<std::string> kept;
    for (const StabilityOutcome& one : outcomes) kept.insert(one.replay);
    const fs::path path = fs::path(folder) / replay_folder;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored))
        if (entry.path().extension() == ".h5" &&
            !kept.count((fs::path(replay_folder) / entry.path().filename()).string()))
            fs::remove(entry.path(), ignored);
    if (fs::is_empty(path, ignored)) fs::remove(path, ignored);
}

bool is_case_replay(const std::string& path) {
    const files::Hdf5File file = files::Hdf5File::open(path);
    return files::is_replay(file) && file.has_attribute("/", "case");
}

ReplayedCase replay_case(const std::string& replay, const std::vector<std::string>& overrides,
                         const std::string& path) {
    generate::check_mesh_path(path);
    ReplayedCase again;
    generate::Replayed& replayed = again.replayed;
    replayed.recorded = files::read_replay(replay);
    const CaseConfig config = CaseConfig::from(replayed.recorded.config, replay, overrides);
    const StabilityScene scene = case_scene(case_named(config.name, replay), config.solver, config.budget);
    replayed.same_inputs = config.hash == replayed.recorded.config_hash &&
                           scene.drape.mesh.rest_position == replayed.recorded.start &&
                           scene.drape.mesh.mass == replayed.recorded.mesh.mass &&
                           scene.drape.mesh.pattern_position == replayed.recorded.mesh.pattern_position;
    again.outcome.name = config.name;
    again.outcome.solver = config.solver;
    replayed.drape = drape_case(scene, again.outcome);
    replayed.same_cloth = replayed.drape.position == replayed.recorded.cloth;
    replayed.same_certificate = files::certificate_bytes(generate::certificate_record(replayed.drape.certificate)) ==
                                files::certificate_bytes(replayed.recorded.certificate);
    if (replayed.drape.position.allFinite())
        files::write_mesh(path, scene.drape.mesh.triangle, replayed.drape.position);
    return again;
}

}  // namespace toile::evaluate
