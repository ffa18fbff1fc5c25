#include <algorithm>

#include "cloth/error.h"
#include "files/dataset_file.h"
#include "files/mesh_group.h"

namespace toile::files {
namespace {

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

DatasetHeader read_header(const Hdf5File& file) {
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

/// One value a sample.
template <typename T>
T value_of(const Hdf5File& file, const std::string& name, int slot) {
    const Array<T> array = file.read_rows<T>(name, slot, 1);
    if (array.shape.size() != 1)
        throw Error(name + " has shape " + shape_text(array.shape) + ", not one value a sample",
                    file.path() + ":" + name);
    return array.value[0];
}

/// One sample's rows of a dataset (N, rows, columns).
template <typename T>
Positions sample_rows(const Hdf5File& file, const std::string& name, int slot, int64_t rows) {
    const Array<T> array = file.read_rows<T>(name, slot, 1);
    if (array.shape != Shape{1, rows, 3})
        throw Error(name + " has samples of shape " + shape_text({array.shape.begin() + 1, array.shape.end()}) +
                        ", not " + shape_text({rows, 3}),
                    file.path() + ":" + name);
    Positions position(rows, 3);
    std::copy(array.value.begin(), array.value.end(), position.data());
    return position;
}

std::vector<Eigen::Quaterniond> sample_frames(const Hdf5File& file, int slot, int64_t vertices) {
    const Array<float> array = file.read_rows<float>("/samples/frame", slot, 1);
    if (array.shape != Shape{1, vertices, 4})
        throw Error("/samples/frame has shape " + shape_text(array.shape), file.path() + ":/samples/frame");
    std::vector<Eigen::Quaterniond> frame;
    for (size_t i = 0; i < array.value.size(); i += 4)
        frame.emplace_back(array.value[i], array.value[i + 1], array.value[i + 2], array.value[i + 3]);
    return frame;
}

}  // namespace

DatasetReader::DatasetReader(const std::string& path) : file_(Hdf5File::open(path)), header_(read_header(file_)) {
    sample_count_ = static_cast<int>(file_.read<int64_t>("/samples/id", {any_size}).value.size());
}

SampleRecord DatasetReader::read(int slot) const {
    const int64_t vertices = header_.mesh.vertex_count();
    SampleRecord sample;
    sample.id = value_of<int64_t>(file_, "/samples/id", slot);
    sample.split = value_of<int>(file_, "/samples/split", slot);
    sample.status = value_of<int>(file_, "/samples/status", slot);
    sample.cloth = sample_rows<float>(file_, "/samples/cloth", slot, vertices);
    if (header_.body)
        sample.pose =
            sample_rows<double>(file_, "/samples/pose", slot, static_cast<int64_t>(header_.body->joint_name.size()));
    if (header_.embedding) {
        sample.embedded = sample_rows<float>(file_, "/samples/embedded", slot, vertices);
        sample.displacement = sample_rows<float>(file_, "/samples/displacement", slot, vertices);
        sample.frame = sample_frames(file_, slot, vertices);
    }
    if (header_.image) {
        const DatasetImage& image = *header_.image;
        const Array<float> array = file_.read_rows<float>("/samples/image", slot, 1);
        if (array.shape != Shape{1, 3 * image.layers, image.size, image.size})
            throw Error("/samples/image has shape " + shape_text(array.shape) + ", which does not go with /image/mask",
                        file_.path() + ":/samples/image");
        sample.image = array.value;
    }
    sample.certificate = read_certificate(file_, slot);
    return sample;
}

Digest DatasetReader::stored_digest(int slot) const {
    const Array<uint8_t> array = file_.read_rows<uint8_t>("/samples/digest", slot, 1);
    Digest digest{};
    if (array.value.size() != digest.size())
        throw Error("/samples/digest has shape " + shape_text(array.shape), file_.path() + ":/samples/digest");
    std::copy(array.value.begin(), array.value.end(), digest.begin());
    return digest;
}

}  // namespace toile::files
