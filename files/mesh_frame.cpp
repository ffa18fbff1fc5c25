#include "files/mesh_frame.h"

#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "cloth/error.h"
#include "files/mesh_scene.h"
#include "files/obj_text.h"
#include "files/ply_header.h"
#include "files/trial_run.h"

namespace toile::files {
namespace {

struct Soup {
    std::vector<CGAL::Simple_cartesian<double>::Point_3> point;
    std::vector<std::vector<int>> polygon;
    std::vector<CGAL::IO::Color> face_color, vertex_color;  // CGAL reads them along
};

bool read_soup(const std::string& path, Soup& soup) {
    std::ifstream file(path, std::ios::binary);
    return CGAL::IO::read_PLY(file, soup.point, soup.polygon, soup.face_color, soup.vertex_color);
}

MeshFrame frame_of(const Soup& soup, const std::string& path) {
    MeshFrame frame;
    const auto count = static_cast<std::int64_t>(soup.point.size());
    frame.position.resize(count, 3);
    for (std::int64_t v = 0; v < count; ++v)
        frame.position.row(v) << soup.point[v].x(), soup.point[v].y(), soup.point[v].z();
    std::vector<int> corner;
    for (size_t f = 0; f < soup.polygon.size(); ++f) {
        const std::vector<int>& polygon = soup.polygon[f];
        for (const int v : polygon)
            if (v < 0 || v >= count)
                throw Error("face " + std::to_string(f) + " refers to vertex " + std::to_string(v) + " of " +
                                std::to_string(count),
                            path);
        for (size_t k = 2; k < polygon.size(); ++k)
            corner.insert(corner.end(), {polygon[0], polygon[k - 1], polygon[k]});
    }
    frame.triangle = Eigen::Map<const Triangles>(corner.data(), static_cast<std::int64_t>(corner.size() / 3), 3);
    return frame;
}

MeshFrame read_ply(const std::string& path) {
    check_ply_header(path);
    // CGAL trusts the counts of a file.
    const auto megabytes = static_cast<int>(std::min<std::uintmax_t>(std::filesystem::file_size(path) >> 20, 10'000));
    const std::string complaint = trial_run(path, 5 + 2 * megabytes, [&]() -> std::string {
        Soup soup;
        return read_soup(path, soup) ? "" : "unreadable";
    });
    Soup soup;
    if (!complaint.empty() || !read_soup(path, soup))
        throw Error("cannot read a mesh from the file: it ends too early, or is damaged", path);
    return frame_of(soup, path);
}

}  // namespace

MeshFrame read_mesh_frame(const std::string& path) {
    check_readable(path);
    MeshFrame frame;
    if (has_extension(path, ".obj")) {
        ObjShape shape = read_obj_shape(path);
        frame = {std::move(shape.position), std::move(shape.triangle)};
    } else if (has_extension(path, ".ply")) {
        frame = read_ply(path);
    } else {
        throw Error("this is neither .obj nor .ply", path);
    }
    if (frame.triangle.rows() == 0) throw Error("the file has no faces", path);
    for (Eigen::Index v = 0; v < frame.position.rows(); ++v)
        if (!frame.position.row(v).allFinite()) throw Error("vertex " + std::to_string(v) + " is not finite", path);
    return frame;
}

}  // namespace toile::files
