#include "files/certificate_group.h"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include "cloth/error.h"

namespace toile::files {
namespace {

/// Calls `visit(name, member)` for each of the contract's datasets but `seconds`, in the order of the digest.
template <class Record, class Visit>
void for_each_contracted(Record& record, const Visit& visit) {
    visit("residual_force", record.residual_force);
    visit("body_penetration", record.body_penetration);
    visit("self_intersections", record.self_intersections);
    visit("max_stretch", record.max_stretch);
    visit("min_stretch", record.min_stretch);
    visit("max_speed", record.max_speed);
}

template <class Detail, class Visit>
void for_each_detail(Detail& detail, const Visit& visit) {
    visit("moving_share", detail.moving_share);
    visit("body_crossings", detail.body_crossings);
    visit("iterations", detail.iterations);
    visit("path_steps", detail.path_steps);
    visit("tries", detail.tries);
    visit("rung", detail.rung);
}

/// What came of each rung; files written before these were kept do without.
template <class Detail, class Visit>
void for_each_rung(Detail& detail, const Visit& visit) {
    static constexpr std::array status{"rung_0_status", "rung_1_status", "rung_2_status", "rung_3_status"};
    static constexpr std::array residual{"rung_0_residual_force", "rung_1_residual_force", "rung_2_residual_force",
                                         "rung_3_residual_force"};
    for (size_t k = 0; k < status.size(); ++k) {
        visit(status[k], detail.rung_status[k]);
        visit(residual[k], detail.rung_residual_force[k]);
    }
}

template <class Visit>
void for_each_value(const CertificateRecord& record, const Visit& visit) {
    for_each_contracted(record, visit);
    if (!record.detail) return;
    for_each_detail(*record.detail, visit);
    for_each_rung(*record.detail, visit);
}

std::string dataset(const std::string& name) {
    return "/certificate/" + name;
}

/// Values of several samples, by name.
struct Columns {
    std::map<std::string, std::vector<double>> real;
    std::map<std::string, std::vector<int>> whole;

    template <class Value>
    auto& of() {
        if constexpr (std::is_same_v<Value, int>)
            return whole;
        else
            return real;
    }
};

/// One value a sample.
template <class Value>
std::vector<Value> column_of(const Hdf5File& file, const std::string& name, int64_t first, int64_t count) {
    Array<Value> array = file.read_rows<Value>(name, first, count);
    if (array.shape.size() != 1)
        throw Error(name + " has shape " + shape_text(array.shape) + ", not one value a sample",
                    file.path() + ":" + name);
    return std::move(array.value);
}

}  // namespace

void create_certificates(Hdf5File& file, int64_t count, bool detailed) {
    constexpr int64_t chunk_rows = 4096;
    CertificateRecord record;
    if (detailed) record.detail.emplace();
    for_each_value(record, [&](const char* name, auto value) {
        file.create_rows<decltype(value)>(dataset(name), count, {}, 0, chunk_rows);
    });
}

void write_certificate_rows(Hdf5File& file, int64_t first, const std::vector<CertificateRecord>& certificate) {
    Columns column;
    const bool detailed = file.has(dataset("tries"));
    for (const CertificateRecord& one : certificate) {
        if (one.detail.has_value() != detailed)
            throw Error("some samples have a detailed certificate and some have not", file.path());
        for_each_value(one, [&](const char* name, auto value) { column.of<decltype(value)>()[name].push_back(value); });
    }
    const auto count = static_cast<int64_t>(certificate.size());
    for (const auto& [name, value] : column.real) file.write_rows(dataset(name), first, count, value.data());
    for (const auto& [name, value] : column.whole) file.write_rows(dataset(name), first, count, value.data());
}

void write_certificates(Hdf5File& file, const std::vector<CertificateRecord>& certificate) {
    create_certificates(file, static_cast<int64_t>(certificate.size()),
                        !certificate.empty() && certificate.front().detail.has_value());
    write_certificate_rows(file, 0, certificate);
}

std::vector<CertificateRecord> read_certificates(const Hdf5File& file, int64_t first, int64_t count) {
    const bool detailed = file.has(dataset("tries")), rungs = detailed && file.has(dataset("rung_0_status"));
    const auto for_each_stored = [&](CertificateRecord& record, const auto& visit) {
        for_each_contracted(record, visit);
        if (detailed) for_each_detail(*record.detail, visit);
        if (rungs) for_each_rung(*record.detail, visit);
    };
    CertificateRecord record;
    if (detailed) record.detail.emplace();
    std::vector<CertificateRecord> all(static_cast<size_t>(count), record);
    Columns column;
    for_each_stored(record, [&](const char* name, auto& member) {
        using Value = std::decay_t<decltype(member)>;
        column.of<Value>()[name] = column_of<Value>(file, dataset(name), first, count);
    });
    std::vector<double> seconds(all.size(), std::numeric_limits<double>::quiet_NaN());
    if (file.has(dataset("seconds"))) seconds = column_of<double>(file, dataset("seconds"), first, count);
    for (size_t i = 0; i < all.size(); ++i) {
        for_each_stored(all[i], [&](const char* name, auto& member) {
            member = column.of<std::decay_t<decltype(member)>>()[name][i];
        });
        all[i].seconds = seconds[i];
    }
    return all;
}

CertificateRecord read_certificate(const Hdf5File& file, int slot) {
    return read_certificates(file, slot, 1).front();
}

std::string certificate_bytes(const CertificateRecord& certificate) {
    std::string bytes;
    for_each_value(certificate, [&](const char*, auto value) {
        if constexpr (std::is_same_v<decltype(value), int>) {
            const int32_t stored = value;
            bytes.append(reinterpret_cast<const char*>(&stored), sizeof stored);
        } else {
            bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
        }
    });
    return bytes;
}

}  // namespace toile::files
