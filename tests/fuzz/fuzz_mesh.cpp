// TOILE_FUZZ_EXTENSION, from CMakeLists.txt: ".obj", ".ply" or ".gltf" (which reads .glb by its first bytes too).

#include "files/mesh_file.h"
#include "files/rigged_file.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const toile::fuzz::InputFile file(TOILE_FUZZ_EXTENSION);
    const std::string& path = file.write(data, size);
    toile::fuzz::may_refuse([&] { toile::files::read_mesh(path); });
    if (std::string(TOILE_FUZZ_EXTENSION) == ".gltf")
        toile::fuzz::may_refuse([&] { toile::files::read_rigged_file(path); });
    return 0;
}
