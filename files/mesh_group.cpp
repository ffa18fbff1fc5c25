#include "files/mesh_group.h"

#include <algorithm>

#include "files/hdf5_numbers.h"

namespace toile::files {
namespace {

template <typename Rows, typename T>
Rows rows_of(const Array<T>& array) {
    Rows rows(array.shape[0], array.shape[1]);
    std::copy(array.value.begin(), array.value.end(), rows.data());
    return rows;
}

}  // namespace

void write_mesh_group(Hdf5File& file, const ClothMesh& mesh, int deflate) {
    const Storage storage{deflate, {}};
    const int64_t faces = mesh.triangle_count(), vertices = mesh.vertex_count();
    file.write("/mesh/triangle", mesh.triangle.data(), {faces, 3}, storage);
    file.write("/mesh/rest_position", mesh.rest_position.data(), {vertices, 3}, storage);
    if (mesh.pattern_position.rows() > 0) {
        file.write("/mesh/pattern_position", mesh.pattern_position.data(), {mesh.pattern_position.rows(), 2}, storage);
        file.write("/mesh/pattern_triangle", mesh.pattern_triangle.data(), {faces, 3}, storage);
    }
    if (mesh.mass.size() > 0) file.write("/mesh/mass", mesh.mass.data(), {vertices}, storage);
}

ClothMesh read_mesh_group(const Hdf5File& file) {
    ClothMesh mesh;
    mesh.triangle = rows_of<Triangles>(file.read<int>("/mesh/triangle", {any_size, 3}));
    mesh.rest_position = rows_of<Positions>(read_numbers(file, "/mesh/rest_position", {any_size, 3}));
    if (file.has("/mesh/pattern_position") || file.has("/mesh/pattern_triangle")) {
        mesh.pattern_position = rows_of<PlanePositions>(read_numbers(file, "/mesh/pattern_position", {any_size, 2}));
        mesh.pattern_triangle = rows_of<Triangles>(file.read<int>("/mesh/pattern_triangle", {mesh.triangle.rows(), 3}));
    }
    if (file.has("/mesh/mass")) {
        const Array<double> mass = read_numbers(file, "/mesh/mass", {mesh.rest_position.rows()});
        mesh.mass = Eigen::Map<const Eigen::VectorXd>(mass.value.data(), mesh.rest_position.rows());
    }
    return mesh;
}

}  // namespace toile::files
