#include "generate/validate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "files/dataset_file.h"
#include "generate/dataset_structure.h"
#include "generate/validate_sample.h"
#include "skin/pose.h"
#include "skin/split_leak.h"

namespace toile::generate {
namespace {

using Lines = std::vector<std::string>;

/// One line for all `i` in [0, count) with `bad(i)`.
bool add_if_any(Lines& defect, const std::string& dataset, int64_t count, const std::string& what,
                const std::function<bool(int64_t)>& bad) {
    int64_t found = 0, first = -1;
    for (int64_t i = 0; i < count; ++i)
        if (bad(i) && found++ == 0) first = i;
    if (found == 0) return false;
    defect.push_back(dataset + "[" + std::to_string(first) + "]: " + what +
                     (found > 1 ? ", and " + std::to_string(found - 1) + " more" : ""));
    return true;
}

bool check_mesh(const ClothMesh& mesh, Lines& defect) {
    try {
        check_cloth_mesh(mesh, "/mesh");
    } catch (const Error& error) {
        defect.push_back(std::string("/mesh: ") + error.what());
        return false;
    }
    add_if_any(defect, "/mesh/mass", mesh.mass.size(), "is not a positive mass",
               [&](int64_t v) { return !(std::isfinite(mesh.mass[v]) && mesh.mass[v] > 0); });
    return true;
}

bool check_skeleton(const files::DatasetBody& body, Lines& defect) {
    const auto joints = static_cast<int64_t>(body.joint_parent.size());
    bool bad = add_if_any(defect, "/body/joint_parent", joints, "is not a joint before it", [&](int64_t j) {
        return j == 0 ? body.joint_parent[0] != -1 : body.joint_parent[j] < 0 || body.joint_parent[j] >= j;
    });
    bad |= add_if_any(defect, "/body/joint_bind", joints, "is not a rigid transform", [&](int64_t j) {
        const Eigen::Matrix4d& bind = body.joint_bind[j];
        const Eigen::Matrix3d turn = bind.topLeftCorner<3, 3>();
        return !bind.allFinite() || !(turn * turn.transpose()).isIdentity(1e-6) || turn.determinant() < 0 ||
               bind.row(3) != Eigen::RowVector4d(0, 0, 0, 1);
    });
    return !bad;
}

bool check_weights(const files::DatasetBody& body, Lines& defect) {
    const auto count = static_cast<int64_t>(body.weight_value.size());
    const auto vertices = static_cast<int>(body.rest_position.rows());
    const auto joints = static_cast<int>(body.joint_parent.size());
    bool bad = add_if_any(defect, "/body/weight_vertex", count, "is not a vertex",
                          [&](int64_t i) { return body.weight_vertex[i] < 0 || body.weight_vertex[i] >= vertices; });
    bad |= add_if_any(defect, "/body/weight_joint", count, "is not a joint",
                      [&](int64_t i) { return body.weight_joint[i] < 0 || body.weight_joint[i] >= joints; });
    bad |= add_if_any(defect, "/body/weight_value", count, "is not a weight of 0 or more",
                      [&](int64_t i) { return !(body.weight_value[i] >= 0) || !std::isfinite(body.weight_value[i]); });
    if (bad) return false;
    std::vector<double> sum(static_cast<size_t>(vertices), 0.0);
    for (int64_t i = 0; i < count; ++i) sum[body.weight_vertex[i]] += body.weight_value[i];
    for (int v = 0; v < vertices; ++v)
        if (!(std::abs(sum[v] - 1) <= 1e-6)) bad = true;
    if (bad)
        add_if_any(defect, "/body/rest_position", vertices, "has weights that do not sum to one",
                   [&](int64_t v) { return !(std::abs(sum[v] - 1) <= 1e-6); });
    return !bad;
}

bool check_body_group(const files::DatasetBody& body, Lines& defect) {
    bool bad = add_if_any(defect, "/body/rest_position", body.rest_position.rows(), "is not finite",
                          [&](int64_t v) { return !body.rest_position.row(v).allFinite(); });
    bad |= add_if_any(defect, "/body/triangle", body.triangle.rows(), "refers to a vertex that is not there",
                      [&](int64_t f) {
                          const auto t = body.triangle.row(f);
                          return t.minCoeff() < 0 || t.maxCoeff() >= body.rest_position.rows();
                      });
    if (body.triangle.rows() == 0) defect.push_back("/body/triangle: there are none");
    bad |= body.triangle.rows() == 0;
    bad |= !check_skeleton(body, defect);
    bad |= !check_weights(body, defect);
    return !bad;
}

bool check_embedding(const files::DatasetEmbedding& embedding, Eigen::Index body_triangles, Lines& defect) {
    const auto vertices = static_cast<int64_t>(embedding.triangle.size());
    bool bad = add_if_any(defect, "/embedding/triangle", vertices, "is not a triangle of the body", [&](int64_t v) {
        return embedding.triangle[v] < 0 || embedding.triangle[v] >= body_triangles;
    });
    bad |= add_if_any(defect, "/embedding/barycentric", vertices, "is not weights from 0 to 1 with sum one",
                      [&](int64_t v) {
                          const Eigen::RowVector3d weight = embedding.barycentric.row(v);
                          return !(weight.minCoeff() >= -1e-9) || !(std::abs(weight.sum() - 1) <= 1e-9);
                      });
    return !bad;
}

bool check_image_group(const files::DatasetImage& image, Lines& defect) {
    bool bad = add_if_any(
        defect, "/image/pattern_pixel", image.pattern_pixel.rows(), "is not a place in the image", [&](int64_t p) {
            const Eigen::RowVector3d at = image.pattern_pixel.row(p);
            return !at.allFinite() || at.x() != std::floor(at.x()) || at.x() < 0 || at.x() >= image.layers ||
                   at.tail<2>().minCoeff() < 0 || at.tail<2>().maxCoeff() > image.size - 1;
        });
    if (image.size < 2 || image.layers < 1) {
        defect.push_back("/image/mask: is too small for a picture");
        bad = true;
    }
    add_if_any(defect, "/image/mask", static_cast<int64_t>(image.mask.size()), "is neither 0 nor 1",
               [&](int64_t i) { return image.mask[i] > 1; });
    return !bad;
}

/// False if what the samples' checks rely on is unsound.
bool check_header(const files::DatasetHeader& header, Lines& defect) {
    bool sound = check_mesh(header.mesh, defect);
    if (header.body) sound &= check_body_group(*header.body, defect);
    if (header.embedding)
        sound &= check_embedding(*header.embedding, header.body ? header.body->triangle.rows() : 0, defect);
    if (header.image) sound &= check_image_group(*header.image, defect);
    return sound;
}

/// What is compared between samples; their poses are read again.
struct Named {
    int64_t id = 0;
    std::int8_t split = 0;
    bool readable = false;
};

void check_ids(const std::vector<Named>& sample, Lines& defect) {
    std::vector<std::pair<int64_t, size_t>> sorted;
    for (size_t i = 0; i < sample.size(); ++i)
        if (sample[i].readable) sorted.emplace_back(sample[i].id, i);
    std::sort(sorted.begin(), sorted.end());
    std::map<size_t, size_t> twin;
    for (size_t i = 1, first = 0; i < sorted.size(); ++i) {
        if (sorted[i].first != sorted[first].first) first = i;
        if (first != i) twin.emplace(sorted[i].second, sorted[first].second);
    }
    for (const auto& [one, other] : twin)
        defect.push_back("/samples/id[" + std::to_string(one) + "]: " + std::to_string(sample[one].id) +
                         " is the id of sample " + std::to_string(other) + " too");
}

/// The stored poses, read in blocks where they are asked for in order. What cannot be read is not finite.
class StoredPoses {
  public:
    StoredPoses(const files::Hdf5File& file, const std::vector<Named>& sample) : file_(file), sample_(sample) {}

    skin::Pose operator()(int64_t slot) {
        if (!sample_[static_cast<size_t>(slot)].readable) return not_finite;
        try {
            if (slot == first_ + held_) load(slot);
            if (slot >= first_ && slot < first_ + held_) return pose_of(block_, slot - first_);
            return pose_of(file_.read_rows<double>("/samples/pose", slot, 1), 0);
        } catch (const Error&) {
            return not_finite;
        }
    }

  private:
    static constexpr int64_t rows = 512;
    const skin::Pose not_finite = skin::Pose::Constant(1, 3, std::nan(""));

    void load(int64_t slot) {
        const int64_t count = std::min<int64_t>(rows, static_cast<int64_t>(sample_.size()) - slot);
        block_ = file_.read_rows<double>("/samples/pose", slot, count);
        first_ = slot;
        held_ = count;
    }
    static skin::Pose pose_of(const files::Array<double>& array, int64_t row) {
        const int64_t width = array.shape[1] * array.shape[2];
        return Eigen::Map<const skin::Pose>(array.value.data() + row * width, array.shape[1], 3);
    }

    const files::Hdf5File& file_;
    const std::vector<Named>& sample_;
    files::Array<double> block_;
    int64_t first_ = 0, held_ = 0;
};

void check_splits(const files::DatasetReader& reader, const std::vector<Named>& sample, Lines& defect) {
    if (!reader.header().body) return;
    std::vector<std::int8_t> split;
    for (const Named& one : sample) split.push_back(one.split);
    StoredPoses stored(reader.file(), sample);
    for (const skin::SplitLeak& leak :
         skin::split_leaks([&](int64_t slot) { return stored(slot); }, split, reader.header().duplicate_angle))
        defect.push_back("/samples/split[" + std::to_string(leak.pose) + "]: nearly the pose of sample " +
                         std::to_string(leak.other) + ", which is in another split");
}

void check_samples(const files::DatasetReader& reader, const ValidateOptions& options, Validation& result) {
    const SampleChecker checker(reader.header());
    const int count = reader.sample_count();
    std::vector<Lines> defect(static_cast<size_t>(count));
    std::vector<Named> named(static_cast<size_t>(count));
    std::vector<char> accepted(static_cast<size_t>(count), 0);
    std::mutex mutex;
    int done = 0;
    parallel_for(count, std::max(options.jobs, 1), [&](int, int slot) {
        try {
            const files::SampleRecord sample = reader.read(slot);
            defect[slot] = checker.defects(sample, reader.stored_digest(slot), slot);
            accepted[slot] = sample.status == 0;
            named[slot] = {sample.id, static_cast<std::int8_t>(sample.split), true};
        } catch (const Error& error) {
            defect[slot] = {error.what() + std::string(" (sample ") + std::to_string(slot) + ")"};
        }
        const std::lock_guard lock(mutex);
        if (options.step) options.step(++done, count);
    });
    for (const Lines& lines : defect) result.defect.insert(result.defect.end(), lines.begin(), lines.end());
    result.accepted = static_cast<int>(std::count(accepted.begin(), accepted.end(), 1));
    check_ids(named, result.defect);
    check_splits(reader, named, result.defect);
}

void refuse_others(const files::Hdf5File& file) {
    if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != "toile")
        throw Error("this HDF5 file is not one of toile's: its attribute \"format\" is not \"toile\"", file.path());
    const int64_t version = file.integer_attribute("/", "version");
    if (version != files::dataset_version)
        throw Error("the file has version " + std::to_string(version) + ", and this program reads version " +
                        std::to_string(files::dataset_version),
                    file.path());
}

}  // namespace

Validation validate_dataset(const std::string& path, const ValidateOptions& options) {
    Validation result;
    {
        const files::Hdf5File file = files::Hdf5File::open(path);
        refuse_others(file);
        result.defect = structure_defects(file);
    }
    if (!result.defect.empty()) return result;
    try {
        const files::DatasetReader reader(path);
        result.samples = reader.sample_count();
        if (check_header(reader.header(), result.defect)) check_samples(reader, options, result);
    } catch (const Error& error) {  // a chunk that cannot be read: the file is ours, but damaged
        result.defect.push_back(error.what());
    }
    return result;
}

}  // namespace toile::generate
