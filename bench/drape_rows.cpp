#include "bench/drape_rows.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <regex>

#include "bench/drape_scene.h"
#include "bench/peak_memory.h"
#include "cloth/error.h"
#include "evaluate/solver_settings.h"

namespace toile::bench {
namespace {

using simulate::DrapeScene;

/// A row that waits for being measured.
struct Row {
    std::string name;
    std::function<DrapeTiming()> measure;
};
using Rows = std::vector<Row>;

/// Of the T-shirt that solvers are compared on, some 400 vertices [m]: their tightest settings take minutes there.
constexpr double solver_edge_length = 0.048;

DrapeScene scene_of_size(const std::string& name) {
    for (const DrapeSize& size : drape_sizes(true))
        if (size.name == name) return shirt_scene(size.edge_length);
    throw Error("there is no size " + name);
}

void add_sizes(Rows& rows, const DrapeRowOptions& options) {
    for (const DrapeSize& size : drape_sizes(options.large))
        rows.push_back({"drape/" + size.name, [size, count = options.poses] {
                            const DrapeScene scene = shirt_scene(size.edge_length);
                            return time_drapes(scene, arm_poses(*scene.body, count));
                        }});
}

void add_solvers(Rows& rows, const DrapeRowOptions& options) {
    const int count = std::min(options.poses, 3);
    const auto reference = std::make_shared<std::vector<Positions>>();
    for (const evaluate::SolverSetting& setting : evaluate::solver_settings(evaluate::SettingChoice::main))
        rows.push_back({"solver/" + setting.solver + "/" + setting.name, [=] {
                            DrapeScene scene = shirt_scene(solver_edge_length);
                            scene.ladder.tries = 0;  // or what does not rest would be timed four times
                            const std::vector<skin::Pose> poses = arm_poses(*scene.body, count);
                            if (reference->empty()) {
                                DrapeScene tight = scene;
                                evaluate::make_tightest(tight.solver, tight.schedule);
                                time_drapes(tight, poses, 1, {}, reference.get());
                            }
                            setting.apply(scene.solver, scene.schedule);
                            return time_drapes(scene, poses, 1, *reference);
                        }});
}

void add_savings(Rows& rows, const DrapeRowOptions& options) {
    rows.push_back({"without/self_contact", [count = options.poses] {
                        DrapeScene scene = scene_of_size(table_size);
                        scene.self_contact.reset();
                        scene.gate.self_intersections.reset();  // or each drape would climb the ladder
                        return time_drapes(scene, arm_poses(*scene.body, count));
                    }});
    rows.push_back({"without/body", [] { return time_drapes(patch_scene(3000), {}, 3); }});
    rows.push_back({"without/body_and_self_contact", [] {
                        DrapeScene scene = patch_scene(3000);
                        scene.self_contact.reset();
                        return time_drapes(scene, {}, 3);
                    }});
}

double measure_memory() {
    return peak_memory_of([] {
        const DrapeScene scene = scene_of_size(table_size);
        return time_drapes(scene, arm_poses(*scene.body, 2)).refused.empty();
    });
}

}  // namespace

DrapeResults measure_rows(const DrapeRowOptions& options) {
    std::regex wanted;
    try {
        wanted = std::regex(options.filter);
    } catch (const std::regex_error&) {
        throw Error("\"" + options.filter + "\" is not a regular expression", "--filter");
    }
    DrapeResults results;
    if (std::regex_search("memory", wanted)) results.peak_memory = measure_memory();
    Rows rows;
    add_sizes(rows, options);
    add_solvers(rows, options);
    add_savings(rows, options);
    for (const Row& row : rows)
        if (std::regex_search(row.name, wanted)) results.timing[row.name] = row.measure();
    return results;
}

}  // namespace toile::bench
