#include "files/problem_file.h"

#include "cloth/error.h"
#include "files/hdf5_numbers.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr const char* predicted_name = "/samples/predicted";
constexpr const char* target_name = "/samples/target";

/// The number of samples in a dataset `[N x V x 3]`; `count` is N, or `any_size` if that is what is asked.
int64_t check_samples(const Hdf5File& file, const char* name, int64_t count, int64_t vertices) {
    const std::string where = file.path() + ":" + name;
    const Shape shape = file.shape(name), expected{count, vertices, 3};
    const bool fits =
        shape.size() == 3 && (count == any_size || shape[0] == count) && shape[1] == vertices && shape[2] == 3;
    if (!fits) throw Error(name + (" has shape " + shape_text(shape)) + ", not " + shape_text(expected), where);
    const std::string type = file.type_name(name);
    if (type.rfind("float", 0) != 0 && type.rfind("int", 0) != 0 && type.rfind("uint", 0) != 0)
        throw Error(name + (" holds " + type) + " where numbers are expected", where);
    return shape[0];
}

}  // namespace

ProblemFile::ProblemFile(const std::string& path) : file_(Hdf5File::open(path)), mesh_(read_mesh_group(file_)) {
    sample_count_ = check_samples(file_, predicted_name, any_size, mesh_.vertex_count());
    has_target_ = file_.has(target_name);
    if (has_target_) check_samples(file_, target_name, sample_count_, mesh_.vertex_count());
}

std::vector<double> ProblemFile::predicted(int64_t first, int64_t count) const {
    return read_number_rows(file_, predicted_name, first, count).value;
}

std::vector<double> ProblemFile::target(int64_t first, int64_t count) const {
    return read_number_rows(file_, target_name, first, count).value;
}

void write_problem(const std::string& path, const ClothMesh& mesh, std::span<const double> predicted,
                   std::span<const double> target) {
    NewFile whole(path);
    Hdf5File file = Hdf5File::create(whole.partial());
    write_mesh_group(file, mesh, 4);
    const int64_t vertices = mesh.vertex_count(), samples = static_cast<int64_t>(predicted.size()) / (3 * vertices);
    file.write(predicted_name, predicted.data(), {samples, vertices, 3}, Storage{4, {}});
    if (!target.empty()) file.write(target_name, target.data(), {samples, vertices, 3}, Storage{4, {}});
    file.close();
    whole.commit();
}

}  // namespace toile::files
