#include "generate/single.h"

#include <filesystem>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "generate/scene.h"

namespace toile::generate {

void check_mesh_path(const std::string& path) {
    const std::filesystem::path target(path);
    const std::string extension = target.extension().string();
    if (extension != ".obj" && extension != ".ply" && extension != ".glb")
        throw Error("meshes are written as .obj, .ply or .glb, not \"" + extension + "\"", path);
    const std::filesystem::path folder = target.parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
        throw Error("there is no folder to write to", folder.string());
    if (std::filesystem::is_directory(target)) throw Error("this is a folder, a file name is expected", path);
}

namespace {

void check_pose(const Scene& scene, int number) {
    const std::string& where = scene.config.file;
    if (!scene.body) throw Error("this scene has no [body], so it has no poses", where);
    if (!scene.poses) throw Error("this scene has no [poses]", where);
    if (number < 0 || number >= scene.poses->count())
        throw Error("there is no pose " + std::to_string(number) + ", the scene has 0 to " +
                        std::to_string(scene.poses->count() - 1),
                    "--pose");
}

}  // namespace

void write_posed_body(const SceneConfig& config, int number, const std::string& path) {
    check_mesh_path(path);
    const Scene scene = build_posed_body(config);
    check_pose(scene, number);
    const Positions posed = skin::skin_positions(*scene.body, scene.poses->pose(number), config.body->skinning);
    files::write_mesh(path, scene.body->triangle, posed);
}

simulate::DrapeResult simulate_once(const SceneConfig& config, int number, const std::string& path) {
    check_mesh_path(path);
    Scene scene = build_scene(config);
    if (number >= 0) check_pose(scene, number);
    const std::unique_ptr<simulate::Draper> draper = make_draper(scene);
    simulate::DrapeResult result = draper->drape_neutral();
    if (number >= 0) result = draper->drape(result.position, scene.poses->pose(number));
    if (result.position.allFinite()) files::write_mesh(path, scene.garment.mesh.triangle, result.position);
    return result;
}

}  // namespace toile::generate
