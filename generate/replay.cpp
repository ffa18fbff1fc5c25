#include "generate/replay.h"

#include <algorithm>
#include <filesystem>

#include "cloth/error.h"
#include "files/mesh_file.h"
#include "generate/dataset_header.h"
#include "generate/sample_tally.h"
#include "generate/single.h"

namespace toile::generate {

namespace fs = std::filesystem;

std::unique_ptr<files::ReplayRecord> replay_record(const DressedScene& dressed, const Sample& sample) {
    if (sample.status == simulate::DrapeStatus::accepted) return nullptr;
    const SceneConfig& config = dressed.scene.config;
    auto record = std::make_unique<files::ReplayRecord>();
    record->config = config.absolute_text;
    record->config_hash = config.hash;
    record->program_version = TOILE_VERSION;
    record->id = sample.id;
    record->reason = simulate::status_reason(sample.status);
    record->mesh = dressed.scene.garment.mesh;
    record->pose = sample.pose;
    record->start = dressed.mesh.rest_position;
    record->cloth = sample.draped;
    record->certificate = certificate_record(sample.certificate);
    for (const simulate::TryRecord& one : sample.tries)
        record->tries.push_back({std::string(simulate::rung_name(one.rung)),
                                 std::string(simulate::status_reason(one.status)),
                                 certificate_record(one.certificate)});
    return record;
}

void write_replay_of(const std::string& folder, const files::ReplayRecord& record) {
    const std::string path = replay_path(folder, record.id);
    std::error_code failure;
    fs::create_directory(fs::path(path).parent_path(), failure);
    if (failure) throw Error("the folder of replays cannot be made: " + failure.message(), path);
    files::write_replay(path, record);
}

Validation validate_replay(const std::string& path) {
    Validation result;
    result.samples = 1;
    try {
        const files::ReplayRecord record = files::read_replay(path);
        const std::vector<std::string_view> reasons = simulate::status_reasons();
        if (record.suite_case.empty() && std::find(reasons.begin() + 1, reasons.end(), record.reason) == reasons.end())
            result.defect.push_back("/: the reason \"" + record.reason + "\" is not one a drape fails for");
        if (!record.suite_case.empty()) return result;  // may fail for what a drape does not judge
        const auto tries = static_cast<int>(record.tries.size());
        using simulate::DrapeStatus, simulate::status_reason;
        if (record.reason == status_reason(DrapeStatus::crashed) ||
            record.reason == status_reason(DrapeStatus::out_of_memory))
            return result;  // its process ended before any try did
        if (tries == 0) result.defect.push_back("/replay/rung: there are none");
        if (record.certificate.detail && record.certificate.detail->tries != tries)
            result.defect.push_back("/certificate/tries[0]: says " + std::to_string(record.certificate.detail->tries) +
                                    ", but there are " + std::to_string(tries));
    } catch (const Error& error) {
        result.defect.push_back(error.what() + (error.where().empty() ? "" : " (" + error.where() + ")"));
    }
    return result;
}

namespace {

void check_fits(const Scene& scene, const files::ReplayRecord& record, const std::string& file) {
    if (!scene.body) throw Error("the scene of this replay has no [body]", file);
    if (record.pose.rows() != scene.body->joint_count())
        throw Error("the replay has a pose of " + std::to_string(record.pose.rows()) + " joints, its body " +
                        std::to_string(scene.body->joint_count()),
                    file + ":/replay/pose");
    if (record.start.rows() != scene.garment.mesh.vertex_count())
        throw Error("the replay starts from " + std::to_string(record.start.rows()) + " vertices, its garment has " +
                        std::to_string(scene.garment.mesh.vertex_count()),
                    file + ":/replay/start");
}

}  // namespace

Replayed replay_once(const std::string& replay, const std::vector<std::string>& overrides, const std::string& path) {
    check_mesh_path(path);
    Replayed again;
    again.recorded = files::read_replay(replay);
    const SceneConfig config = read_scene_text(again.recorded.config, replay, overrides);
    again.same_inputs = config.hash == again.recorded.config_hash;
    Scene scene = build_scene(config);
    check_fits(scene, again.recorded, replay);
    scene.garment.mesh = again.recorded.mesh;
    again.drape = make_draper(scene)->drape(again.recorded.start, again.recorded.pose);
    again.same_cloth = again.drape.position == again.recorded.cloth;
    again.same_certificate = files::certificate_bytes(certificate_record(again.drape.certificate)) ==
                             files::certificate_bytes(again.recorded.certificate);
    if (again.drape.position.allFinite()) files::write_mesh(path, scene.garment.mesh.triangle, again.drape.position);
    return again;
}

}  // namespace toile::generate
