#include "files/sample_bytes.h"

#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cstdint>
#include <sstream>
#include <vector>

#include "cloth/error.h"

// cereal finds these beside the types they serialise.
namespace toile::files {

template <class Archive>
void serialize(Archive& archive, CertificateDetail& d) {
    archive(d.moving_share, d.body_crossings, d.iterations, d.path_steps, d.tries, d.rung, d.rung_status,
            d.rung_residual_force);
}

template <class Archive>
void serialize(Archive& archive, CertificateRecord& c) {
    archive(c.residual_force, c.body_penetration, c.max_stretch, c.min_stretch, c.max_speed, c.seconds,
            c.self_intersections);
}

namespace {

template <typename T>
std::vector<T> values(const Positions& rows) {
    return {rows.data(), rows.data() + rows.size()};
}

template <typename T>
Positions positions(const std::vector<T>& value) {
    if (value.size() % 3 != 0) throw Error("a list of positions ends within a position");
    Positions rows(static_cast<Eigen::Index>(value.size() / 3), 3);
    std::copy(value.begin(), value.end(), rows.data());
    return rows;
}

/// A list as its length and its values. Its length is believed only where so many bytes are left: cereal's own would
/// allocate whatever it says first.
template <typename T>
struct List {
    std::vector<T>& value;
    size_t most = 0;  ///< values it can have

    template <class Archive>
    void save(Archive& archive) const {
        archive(static_cast<uint64_t>(value.size()), cereal::binary_data(value.data(), value.size() * sizeof(T)));
    }
    template <class Archive>
    void load(Archive& archive) {
        uint64_t count = 0;
        archive(count);
        if (count > most) throw Error("a list claims " + std::to_string(count) + " values");
        value.resize(count);
        archive(cereal::binary_data(value.data(), value.size() * sizeof(T)));
    }
};

/// What of a sample is neither a number nor a plain list.
struct Stored {
    std::vector<double> pose;
    std::vector<float> cloth, embedded, displacement, frame;
    uint8_t has_detail = 0;
};

/// Of `size` bytes in all.
template <class Archive, class Record>
void transfer(Archive& archive, Record& sample, Stored& stored, size_t size) {
    archive(sample.id, sample.split, sample.status, List<double>{stored.pose, size / sizeof(double)});
    for (std::vector<float>* list :
         {&stored.cloth, &stored.embedded, &stored.displacement, &stored.frame, &sample.image})
        archive(List<float>{*list, size / sizeof(float)});
    archive(sample.resampling_error, sample.certificate, stored.has_detail);
    if (stored.has_detail > 1) throw Error("the certificate's mark is neither 0 nor 1");
    if (stored.has_detail == 0) return;
    if (!sample.certificate.detail) sample.certificate.detail.emplace();
    archive(*sample.certificate.detail);
}

}  // namespace

std::string sample_bytes(const SampleRecord& sample) {
    SampleRecord record = sample;
    Stored stored{values<double>(sample.pose),
                  values<float>(sample.cloth),
                  values<float>(sample.embedded),
                  values<float>(sample.displacement),
                  {},
                  static_cast<uint8_t>(sample.certificate.detail.has_value())};
    for (const Eigen::Quaterniond& q : sample.frame)
        for (const double x : {q.w(), q.x(), q.y(), q.z()}) stored.frame.push_back(static_cast<float>(x));
    std::ostringstream stream;
    cereal::BinaryOutputArchive archive(stream);
    transfer(archive, record, stored, 0);
    return std::move(stream).str();
}

SampleRecord sample_from_bytes(std::string_view bytes) {
    SampleRecord sample;
    Stored stored;
    try {
        std::istringstream stream{std::string(bytes)};
        cereal::BinaryInputArchive archive(stream);
        transfer(archive, sample, stored, bytes.size());
        if (stream.peek() != std::istringstream::traits_type::eof()) throw Error("bytes are left over");
    } catch (const std::exception& error) {  // cereal's own too
        throw Error(std::string("the bytes of a sample cannot be read: ") + error.what());
    }
    sample.pose = positions(stored.pose);
    sample.cloth = positions(stored.cloth);
    sample.embedded = positions(stored.embedded);
    sample.displacement = positions(stored.displacement);
    if (stored.frame.size() % 4 != 0) throw Error("the bytes of a sample cannot be read: a frame ends within a turn");
    for (size_t i = 0; i < stored.frame.size(); i += 4)
        sample.frame.emplace_back(stored.frame[i], stored.frame[i + 1], stored.frame[i + 2], stored.frame[i + 3]);
    return sample;
}

}  // namespace toile::files
