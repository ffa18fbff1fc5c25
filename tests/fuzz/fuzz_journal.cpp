#include <cstring>

#include "files/journal.h"
#include "files/sample_bytes.h"
#include "tests/fuzz/input_file.h"

using namespace toile;

namespace {

void check(bool good) {
    if (!good) __builtin_trap();
}

/// Whatever the file holds, opening mends it: what is appended then is there when it is opened again, and what could be
/// read before still can.
void reopen(const std::string& path) {
    int records = 0, damaged = 0;
    {
        files::Journal journal(path);
        records = journal.count();
        damaged = journal.damaged();
        for (int i = 0; i < records; ++i)
            fuzz::may_refuse([&] { files::sample_from_bytes(journal.read(i)); }, fuzz::Place::unknown);
        journal.append("one more");
    }
    const files::Journal again(path);
    check(again.count() == records + 1 && again.damaged() == damaged);
    check(again.read(records) == "one more");
}

}  // namespace

// The input as the file of a journal, and as the bytes of one sample, which no digest protects there.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const fuzz::InputFile file("");
    const std::string& path = file.write(data, size);
    fuzz::may_refuse([&] { reopen(path); });
    fuzz::may_refuse(
        [&] {
            const std::string bytes(reinterpret_cast<const char*>(data), size);
            const std::string once = files::sample_bytes(files::sample_from_bytes(bytes));
            check(files::sample_bytes(files::sample_from_bytes(once)) == once);
        },
        fuzz::Place::unknown);
    return 0;
}
