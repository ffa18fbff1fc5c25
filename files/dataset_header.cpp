#include "files/dataset_header.h"

#include <algorithm>

#include "cloth/error.h"
#include "files/mesh_group.h"

namespace toile::files {
namespace {

void write_body_group(Hdf5File& file, const DatasetBody& body, int deflate) {
    const Storage storage{deflate, {}};
    const auto joints = static_cast<int64_t>(body.joint_name.size());
    const auto weights = static_cast<int64_t>(body.weight_value.size());
    file.write("/body/triangle", body.triangle.data(), {body.triangle.rows(), 3}, storage);
    file.write("/body/rest_position", body.rest_position.data(), {body.rest_position.rows(), 3}, storage);
    file.write_strings("/body/joint_name", body.joint_name);
    file.write("/body/joint_parent", body.joint_parent, {joints}, storage);
    std::vector<double> bind;
    for (const Eigen::Matrix4d& matrix : body.joint_bind)
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) bind.push_back(matrix(row, column));
    file.write("/body/joint_bind", bind, {joints, 4, 4}, storage);
    file.write("/body/weight_vertex", body.weight_vertex, {weights}, storage);
    file.write("/body/weight_joint", body.weight_joint, {weights}, storage);
    file.write("/body/weight_value", body.weight_value, {weights}, storage);
}

void write_root(Hdf5File& file, const DatasetHeader& header) {
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", dataset_version);
    file.set_attribute("/", "config", header.config);
    file.set_attribute("/", "config_hash", header.config_hash);
    file.set_attribute("/", "program_version", header.program_version);
    file.set_attribute("/", "seed", header.seed);
    file.set_attribute("/", "reasons", header.reasons);
}

template <typename Rows, typename T>
Rows rows_of(const Array<T>& array) {
    Rows rows(array.shape[0], array.shape[1]);
    std::copy(array.value.begin(), array.value.end(), rows.data());
    return rows;
}

DatasetBody read_body_group(const Hdf5File& file) {
    DatasetBody body;
    body.triangle = rows_of<Triangles>(file.read<int>("/body/triangle", {any_size, 3}));
    body.rest_position = rows_of<Positions>(file.read<double>("/body/rest_position", {any_size, 3}));
    body.joint_name = file.read_strings("/body/joint_name");
    const auto joints = static_cast<int64_t>(body.joint_name.size());
    body.joint_parent = file.read<int>("/body/joint_parent", {joints}).value;
    const std::vector<double> bind = file.read<double>("/body/joint_bind", {joints, 4, 4}).value;
    for (int64_t j = 0; j < joints; ++j)
        body.joint_bind.push_back(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&bind[16 * j]));
    body.weight_vertex = file.read<int>("/body/weight_vertex", {any_size}).value;
    const auto weights = static_cast<int64_t>(body.weight_vertex.size());
    body.weight_joint = file.read<int>("/body/weight_joint", {weights}).value;
    body.weight_value = file.read<double>("/body/weight_value", {weights}).value;
    return body;
}

DatasetImage read_image_group(const Hdf5File& file, int64_t pattern_positions) {
    DatasetImage image;
    image.pattern_pixel = rows_of<Positions>(file.read<double>("/image/pattern_pixel", {pattern_positions, 3}));
    const auto mask = file.read<uint8_t>("/image/mask", {any_size, any_size, any_size});
    if (mask.shape[1] != mask.shape[2])
        throw Error("/image/mask has shape " + shape_text(mask.shape) + ", which is not square",
                    file.path() + ":/image/mask");
    image.layers = static_cast<int>(mask.shape[0]);
    image.size = static_cast<int>(mask.shape[1]);
    image.mask = mask.value;
    return image;
}

template <typename Rows>
bool same(const Rows& a, const Rows& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

bool same_mesh(const ClothMesh& a, const ClothMesh& b) {
    return same(a.triangle, b.triangle) && same(a.rest_position, b.rest_position) &&
           same(a.pattern_position, b.pattern_position) && same(a.pattern_triangle, b.pattern_triangle) &&
           same(a.mass, b.mass);
}

bool same_body(const std::optional<DatasetBody>& a, const std::optional<DatasetBody>& b) {
    if (!a || !b) return !a && !b;
    return same(a->triangle, b->triangle) && same(a->rest_position, b->rest_position) &&
           a->joint_name == b->joint_name && a->joint_parent == b->joint_parent && a->joint_bind == b->joint_bind &&
           a->weight_vertex == b->weight_vertex && a->weight_joint == b->weight_joint &&
           a->weight_value == b->weight_value;
}

bool same_embedding(const std::optional<DatasetEmbedding>& a, const std::optional<DatasetEmbedding>& b) {
    if (!a || !b) return !a && !b;
    return a->triangle == b->triangle && same(a->barycentric, b->barycentric);
}

bool same_image(const std::optional<DatasetImage>& a, const std::optional<DatasetImage>& b) {
    if (!a || !b) return !a && !b;
    return a->size == b->size && a->layers == b->layers && a->mask == b->mask &&
           same(a->pattern_pixel, b->pattern_pixel);
}

}  // namespace

void write_dataset_header(Hdf5File& file, const DatasetHeader& header, int deflate) {
    const Storage storage{deflate, {}};
    write_root(file, header);
    write_mesh_group(file, header.mesh, deflate);
    if (header.body) write_body_group(file, *header.body, deflate);
    if (header.embedding) {
        const auto vertices = static_cast<int64_t>(header.embedding->triangle.size());
        file.write("/embedding/triangle", header.embedding->triangle, {vertices}, storage);
        file.write("/embedding/barycentric", header.embedding->barycentric.data(), {vertices, 3}, storage);
    }
    if (header.image) {
        const DatasetImage& image = *header.image;
        file.write("/image/pattern_pixel", image.pattern_pixel.data(), {image.pattern_pixel.rows(), 3}, storage);
        file.write("/image/mask", image.mask, {image.layers, image.size, image.size}, storage);
    }
}

DatasetHeader read_dataset_header(const Hdf5File& file) {
    if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != "toile")
        throw Error("this HDF5 file is not one of toile's: its attribute \"format\" is not \"toile\"", file.path());
    const int64_t version = file.integer_attribute("/", "version");
    if (version != dataset_version)
        throw Error("the file has version " + std::to_string(version) + ", and this program reads version " +
                        std::to_string(dataset_version),
                    file.path());
    DatasetHeader header;
    header.config = file.string_attribute("/", "config");
    header.config_hash = file.string_attribute("/", "config_hash");
    header.program_version = file.string_attribute("/", "program_version");
    header.seed = file.integer_attribute("/", "seed");
    header.reasons = file.strings_attribute("/samples/status", "reasons");
    header.duplicate_angle = file.number_attribute("/samples/split", "duplicate_angle");
    for (const std::string& key : file.attributes("/certificate"))
        header.gate[key] = file.number_attribute("/certificate", key);
    file.shape("/mesh/pattern_position");  // only a data set's mesh must have a pattern
    header.mesh = read_mesh_group(file);
    if (file.has("/body")) header.body = read_body_group(file);
    if (file.has("/embedding")) {
        const int64_t vertices = header.mesh.vertex_count();
        header.embedding =
            DatasetEmbedding{file.read<int>("/embedding/triangle", {vertices}).value,
                             rows_of<Positions>(file.read<double>("/embedding/barycentric", {vertices, 3}))};
    }
    if (file.has("/image")) {
        header.image = read_image_group(file, header.mesh.pattern_position.rows());
        const std::vector<double> error = file.numbers_attribute("/samples/image", "resampling_error");
        if (error.size() != 2)
            throw Error("resampling_error does not hold two numbers", file.path() + ":/samples/image");
        header.resampling_error = {error[0], error[1]};
    }
    return header;
}

std::string header_difference(const DatasetHeader& a, const DatasetHeader& b) {
    if (a.config_hash != b.config_hash || a.config != b.config) return "configuration";
    if (a.program_version != b.program_version) return "program version";
    if (a.seed != b.seed) return "seed";
    if (a.reasons != b.reasons) return "list of reasons";
    if (a.gate != b.gate) return "gate";
    if (a.duplicate_angle != b.duplicate_angle) return "duplicate_angle";
    if (!same_mesh(a.mesh, b.mesh)) return "/mesh";
    if (!same_body(a.body, b.body)) return "/body";
    if (!same_embedding(a.embedding, b.embedding)) return "/embedding";
    if (!same_image(a.image, b.image)) return "/image";
    return {};
}

void write_part(Hdf5File& file, const CorpusPart& part) {
    file.set_attribute("/", "shard", part.shard);
    file.set_attribute("/", "shards", part.shards);
    file.set_attribute("/", "first_slot", part.first_slot);
    file.set_attribute("/", "corpus_samples", part.corpus_samples);
}

std::optional<CorpusPart> read_part(const Hdf5File& file) {
    if (!file.has_attribute("/", "shard")) return std::nullopt;
    CorpusPart part;
    part.shard = static_cast<int>(file.integer_attribute("/", "shard"));
    part.shards = static_cast<int>(file.integer_attribute("/", "shards"));
    part.first_slot = file.integer_attribute("/", "first_slot");
    part.corpus_samples = file.integer_attribute("/", "corpus_samples");
    return part;
}

}  // namespace toile::files
