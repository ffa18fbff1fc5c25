#include <algorithm>

#include "cloth/error.h"
#include "files/mesh_group.h"
#include "files/projection_file.h"

namespace toile::files {
namespace {

template <typename Rows>
Rows read_rows_of(const Hdf5File& file, const std::string& name, int64_t rows) {
    using Value = typename Rows::Scalar;
    const Array<Value> array = file.read<Value>(name, {rows, Rows::ColsAtCompileTime});
    Rows value(array.shape[0], Rows::ColsAtCompileTime);
    std::copy(array.value.begin(), array.value.end(), value.data());
    return value;
}

Eigen::VectorXd read_column(const Hdf5File& file, const std::string& name, int64_t rows) {
    const Array<double> array = file.read<double>(name, {rows});
    return Eigen::Map<const Eigen::VectorXd>(array.value.data(), array.shape[0]);
}

SpringTables read_springs(const Hdf5File& file) {
    SpringTables springs;
    springs.edge_spring = read_rows_of<Edges>(file, "/model/edge_spring", any_size);
    springs.edge_stiffness = read_column(file, "/model/edge_stiffness", springs.edge_spring.rows());
    springs.edge_rest_length = read_column(file, "/model/edge_rest_length", springs.edge_spring.rows());
    springs.bending_spring = read_rows_of<Edges>(file, "/model/bending_spring", any_size);
    springs.bending_stiffness = read_column(file, "/model/bending_stiffness", springs.bending_spring.rows());
    springs.bending_rest_length = read_column(file, "/model/bending_rest_length", springs.bending_spring.rows());
    springs.axial_spring = read_rows_of<decltype(springs.axial_spring)>(file, "/model/axial_spring", any_size);
    springs.axial_weight =
        read_rows_of<decltype(springs.axial_weight)>(file, "/model/axial_weight", springs.axial_spring.rows());
    springs.axial_stiffness = read_column(file, "/model/axial_stiffness", springs.axial_spring.rows());
    return springs;
}

ProjectionHeader read_header(const Hdf5File& file) {
    if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != "toile")
        throw Error("this HDF5 file is not one of toile's: its attribute \"format\" is not \"toile\"", file.path());
    const int64_t version = file.integer_attribute("/", "version");
    if (version != projection_version)
        throw Error("the file has version " + std::to_string(version) + ", and this program reads version " +
                        std::to_string(projection_version),
                    file.path());
    ProjectionHeader header;
    header.tolerance = file.number_attribute("/", "tolerance");
    header.config = file.string_attribute("/", "config");
    header.config_hash = file.string_attribute("/", "config_hash");
    header.program_version = file.string_attribute("/", "program_version");
    header.mesh = read_mesh_group(file);
    header.target_stiffness = read_column(file, "/model/target_stiffness", header.mesh.vertex_count());
    header.gradient = file.has("/samples/gradient");
    const std::string prior = file.string_attribute("/", "prior");
    if (prior == "inextensibility") {
        LimitTables limits;
        limits.edge = read_rows_of<Edges>(file, "/model/edge", any_size);
        limits.edge_max_length = read_column(file, "/model/edge_max_length", limits.edge.rows());
        header.limits = std::move(limits);
    } else if (prior == "quasistatic") {
        header.springs = read_springs(file);
    } else {
        throw Error("there is no prior " + prior, file.path() + ":/");
    }
    return header;
}

}  // namespace

ProjectionReader::ProjectionReader(const std::string& path) : file_(Hdf5File::open(path)), header_(read_header(file_)) {
    const Shape shape = file_.shape("/samples/projected"), expected{any_size, header_.mesh.vertex_count(), 3};
    if (shape.size() != 3 || shape[1] != expected[1] || shape[2] != 3)
        throw Error("/samples/projected has shape " + shape_text(shape) + ", not " + shape_text(expected),
                    path + ":/samples/projected");
    sample_count_ = shape[0];
}

StoredProjection ProjectionReader::read(int64_t first, int64_t count) const {
    auto numbers = [&](const char* name, int64_t size) {
        Array<double> array = file_.read_rows<double>(name, first, count);
        if (static_cast<int64_t>(array.value.size()) != count * size)
            throw Error(name + (" has shape " + shape_text(file_.shape(name))) + ", which does not fit the model",
                        file_.path() + ":" + name);
        return std::move(array.value);
    };
    const int64_t positions = int64_t{3} * header_.mesh.vertex_count();
    StoredProjection rows;
    rows.predicted = numbers("/samples/predicted", positions);
    rows.projected = numbers("/samples/projected", positions);
    rows.seconds = numbers("/samples/seconds", 1);
    rows.residual = numbers("/samples/residual", 1);
    rows.status = file_.read_rows<int8_t>("/samples/status", first, count).value;
    if (header_.limits) rows.multiplier = numbers("/samples/multiplier", header_.edge_count());
    if (header_.gradient) {
        rows.loss = numbers("/samples/loss", 1);
        rows.gradient = numbers("/samples/gradient", positions);
    }
    return rows;
}

}  // namespace toile::files
