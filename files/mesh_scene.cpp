#include "files/mesh_scene.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/trial_run.h"

namespace toile::files {
void check_readable(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        throw Error(
            errno == ENOENT ? "the file does not exist" : std::string("cannot read the file: ") + std::strerror(errno),
            path);
    if (S_ISDIR(status.st_mode)) throw Error("this is a folder, not a mesh file", path);
    if (!std::ifstream(path, std::ios::binary)) throw Error("cannot open the file", path);
    if (status.st_size == 0) throw Error("the file is empty", path);
}

bool has_extension(const std::string& path, const std::string& extension) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending == extension;
}

std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) >= 0x7f) c = ' ';
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
    return text.size() > 160 ? text.substr(0, 160) + " ..." : text;
}

const aiScene* open_scene(Assimp::Importer& importer, const std::string& path, unsigned post_processing) {
    check_readable(path);
    // assimp's assertions are on in Debian's build, and some damaged files send it round in circles or free memory
    // twice.
    const auto megabytes = static_cast<int>(std::min<std::uintmax_t>(std::filesystem::file_size(path) >> 20, 10'000));
    const std::string complaint = trial_run(path, 5 + 2 * megabytes, [&]() -> std::string {
        const aiScene* scene = importer.ReadFile(path, post_processing);
        const std::string reason = importer.GetErrorString();
        const bool usable = scene && scene->mRootNode;
        importer.FreeScene();
        return usable ? "" : reason.empty() ? "unknown format" : reason;
    });
    const aiScene* scene = complaint.empty() ? importer.ReadFile(path, post_processing) : nullptr;
    if (!scene) throw Error("cannot read a mesh from the file: " + one_line(complaint), path);
    return scene;
}

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
    Eigen::Matrix4d out;
    for (unsigned row = 0; row < 4; ++row)
        for (unsigned column = 0; column < 4; ++column) out(row, column) = m[row][column];
    return out;
}

void check_scene_mesh(const aiMesh& mesh, const std::string& path) {
    const std::string name = mesh.mName.length ? " of mesh '" + std::string(mesh.mName.C_Str()) + "'" : "";
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const aiVector3D& p = mesh.mVertices[v];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            throw Error("vertex " + std::to_string(v) + name + " is not finite", path);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
        for (unsigned corner = 0; corner < mesh.mFaces[f].mNumIndices; ++corner)
            if (mesh.mFaces[f].mIndices[corner] >= mesh.mNumVertices)
                throw Error("face " + std::to_string(f) + name + " refers to vertex " +
                                std::to_string(mesh.mFaces[f].mIndices[corner]) + " of " +
                                std::to_string(mesh.mNumVertices),
                            path);
}

}  // namespace toile::files
