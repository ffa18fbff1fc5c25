#include "files/metric_comparison.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const toile::fuzz::InputFile file(".json");
    const std::string& path = file.write(data, size);
    toile::fuzz::may_refuse([&] {
        const toile::files::MetricFile read = toile::files::read_metric_file(path);
        for (const auto& change : toile::files::compare_metrics(read.metric, read.metric)) change.line();
        toile::files::metric_text(read);
    });
    return 0;
}
