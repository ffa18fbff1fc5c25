#include "bench/drape_rows.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <regex>

#include "bench/drape_scene.h"
#include "bench/peak_memory.h"
#include "cloth/error.h"

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

/// Where `implicit` comes to rest with far smaller steps and tolerances than any row has.
DrapeScene tightest(DrapeScene scene) {
    scene.solver.solver = "implicit";
    scene.solver.residual_tolerance = 1e-7;
    scene.solver.max_iterations = 20000;
    scene.solver.time_step *= 0.25;
    scene.schedule.joint_step *= 0.25;
    scene.schedule.path_tolerance *= 0.01;
    scene.schedule.path_iterations = 30;
    return scene;
}

/// Each solver in settings from quick to exact.
struct Setting {
    std::string solver, name;
    std::function<void(DrapeScene&)> change;
};
std::vector<Setting> settings() {
    std::vector<Setting> list;
    for (const double tolerance : {1e-2, 5e-4, 1e-5})
        list.push_back({"implicit", "tolerance_" + std::to_string(tolerance).substr(0, 8), [tolerance](DrapeScene& s) {
                            s.solver.residual_tolerance = tolerance;
                            s.solver.max_iterations = 5000;
                        }});
    for (const int substeps : {5, 20, 80})
        list.push_back({"xpbd", "substeps_" + std::to_string(substeps),
                        [substeps](DrapeScene& s) { s.solver.xpbd.substeps = substeps; }});
    for (const int refinement : {1, 2, 4, 8})
        list.push_back({"bullet", "substep_1/" + std::to_string(500 * refinement), [refinement](DrapeScene& s) {
                            s.solver.bullet.substep = 0.002 / refinement;
                            s.solver.bullet.settle_substeps *= refinement;
                        }});
    return list;
}

void add_solvers(Rows& rows, const DrapeRowOptions& options) {
    const int count = std::min(options.poses, 3);
    const auto reference = std::make_shared<std::vector<Positions>>();
    for (const Setting& setting : settings())
        rows.push_back({"solver/" + setting.solver + "/" + setting.name, [=] {
                            DrapeScene scene = shirt_scene(solver_edge_length);
                            scene.ladder.tries = 0;  // or what does not rest would be timed four times
                            const std::vector<skin::Pose> poses = arm_poses(*scene.body, count);
                            if (reference->empty()) time_drapes(tightest(scene), poses, 1, {}, reference.get());
                            scene.solver.solver = setting.solver;
                            setting.change(scene);
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
