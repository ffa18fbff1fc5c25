#include "files/plan_file.h"

#include "cloth/error.h"
#include "files/dataset_header.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr int deflate = 4;

}  // namespace

void write_plan(const std::string& path, const CorpusPlan& plan) {
    NewFile target(path);
    const auto samples = static_cast<int64_t>(plan.sample_count());
    // A data set without samples: what reads a data set's header reads this one too.
    DatasetWriter empty(target.partial(), plan.header, 0, deflate, CorpusPart{0, 1, 0, plan.sample_count()});
    empty.finish();
    Hdf5File file = Hdf5File::edit(target.partial());
    file.write("/plan/pose_number", plan.pose_number, {samples}, Storage{deflate, {}});
    file.write("/plan/split", plan.split, {samples}, Storage{deflate, {}});
    if (!plan.remarks.empty()) file.set_attribute("/plan", "remarks", plan.remarks);  // HDF5 knows no empty list
    file.close();
    target.commit();
}

CorpusPlan read_plan(const std::string& path) {
    const Hdf5File file = Hdf5File::open(path);
    CorpusPlan plan;
    plan.header = read_dataset_header(file);
    plan.pose_number = file.read<int64_t>("/plan/pose_number", {any_size}).value;
    const auto samples = static_cast<int64_t>(plan.pose_number.size());
    plan.split = file.read<int>("/plan/split", {samples}).value;
    if (file.has_attribute("/plan", "remarks")) plan.remarks = file.strings_attribute("/plan", "remarks");
    for (const int split : plan.split)
        if (split < 0 || split > 2) throw Error("the plan has a split " + std::to_string(split), path);
    return plan;
}

}  // namespace toile::files
