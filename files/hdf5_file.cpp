#include "files/hdf5_file.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "cloth/error.h"
#include "files/hdf5_driver.h"
#include "files/hdf5_handle.h"
#include "files/hdf5_trial.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

/// Says in one line why a file cannot be opened for reading; returns if the system lets us read it.
void check_readable(const std::string& path) {
    struct stat status {};
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
        const int error = errno;
        if (descriptor >= 0) ::close(descriptor);
        throw Error(
            error == ENOENT ? "the file does not exist" : std::string("cannot read the file: ") + std::strerror(error),
            path);
    }
    ::close(descriptor);
    if (S_ISDIR(status.st_mode)) throw Error("this is a folder, not an HDF5 file", path);
    if (status.st_size == 0) throw Error("the file is empty", path);
}

Handle access_list() {
    Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(list, H5F_CLOSE_STRONG);
    // The 1.10 format has checksums on its own structures too.
    H5Pset_libver_bounds(list, H5F_LIBVER_V110, H5F_LIBVER_V110);
    return list;
}

}  // namespace

std::string shape_text(const Shape& shape) {
    std::string text = "(";
    for (size_t i = 0; i < shape.size(); ++i)
        text += (i ? ", " : "") + (shape[i] == any_size ? "*" : std::to_string(shape[i]));
    return text + ")";
}

Hdf5File::Hdf5File(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;
Hdf5File& Hdf5File::operator=(Hdf5File&&) noexcept = default;

Hdf5File::~Hdf5File() {
    if (!impl_) return;
    const Session session;
    impl_->file.close();
}

Hdf5File Hdf5File::open(const std::string& path) {
    static bool is_trial = false;  // set in the child process of a trial alone
    check_readable(path);
    const Session session;
    if (!is_trial && !has_checksums(path))
        try_reading(path, [&] {
            is_trial = true;
            Session::start_in_child();
            return open(path);
        });
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    if (H5Fis_hdf5(path.c_str()) <= 0) throw Error("not an HDF5 file", path);
    Handle list = access_list();
    H5Pset_file_locking(list, false, true);  // many disks of clusters have no locks, and readers need none
    impl->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, list), H5Fclose);
    if (!impl->file.valid()) throw Error("the HDF5 file is damaged or truncated: " + library_message(), path);
    return Hdf5File(std::move(impl));
}

Hdf5File Hdf5File::edit(const std::string& path) {
    open(path);  // for its messages
    const Session session;
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    impl->writable = true;
    Handle list = access_list();
    use_watched_driver(list, &impl->write_error);
    impl->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, list), H5Fclose);
    if (!impl->file.valid()) throw Error("cannot open the file for writing: " + library_message(), path);
    return Hdf5File(std::move(impl));
}

Hdf5File Hdf5File::create(const std::string& path) {
    // The system says why a file cannot be made; HDF5 would only say that it cannot.
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) throw Error("cannot write the file: " + write_failure(errno), path);
    ::close(descriptor);
    const Session session;
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    impl->writable = true;
    Handle list = access_list();
    use_watched_driver(list, &impl->write_error);
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation, false);
    impl->file = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, list), H5Fclose);
    if (!impl->file.valid()) throw Error("cannot create the file: " + library_message(), path);
    impl->check_written();
    return Hdf5File(std::move(impl));
}

const std::string& Hdf5File::path() const {
    return impl_->path;
}

void Hdf5File::close() {
    const Session session;
    const bool was_open = impl_->file.valid();
    const herr_t closed = impl_->file.close();
    impl_->check_written();
    if (was_open && closed < 0) throw Error("cannot close the file: " + library_message(), impl_->path);
}

bool Hdf5File::has(const std::string& name) const {
    const Session session;
    if (name == "/") return true;
    for (size_t end = 1; end != std::string::npos;) {
        end = name.find('/', end + 1);
        if (H5Lexists(impl_->file, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    }
    return H5Oexists_by_name(impl_->file, name.c_str(), H5P_DEFAULT) > 0;
}

bool Hdf5File::is_dataset(const std::string& name) const {
    if (!has(name)) return false;
    const Session session;
    return H5Iget_type(impl_->object(name)) == H5I_DATASET;
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
    if (!has(group)) return {};
    const Session session;
    const Handle object = impl_->object(group);
    std::vector<std::string> name;
    if (H5Iget_type(object) != H5I_GROUP) return name;
    auto collect = [](hid_t, const char* key, const H5L_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(key);
        return 0;
    };
    // Not in order: for that HDF5 1.10 makes a table first, and over damage frees what it did not fill.
    if (H5Literate(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect, &name) < 0)
        impl_->fail("cannot list the group: " + library_message(), group);
    std::sort(name.begin(), name.end());
    return name;
}

Shape Hdf5File::shape(const std::string& name) const {
    const Session session;
    const Handle dataset = impl_->dataset(name);
    return impl_->shape(Handle(H5Dget_space(dataset), H5Sclose));
}

std::string Hdf5File::type_name(const std::string& name) const {
    const Session session;
    const Handle dataset = impl_->dataset(name);
    return type_text(Handle(H5Dget_type(dataset), H5Tclose));
}

}  // namespace toile::files
