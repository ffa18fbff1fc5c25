#include "files/replay_file.h"

#include <algorithm>

#include "cloth/error.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

void write_rows(Hdf5File& file, const std::string& name, const Positions& rows) {
    file.write(name, rows.data(), {rows.rows(), 3}, Storage{4, {}});
}

Positions read_rows(const Hdf5File& file, const std::string& name, int64_t count = any_size) {
    const Array<double> array = file.read<double>(name, {count, 3});
    Positions rows(array.shape[0], 3);
    std::copy(array.value.begin(), array.value.end(), rows.data());
    return rows;
}

void check_kind(const Hdf5File& file) {
    if (!is_replay(file))
        throw Error("this HDF5 file is not a replay: toile generate writes them for poses that fail", file.path());
    const int64_t version = file.integer_attribute("/", "version");
    if (version != replay_version)
        throw Error("the replay has version " + std::to_string(version) + ", and this program reads version " +
                        std::to_string(replay_version),
                    file.path());
}

}  // namespace

bool is_replay(const Hdf5File& file) {
    return file.has_attribute("/", "format") && file.string_attribute("/", "format") == "toile" &&
           file.has_attribute("/", "kind") && file.string_attribute("/", "kind") == "replay";
}

void write_replay(const std::string& path, const ReplayRecord& record) {
    NewFile target(path);
    Hdf5File file = Hdf5File::create(target.partial());
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "kind", "replay");
    file.set_attribute("/", "version", replay_version);
    file.set_attribute("/", "config", record.config);
    file.set_attribute("/", "config_hash", record.config_hash);
    file.set_attribute("/", "program_version", record.program_version);
    file.set_attribute("/", "id", record.id);
    file.set_attribute("/", "reason", record.reason);
    if (!record.suite_case.empty()) file.set_attribute("/", "case", record.suite_case);
    write_mesh_group(file, record.mesh, 4);
    write_rows(file, "/replay/pose", record.pose);
    write_rows(file, "/replay/start", record.start);
    write_rows(file, "/replay/cloth", record.cloth);
    std::vector<std::string> rung, reason;
    std::vector<CertificateRecord> certificate{record.certificate};
    for (const ReplayTry& one : record.tries) {
        rung.push_back(one.rung);
        reason.push_back(one.reason);
        certificate.push_back(one.certificate);
    }
    file.write_strings("/replay/rung", rung);
    file.write_strings("/replay/rung_reason", reason);
    write_certificates(file, certificate);
    file.close();
    target.commit();
}

ReplayRecord read_replay(const std::string& path) {
    const Hdf5File file = Hdf5File::open(path);
    check_kind(file);
    ReplayRecord record;
    record.config = file.string_attribute("/", "config");
    record.config_hash = file.string_attribute("/", "config_hash");
    record.program_version = file.string_attribute("/", "program_version");
    record.id = file.integer_attribute("/", "id");
    record.reason = file.string_attribute("/", "reason");
    if (file.has_attribute("/", "case")) record.suite_case = file.string_attribute("/", "case");
    record.mesh = read_mesh_group(file);
    record.pose = read_rows(file, "/replay/pose");
    record.start = read_rows(file, "/replay/start", record.mesh.vertex_count());
    record.cloth = read_rows(file, "/replay/cloth", record.start.rows());
    if (!record.pose.allFinite()) throw Error("the pose is not finite", path + ":/replay/pose");
    if (!record.start.allFinite()) throw Error("the start is not finite", path + ":/replay/start");
    const std::vector<std::string> rung = file.read_strings("/replay/rung");
    const std::vector<std::string> reason = file.read_strings("/replay/rung_reason");
    if (reason.size() != rung.size())
        throw Error(
            "there are " + std::to_string(reason.size()) + " reasons for " + std::to_string(rung.size()) + " rungs",
            path + ":/replay/rung_reason");
    record.certificate = read_certificate(file, 0);
    for (size_t i = 0; i < rung.size(); ++i)
        record.tries.push_back({rung[i], reason[i], read_certificate(file, static_cast<int>(i) + 1)});
    return record;
}

}  // namespace toile::files
