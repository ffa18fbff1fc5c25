#include "files/strain_file.h"

#include <set>
#include <stdexcept>

#include "files/hdf5_file.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr int deflate = 0;  // checksums, no compression: strain is noise in its last digits

}  // namespace

struct StrainWriter::Impl {
    Impl(const std::string& path, const StrainHeader& header, std::int64_t frame_count)
        : frames(frame_count),
          triangles(header.mesh.triangle_count()),
          vertices(header.mesh.vertex_count()),
          target(path),
          file(Hdf5File::create(target.partial())) {
        file.set_attribute("/", "format", "toile");
        file.set_attribute("/", "version", strain_version);
        file.set_attribute("/", "kind", "strain");
        file.set_attribute("/", "program_version", header.program_version);
        file.set_attribute("/", "source", header.source);
        file.set_attribute("/", "rest", header.rest);
        file.set_attribute("/", "neighbourhood", header.neighbourhood);
        file.set_attribute("/", "normal_weight", header.normal_weight);
        file.set_attribute("/", "faults", header.faults);
        if (header.time_step > 0) file.set_attribute("/", "time_step", header.time_step);
        write_mesh_group(file, header.mesh, deflate);
        file.write("/mesh/triangle_axis", header.triangle_axis, {triangles, 2, 3}, {deflate, {}});
    }

    const std::int64_t frames, triangles, vertices;
    NewFile target;
    Hdf5File file;
    std::set<std::string> made;

    template <typename T>
    void row(const std::string& name, std::int64_t frame, const Shape& shape, const std::vector<T>& value) {
        if (value.empty()) return;
        std::int64_t size = 1;
        for (const std::int64_t one : shape) size *= one;
        if (size != static_cast<std::int64_t>(value.size()) || frame >= frames)
            throw std::logic_error(name + " does not fit the strain file");
        if (made.insert(name).second) file.create_rows<T>(name, frames, shape, deflate);
        file.write_row(name, frame, value.data());
    }
};

StrainWriter::StrainWriter(const std::string& path, const StrainHeader& header, std::int64_t frame_count)
    : impl_(std::make_unique<Impl>(path, header, frame_count)) {}
StrainWriter::~StrainWriter() = default;

void StrainWriter::write(std::int64_t frame, const StrainColumns& triangles, const StrainColumns& vertices) {
    const std::int64_t f = impl_->triangles, v = impl_->vertices;
    impl_->row("/triangle/fault", frame, {f}, triangles.fault);
    impl_->row("/triangle/stretch", frame, {f, 2}, triangles.stretch);
    impl_->row("/triangle/gradient", frame, {f, 3, 2}, triangles.gradient);
    impl_->row("/triangle/rotation", frame, {f, 3, 2}, triangles.rotation);
    impl_->row("/triangle/rest_direction", frame, {f, 2, 3}, triangles.rest_direction);
    impl_->row("/triangle/direction", frame, {f, 2, 3}, triangles.direction);
    impl_->row("/vertex/fault", frame, {v}, vertices.fault);
    impl_->row("/vertex/stretch", frame, {v, 3}, vertices.stretch);
    impl_->row("/vertex/surface_stretch", frame, {v, 2}, vertices.surface_stretch);
    impl_->row("/vertex/gradient", frame, {v, 3, 3}, vertices.gradient);
    impl_->row("/vertex/rotation", frame, {v, 4}, vertices.rotation);
    impl_->row("/vertex/rest_direction", frame, {v, 3, 3}, vertices.rest_direction);
    impl_->row("/vertex/direction", frame, {v, 3, 3}, vertices.direction);
    impl_->row("/vertex/residual", frame, {v}, vertices.residual);
}

void StrainWriter::write_rates(std::int64_t frame, const RateColumns& triangles, const RateColumns& vertices) {
    const auto group = [&](const std::string& name, std::int64_t count, const RateColumns& rates) {
        impl_->row(name + "/velocity_gradient", frame, {count, 3, 3}, rates.velocity_gradient);
        impl_->row(name + "/strain_rate", frame, {count, 2}, rates.strain_rate);
        impl_->row(name + "/spin", frame, {count, 3}, rates.spin);
        impl_->row(name + "/rate_error", frame, {count}, rates.rate_error);
    };
    group("/triangle", impl_->triangles, triangles);
    group("/vertex", impl_->vertices, vertices);
}

void StrainWriter::finish(const std::vector<std::string>& frame_name) {
    impl_->file.write_strings("/frames/name", frame_name);
    impl_->file.close();
    impl_->target.commit();
}

}  // namespace toile::files
