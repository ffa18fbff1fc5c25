#include "files/sample_bytes.h"

#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>

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
            c.self_intersections, c.detail);
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

/// What of a sample is neither a number nor a plain list.
struct Stored {
    std::vector<double> pose;
    std::vector<float> cloth, embedded, displacement, frame;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(pose, cloth, embedded, displacement, frame);
    }
};

template <class Archive, class Record>
void transfer(Archive& archive, Record& sample, Stored& stored) {
    archive(sample.id, sample.split, sample.status, stored, sample.image, sample.resampling_error, sample.certificate);
}

}  // namespace

std::string sample_bytes(const SampleRecord& sample) {
    SampleRecord record = sample;
    Stored stored{values<double>(sample.pose),
                  values<float>(sample.cloth),
                  values<float>(sample.embedded),
                  values<float>(sample.displacement),
                  {}};
    for (const Eigen::Quaterniond& q : sample.frame)
        for (const double x : {q.w(), q.x(), q.y(), q.z()}) stored.frame.push_back(static_cast<float>(x));
    std::ostringstream stream;
    cereal::BinaryOutputArchive archive(stream);
    transfer(archive, record, stored);
    return std::move(stream).str();
}

SampleRecord sample_from_bytes(std::string_view bytes) {
    SampleRecord sample;
    Stored stored;
    try {
        std::istringstream stream{std::string(bytes)};
        cereal::BinaryInputArchive archive(stream);
        transfer(archive, sample, stored);
    } catch (const std::exception& error) {  // cereal's own, or a length that no memory holds
        throw Error(std::string("the bytes of a sample cannot be read: ") + error.what());
    }
    sample.pose = positions(stored.pose);
    sample.cloth = positions(stored.cloth);
    sample.embedded = positions(stored.embedded);
    sample.displacement = positions(stored.displacement);
    for (size_t i = 0; i + 4 <= stored.frame.size(); i += 4)
        sample.frame.emplace_back(stored.frame[i], stored.frame[i + 1], stored.frame[i + 2], stored.frame[i + 3]);
    return sample;
}

}  // namespace toile::files
