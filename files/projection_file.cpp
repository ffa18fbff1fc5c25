#include "files/projection_file.h"

#include <utility>

#include "cloth/error.h"
#include "files/mesh_group.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

constexpr Storage checked{0, {}};  // checksums, no compression

template <typename Rows>
void write_rows_of(Hdf5File& file, const std::string& name, const Rows& rows) {
    file.write(name, rows.data(), {rows.rows(), rows.cols()}, checked);
}

void write_column(Hdf5File& file, const std::string& name, const Eigen::VectorXd& value) {
    file.write(name, value.data(), {value.size()}, checked);
}

void write_model(Hdf5File& file, const ProjectionHeader& header) {
    write_column(file, "/model/target_stiffness", header.target_stiffness);
    if (header.limits) {
        write_rows_of(file, "/model/edge", header.limits->edge);
        write_column(file, "/model/edge_max_length", header.limits->edge_max_length);
        return;
    }
    const SpringTables& springs = *header.springs;
    write_rows_of(file, "/model/edge_spring", springs.edge_spring);
    write_column(file, "/model/edge_stiffness", springs.edge_stiffness);
    write_column(file, "/model/edge_rest_length", springs.edge_rest_length);
    write_rows_of(file, "/model/bending_spring", springs.bending_spring);
    write_column(file, "/model/bending_stiffness", springs.bending_stiffness);
    write_column(file, "/model/bending_rest_length", springs.bending_rest_length);
    write_rows_of(file, "/model/axial_spring", springs.axial_spring);
    write_rows_of(file, "/model/axial_weight", springs.axial_weight);
    write_column(file, "/model/axial_stiffness", springs.axial_stiffness);
}

void write_root(Hdf5File& file, const ProjectionHeader& header) {
    file.set_attribute("/", "format", "toile");
    file.set_attribute("/", "version", projection_version);
    file.set_attribute("/", "prior", header.prior());
    file.set_attribute("/", "tolerance", header.tolerance);
    file.set_attribute("/", "config", header.config);
    file.set_attribute("/", "config_hash", header.config_hash);
    file.set_attribute("/", "program_version", header.program_version);
}

}  // namespace

struct ProjectionWriter::Impl {
    Impl(const std::string& path, const ProjectionHeader& header, int64_t count)
        : prior_is_limits(header.limits.has_value()),
          gradient(header.gradient),
          vertices(header.mesh.vertex_count()),
          edges(header.edge_count()),
          sample_count(count),
          target(path),
          file(Hdf5File::create(target.partial())) {}

    const bool prior_is_limits, gradient;
    const int64_t vertices, edges, sample_count;
    NewFile target;
    Hdf5File file;
    int64_t next = 0;

    /// Calls `visit(dataset, shape of a row, values)` for everything that is stored of samples.
    template <typename Visit>
    void each(const ProjectionRows& rows, const Visit& visit) {
        const Shape one, positions{vertices, 3};
        visit("/samples/predicted", positions, rows.predicted);
        visit("/samples/projected", positions, rows.projected);
        visit("/samples/status", one, std::span(rows.status));
        visit("/samples/seconds", one, std::span(rows.seconds));
        visit("/samples/iterations", one, std::span(rows.iterations));
        visit("/samples/residual", one, std::span(rows.residual));
        if (prior_is_limits) visit("/samples/multiplier", Shape{edges}, rows.multiplier);
        if (!gradient) return;
        visit("/samples/loss", one, std::span(rows.loss));
        visit("/samples/gradient", positions, rows.gradient);
        visit("/samples/gradient_seconds", one, std::span(rows.gradient_seconds));
        visit("/samples/gradient_residual", one, std::span(rows.gradient_residual));
        if (prior_is_limits) {
            visit("/samples/weakly_active", one, std::span(rows.weakly_active));
            visit("/samples/active_set_distance", one, std::span(rows.active_set_distance));
        } else {
            visit("/samples/gradient_mu", one, rows.gradient_mu);
            visit("/samples/gradient_mu_vertex", Shape{vertices}, rows.gradient_mu_vertex);
        }
    }

    void create_datasets();
    [[noreturn]] void fail(const std::string& what) const { throw Error(what, target.path()); }
};

void ProjectionWriter::Impl::create_datasets() {
    each(ProjectionRows{}, [&](const char* name, const Shape& row, auto values) {
        using Value = typename decltype(values)::value_type;
        const bool empty = row.size() == 1 && row[0] == 0;  // a mesh without edges: HDF5 has no chunks of nothing
        if (empty)
            file.write(name, std::vector<Value>{}, {sample_count, 0});
        else
            file.create_rows<Value>(name, sample_count, row, 0);
    });
}

ProjectionWriter::ProjectionWriter(const std::string& path, const ProjectionHeader& header, int64_t sample_count) {
    if (header.limits.has_value() == header.springs.has_value())
        throw Error("a projection comes from one prior, with its limits or its springs", path);
    impl_ = std::make_unique<Impl>(path, header, sample_count);
    write_root(impl_->file, header);
    write_mesh_group(impl_->file, header.mesh, checked.deflate);
    write_model(impl_->file, header);
    impl_->create_datasets();
}

ProjectionWriter::~ProjectionWriter() = default;

void ProjectionWriter::write(const ProjectionRows& rows) {
    const auto count = static_cast<int64_t>(rows.status.size());
    const int64_t first = impl_->next;
    if (first + count > impl_->sample_count)
        impl_->fail("there is no sample " + std::to_string(impl_->sample_count) + " to write");
    impl_->each(rows, [&](const char* name, const Shape& row, auto values) {
        int64_t expected = count;
        for (const int64_t size : row) expected *= size;
        if (static_cast<int64_t>(values.size()) != expected)
            impl_->fail(std::string(name) + " got " + std::to_string(values.size()) + " values, not " +
                        std::to_string(expected));
        if (expected > 0) impl_->file.write_rows(name, first, count, values.data());
    });
    impl_->next += count;
}

void ProjectionWriter::finish() {
    if (impl_->next != impl_->sample_count)
        impl_->fail("sample " + std::to_string(impl_->next) + " of " + std::to_string(impl_->sample_count) +
                    " was never written");
    impl_->file.close();
    impl_->target.commit();
}

}  // namespace toile::files
