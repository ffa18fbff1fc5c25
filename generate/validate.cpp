#include "generate/validate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>

#include "cloth/error.h"
#include "cloth/parallel.h"
#include "files/dataset_file.h"
#include "generate/dataset_structure.h"
#include "generate/validate_sample.h"
#include "skin/pose.h"
#include "skin/pose_cluster.h"

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

/// What is compared between samples.
struct Pose {
    int64_t id = 0;
    int split = 0;
    skin::Pose rotation;
};

void check_ids(const std::vector<Pose>& pose, Lines& defect) {
    std::map<int64_t, size_t> first;
    for (size_t i = 0; i < pose.size(); ++i) {
        const auto [at, fresh] = first.emplace(pose[i].id, i);
        if (!fresh)
            defect.push_back("/samples/id[" + std::to_string(i) + "]: " + std::to_string(pose[i].id) +
                             " is the id of sample " + std::to_string(at->second) + " too");
    }
}

/// The first sample before `member[last]` in another split and nearly in its pose, or -1.
int near_in_another_split(const std::vector<Pose>& pose, const std::vector<int>& member, size_t last, double angle) {
    const Pose& one = pose[member[last]];
    for (size_t k = 0; k < last; ++k) {
        const Pose& other = pose[member[k]];
        if (other.split != one.split && skin::largest_joint_rotation(other.rotation, one.rotation) < angle)
            return member[k];
    }
    return -1;
}

void check_splits(const std::vector<Pose>& pose, double angle, Lines& defect) {
    std::vector<int> slot;
    std::vector<skin::Pose> rotation;
    for (size_t i = 0; i < pose.size(); ++i) {
        if (pose[i].rotation.rows() == 0 || !pose[i].rotation.allFinite()) continue;
        slot.push_back(static_cast<int>(i));
        rotation.push_back(pose[i].rotation);
    }
    if (rotation.empty()) return;
    // Two near poses are in one cluster, so pairs need to be looked for within clusters alone.
    std::map<int, std::vector<int>> cluster;
    const std::vector<int> leader = skin::cluster_poses(rotation, angle);
    for (size_t k = 0; k < slot.size(); ++k) cluster[leader[k]].push_back(slot[k]);
    std::map<int, int> twin;
    for (const auto& [first, member] : cluster) {
        for (size_t last = 1; last < member.size(); ++last) {
            const int other = near_in_another_split(pose, member, last, angle);
            if (other >= 0) twin.emplace(member[last], other);
        }
    }
    for (const auto& [sample, other] : twin)
        defect.push_back("/samples/split[" + std::to_string(sample) + "]: nearly the pose of sample " +
                         std::to_string(other) + ", which is in another split");
}

void check_samples(const files::DatasetReader& reader, const ValidateOptions& options, Validation& result) {
    const SampleChecker checker(reader.header());
    const int count = reader.sample_count();
    std::vector<Lines> defect(static_cast<size_t>(count));
    std::vector<Pose> pose(static_cast<size_t>(count));
    std::vector<char> accepted(static_cast<size_t>(count), 0);
    std::mutex mutex;
    int done = 0;
    parallel_for(count, std::max(options.jobs, 1), [&](int, int slot) {
        try {
            files::SampleRecord sample = reader.read(slot);
            defect[slot] = checker.defects(sample, reader.stored_digest(slot), slot);
            accepted[slot] = sample.status == 0;
            pose[slot] = {sample.id, sample.split, std::move(sample.pose)};
        } catch (const Error& error) {
            defect[slot] = {error.what() + std::string(" (sample ") + std::to_string(slot) + ")"};
            pose[slot].id = -1 - slot;
        }
        const std::lock_guard lock(mutex);
        if (options.step) options.step(++done, count);
    });
    for (const Lines& lines : defect) result.defect.insert(result.defect.end(), lines.begin(), lines.end());
    result.accepted = static_cast<int>(std::count(accepted.begin(), accepted.end(), 1));
    check_ids(pose, result.defect);
    check_splits(pose, reader.header().duplicate_angle, result.defect);
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
