#include "files/motion_file.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const toile::fuzz::InputFile file(".bvh");
    const std::string& path = file.write(data, size);
    toile::fuzz::may_refuse([&] { toile::files::rest_positions(toile::files::read_motion(path)); });
    return 0;
}
