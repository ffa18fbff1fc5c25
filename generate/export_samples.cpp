#include "generate/export_samples.h"

#include <algorithm>

#include "cloth/error.h"
#include "generate/ordered_work.h"
#include "generate/stored_body.h"

namespace toile::generate {
namespace {

Positions sample_rows(const files::Hdf5File& file, const std::string& name, int slot, int64_t rows) {
    const files::Array<double> array = file.read_rows<double>(name, slot, 1);
    if (array.shape != files::Shape{1, rows, 3})
        throw Error(name + " has samples of shape " + files::shape_text({array.shape.begin() + 1, array.shape.end()}) +
                        ", not " + files::shape_text({rows, 3}),
                    file.path() + ":" + name);
    Positions position(rows, 3);
    std::copy(array.value.begin(), array.value.end(), position.data());
    return position;
}

skin::Body checked_body(const files::DatasetBody& stored, const std::string& path) {
    const auto vertices = static_cast<int>(stored.rest_position.rows());
    const auto joints = static_cast<int>(stored.joint_name.size());
    for (size_t i = 0; i < stored.weight_vertex.size(); ++i)
        if (stored.weight_vertex[i] < 0 || stored.weight_vertex[i] >= vertices || stored.weight_joint[i] < 0 ||
            stored.weight_joint[i] >= joints)
            throw Error("a skin weight of the body is of a vertex or joint that is not there", path + ":/body");
    skin::Body body = skinned_body(stored);
    skin::check_body(body, path + ":/body");
    return body;
}

}  // namespace

ExportSamples::ExportSamples(const ExportOptions& options) : options_(options), reader_(options.dataset) {
    check_cloth_mesh(header().mesh, options_.dataset + ":/mesh");
    if (header().body && options_.body) body_ = checked_body(*header().body, options_.dataset);
    select();
    if (!body_ || !header().embedding || entry_.empty()) return;
    // All samples of a data set are skinned alike.
    skinning_ = posed_as_stored(header(), *body_, reader_.read(entry_[0].slot)).method;
}

void ExportSamples::select() {
    const files::Hdf5File& file = reader_.file();
    const files::Shape each{reader_.sample_count()};
    const std::vector<int64_t> id = file.read<int64_t>("/samples/id", each).value;
    const std::vector<int> split = file.read<int>("/samples/split", each).value;
    const std::vector<int> status = file.read<int>("/samples/status", each).value;
    std::vector<Entry> chosen;
    for (int slot = 0; slot < reader_.sample_count(); ++slot) {
        const auto here = [&](const auto& range) { return range.first <= id[slot] && id[slot] <= range.second; };
        if (!options_.pose.empty() && std::none_of(options_.pose.begin(), options_.pose.end(), here)) continue;
        if (options_.split && *options_.split != split[slot]) continue;
        if (status[slot] != 0 && !options_.failed) continue;
        chosen.push_back({slot, id[slot], split[slot], status[slot]});
    }
    const auto all = static_cast<int64_t>(chosen.size());
    const int64_t kept = options_.at_most > 0 ? std::min(options_.at_most, all) : all;
    for (int64_t k = 0; k < kept; ++k) {
        const Entry& entry = chosen[static_cast<size_t>(k * all / kept)];
        // The gate lets nothing pass that is not finite.
        if (entry.status == 0 || is_finite(entry.slot))
            entry_.push_back(entry);
        else
            ++not_finite_;
    }
}

bool ExportSamples::is_finite(int slot) const {
    if (!sample_rows(reader_.file(), "/samples/cloth", slot, header().mesh.vertex_count()).allFinite()) return false;
    return !body_ || sample_rows(reader_.file(), "/samples/pose", slot, body_->joint_count()).allFinite();
}

Positions ExportSamples::cloth(int k) const {
    return sample_rows(reader_.file(), "/samples/cloth", entry_[k].slot, header().mesh.vertex_count());
}

Positions ExportSamples::pose(int k) const {
    return sample_rows(reader_.file(), "/samples/pose", entry_[k].slot, body_->joint_count());
}

Positions ExportSamples::body_position(int k) const {
    return skin::skin_positions(*body_, pose(k), skinning_);
}

void ExportSamples::step(const char* stage, int done) const {
    if (options_.interrupted && *options_.interrupted) throw Interrupted("interrupted: nothing was written");
    if (options_.progress) options_.progress({stage, done, count(), 0});
}

}  // namespace toile::generate
