#include "files/certificate_group.h"

#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

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

/// One value a sample.
template <class Value>
Value value_of(const Hdf5File& file, const std::string& name, int slot) {
    const Array<Value> array = file.read_rows<Value>(name, slot, 1);
    if (array.shape.size() != 1)
        throw Error(name + " has shape " + shape_text(array.shape) + ", not one value a sample",
                    file.path() + ":" + name);
    return array.value[0];
}

}  // namespace

void write_certificates(Hdf5File& file, const std::vector<CertificateRecord>& certificate) {
    struct Column {
        std::string name;
        bool whole;
        std::vector<double> real;
        std::vector<int> number;
    };
    std::vector<Column> columns;
    const CertificateRecord first = certificate.empty() ? CertificateRecord{} : certificate.front();
    for_each_value(first, [&](const char* name, auto value) {
        columns.push_back({dataset(name), std::is_same_v<decltype(value), int>, {}, {}});
    });
    for (const CertificateRecord& one : certificate) {
        if (one.detail.has_value() != first.detail.has_value())
            throw Error("some samples have a detailed certificate and some have not", file.path());
        auto column = columns.begin();
        for_each_value(one, [&](const char*, auto value) {
            if constexpr (std::is_same_v<decltype(value), int>)
                column->number.push_back(value);
            else
                column->real.push_back(value);
            ++column;
        });
    }
    const Shape shape{static_cast<int64_t>(certificate.size())};
    for (const Column& one : columns) {
        if (one.whole)
            file.write(one.name, one.number, shape, Storage{0, {}});
        else
            file.write(one.name, one.real, shape, Storage{0, {}});
    }
}

CertificateRecord read_certificate(const Hdf5File& file, int slot) {
    CertificateRecord record;
    const auto read = [&](const char* key, auto& value) {
        value = value_of<std::decay_t<decltype(value)>>(file, dataset(key), slot);
    };
    for_each_contracted(record, read);
    if (file.has(dataset("tries"))) for_each_detail(record.detail.emplace(), read);
    if (record.detail && file.has(dataset("rung_0_status"))) for_each_rung(*record.detail, read);
    record.seconds = file.has(dataset("seconds")) ? value_of<double>(file, dataset("seconds"), slot)
                                                  : std::numeric_limits<double>::quiet_NaN();
    return record;
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
