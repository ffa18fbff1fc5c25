#include "generate/project_config.h"
#include "generate/scene_config.h"
#include "tests/fuzz/input_file.h"

// A scene's text, resolved and checked; what it prints must read back as the same scene.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    toile::fuzz::may_refuse([&] {
        const auto scene = toile::generate::read_scene_text(text, "/nowhere/scene.toml", {});
        toile::generate::left_out(scene);
        const auto again = toile::generate::read_scene_text(scene.absolute_text, "/nowhere/again.toml", {});
        if (again.hash != scene.hash) __builtin_trap();
    });
    // the same bytes as an override on the command line
    toile::fuzz::may_refuse([&] { toile::generate::read_scene_text("name = \"a\"\n", "/nowhere/a.toml", {text}); });
    return 0;
}
