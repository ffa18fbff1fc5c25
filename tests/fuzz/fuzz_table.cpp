#include "files/table_file.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const toile::fuzz::InputFile file(".csv");
    const std::string& path = file.write(data, size);
    toile::fuzz::may_refuse([&] {
        const toile::files::Table table = toile::files::read_table(path);
        table.where(table.value.rows() - 1);
    });
    return 0;
}
