#include "files/hdf5_handle.h"

#include <algorithm>
#include <new>

#include "cloth/error.h"
#include "files/hdf5_claim.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

std::recursive_mutex& library_mutex() {
    static std::recursive_mutex mutex;
    return mutex;
}

herr_t take_first(unsigned, const H5E_error2_t* error, void* text) {
    auto& message = *static_cast<std::string*>(text);
    if (message.empty() && error->desc) message = error->desc;
    return 0;
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
    // Every file of ours is closed by its owner. What the library leaks on damaged files would make its own clean-up at
    // the end of the program loop and print.
    static const herr_t once = H5dont_atexit();
    static_cast<void>(once);
    H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() {
    H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
}

void Session::start_in_child() {
    new (&library_mutex()) std::recursive_mutex;
}

std::string library_message() {
    std::string message;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &message);
    return message.empty() ? "unknown HDF5 failure" : message;
}

void Hdf5File::Impl::fail(const std::string& what, const std::string& name) const {
    throw Error(what, where(name));
}

void Hdf5File::Impl::check_written() const {
    if (write_error != 0) throw Error("cannot write the file: " + write_failure(write_error), path);
}

Handle Hdf5File::Impl::dataset(const std::string& name) const {
    if (!file.valid()) fail("the file is closed", name);
    Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) fail("no such dataset", name);
    return dataset;
}

void Hdf5File::Impl::check_claims(hid_t dataset, const std::string& name, int64_t count, size_t width) const {
    auto found = checked.find(name);
    if (found == checked.end() || writable) found = checked.insert_or_assign(name, check_claim(dataset, path)).first;
    if (found->second) check_virtual_selection(count, width);
}

Handle Hdf5File::Impl::object(const std::string& name) const {
    if (!file.valid()) fail("the file is closed", name);
    Handle object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.valid()) fail("no such dataset or group", name);
    return object;
}

Shape Hdf5File::Impl::shape(hid_t space) const {
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> size(static_cast<size_t>(rank > 0 ? rank : 0));
    if (rank > 0) H5Sget_simple_extent_dims(space, size.data(), nullptr);
    return Shape(size.begin(), size.end());
}

FixedStrings::FixedStrings(const std::vector<std::string>& value) {
    for (const std::string& string : value) width = std::max(width, string.size());
    text.assign(width * value.size(), '\0');
    for (size_t i = 0; i < value.size(); ++i) value[i].copy(text.data() + i * width, width);
    type = Handle(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, width);
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    H5Tset_cset(type, H5T_CSET_UTF8);
}

std::string type_text(hid_t type) {
    const std::string bits = std::to_string(8 * H5Tget_size(type));
    switch (H5Tget_class(type)) {
        case H5T_FLOAT:
            return "float" + bits;
        case H5T_INTEGER:
            return (H5Tget_sign(type) == H5T_SGN_NONE ? "uint" : "int") + bits;
        case H5T_STRING:
            return "string";
        default:
            return "other";
    }
}

std::vector<std::string> strings_of(hid_t stored_type, hid_t space, const std::function<herr_t(hid_t, void*)>& read) {
    const size_t count = static_cast<size_t>(H5Sget_simple_extent_npoints(space));
    std::vector<std::string> value(count);
    if (count == 0) return value;
    if (H5Tis_variable_str(stored_type) > 0) {
        std::vector<char*> text(count, nullptr);
        const Handle type(H5Tcopy(stored_type), H5Tclose);
        if (read(type, text.data()) < 0) throw Error(library_message());
        for (size_t i = 0; i < count; ++i)
            if (text[i]) value[i] = text[i];
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, text.data());
        return value;
    }
    const size_t width = H5Tget_size(stored_type);
    std::vector<char> text(count * width);
    if (read(stored_type, text.data()) < 0) throw Error(library_message());
    const bool spaces = H5Tget_strpad(stored_type) == H5T_STR_SPACEPAD;
    for (size_t i = 0; i < count; ++i) {
        const std::string raw(text.data() + i * width, width);
        value[i] = spaces ? raw.substr(0, raw.find_last_not_of(' ') + 1) : raw.substr(0, raw.find('\0'));
    }
    return value;
}

}  // namespace toile::files
