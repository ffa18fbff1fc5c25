#include "files/dataset_file.h"
#include "files/plan_file.h"
#include "files/replay_file.h"
#include "files/table_file.h"
#include "generate/validate.h"
#include "generate/validate_noise.h"
#include "generate/validate_projection.h"
#include "tests/fuzz/input_file.h"

// HDF5 1.10 itself leaks what it read before it gives up on a damaged file.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libhdf5";
}

// Raw bytes as an HDF5 file, given to every reader of HDF5 there is, since each looks for other things in it.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace toile;
    static const fuzz::InputFile file(".h5");
    const std::string& path = file.write(data, size);
    fuzz::may_refuse([&] { generate::validate_dataset(path); });
    fuzz::may_refuse([&] { generate::validate_projection(path, {}); });
    fuzz::may_refuse([&] { generate::validate_problem(path, {}); });
    fuzz::may_refuse([&] { generate::validate_noise(path, {}); });
    fuzz::may_refuse([&] { files::read_replay(path); });
    fuzz::may_refuse([&] { files::read_table(path); });
    fuzz::may_refuse([&] { files::read_plan(path); });
    return 0;
}
