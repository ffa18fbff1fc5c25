#include "tests/evaluate/judged_dataset.h"

#include <cmath>
#include <random>

#include "evaluate/case_meshes.h"
#include "files/dataset_file.h"
#include "files/hdf5_file.h"

namespace toile::evaluate {

void TestPredictions::write(const std::string& path, const std::string& dataset) const {
    const files::DatasetReader reader(dataset);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> shift(-size, size);
    std::vector<std::int64_t> id;
    std::vector<float> predicted;
    for (int slot = 0; slot < reader.sample_count(); ++slot) {
        const files::SampleRecord sample = reader.read(slot);
        id.push_back(sample.id);
        for (Eigen::Index k = 0; k < sample.cloth.size(); ++k)
            predicted.push_back(static_cast<float>(sample.cloth.data()[k] + shift(random)));
    }
    change(id, predicted);
    files::Hdf5File file = files::Hdf5File::create(path);
    const auto count = static_cast<std::int64_t>(id.size());
    file.write("/samples/id", id, {count});
    if (count > 0)
        file.write("/samples/predicted", predicted,
                   {count, static_cast<std::int64_t>(predicted.size()) / (3 * count), 3});
    else
        file.create_rows<float>("/samples/predicted", 0, {reader.header().mesh.vertex_count(), 3}, 1);
    if (!name.empty()) file.set_attribute("/", "predictor", name);
    file.close();
}

void write_bodiless_dataset(const std::string& path, int samples) {
    files::DatasetHeader header;
    header.mesh = grid_cloth(even_lines(5, 0.25), even_lines(4, 0.2), 0.0, 0.2);
    header.config = "name = \"grid\"\n";
    header.config_hash = "0123456789abcdef0123456789abcdef";
    header.program_version = "0.1.0";
    header.seed = 3;
    header.reasons = {"accepted", "not_at_rest"};
    files::DatasetWriter writer(path, header, samples, 1);
    for (int slot = 0; slot < samples; ++slot) {
        files::SampleRecord sample;
        sample.id = 50 + slot;
        sample.split = slot % 6 < 4 ? 0 : slot % 6 - 3;
        sample.cloth = header.mesh.rest_position;
        const double bend = 4.0 + 0.2 * slot;  // 1/m: rolled onto a cylinder, which keeps lengths along it
        for (Eigen::Index v = 0; v < sample.cloth.rows(); ++v) {
            const double x = header.mesh.rest_position(v, 0);
            sample.cloth(v, 0) = std::sin(bend * x) / bend;
            sample.cloth(v, 1) = (std::cos(bend * x) - 1) / bend;
        }
        writer.write(slot, sample);
    }
    writer.finish();
}

}  // namespace toile::evaluate
