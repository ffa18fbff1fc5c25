#include <hdf5.h>

#include <algorithm>

#include "cloth/error.h"
#include "files/hdf5_claim.h"
#include "files/hdf5_file.h"
#include "files/hdf5_handle.h"

namespace toile::files {
namespace {

Handle open_attribute(const Hdf5File& file, hid_t object, const std::string& name, const std::string& key) {
    if (H5Aexists(object, key.c_str()) <= 0) throw Error("no attribute \"" + key + "\"", file.path() + ":" + name);
    return Handle(H5Aopen(object, key.c_str(), H5P_DEFAULT), H5Aclose);
}

[[noreturn]] void refuse(const Hdf5File& file, const std::string& name, const std::string& key, const char* expected) {
    throw Error("the attribute \"" + key + "\" does not hold " + expected, file.path() + ":" + name);
}

bool fits_file(hid_t attribute, hid_t type, hid_t space) {
    try {
        check_stored_claim(attribute, H5Sget_simple_extent_npoints(space), H5Tget_size(type));
        return true;
    } catch (const Error&) {
        return false;
    }
}

void replace_attribute(hid_t object, const std::string& key, hid_t type, hid_t space, const void* value) {
    if (H5Aexists(object, key.c_str()) > 0) H5Adelete(object, key.c_str());
    const Handle attribute(H5Acreate2(object, key.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute.valid() || H5Awrite(attribute, type, value) < 0)
        throw Error("cannot write the attribute \"" + key + "\": " + library_message());
}

Handle scalar() {
    return Handle(H5Screate(H5S_SCALAR), H5Sclose);
}
Handle row(size_t count) {
    const hsize_t size = count;
    return Handle(H5Screate_simple(1, &size, nullptr), H5Sclose);
}

}  // namespace

bool Hdf5File::has_attribute(const std::string& name, const std::string& key) const {
    const Session session;
    return has(name) && H5Aexists(impl_->object(name), key.c_str()) > 0;
}

std::vector<std::string> Hdf5File::attributes(const std::string& name) const {
    const Session session;
    const Handle object = impl_->object(name);
    std::vector<std::string> key;
    auto collect = [](hid_t, const char* text, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(text);
        return 0;
    };
    // not in order, see `members`
    if (H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect, &key) < 0)
        impl_->fail("cannot list the attributes: " + library_message(), name);
    std::sort(key.begin(), key.end());
    return key;
}

std::vector<std::string> Hdf5File::strings_attribute(const std::string& name, const std::string& key) const {
    const Session session;
    const Handle object = impl_->object(name);
    const Handle attribute = open_attribute(*this, object, name, key);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Tget_class(type) != H5T_STRING || !fits_file(attribute, type, space)) refuse(*this, name, key, "text");
    return strings_of(type, space, [&](hid_t memory, void* buffer) { return H5Aread(attribute, memory, buffer); });
}

std::string Hdf5File::string_attribute(const std::string& name, const std::string& key) const {
    const std::vector<std::string> text = strings_attribute(name, key);
    if (text.size() != 1) refuse(*this, name, key, "one text");
    return text[0];
}

std::vector<double> Hdf5File::numbers_attribute(const std::string& name, const std::string& key) const {
    const Session session;
    const Handle object = impl_->object(name);
    const Handle attribute = open_attribute(*this, object, name, key);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    if (H5Tget_class(type) != H5T_FLOAT && H5Tget_class(type) != H5T_INTEGER) refuse(*this, name, key, "numbers");
    const Handle space(H5Aget_space(attribute), H5Sclose);
    if (!fits_file(attribute, type, space)) refuse(*this, name, key, "as many numbers as it claims");
    std::vector<double> value(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
    if (!value.empty() && H5Aread(attribute, H5T_NATIVE_DOUBLE, value.data()) < 0)
        refuse(*this, name, key, "readable numbers");
    return value;
}

double Hdf5File::number_attribute(const std::string& name, const std::string& key) const {
    const std::vector<double> value = numbers_attribute(name, key);
    if (value.size() != 1) refuse(*this, name, key, "one number");
    return value[0];
}

int64_t Hdf5File::integer_attribute(const std::string& name, const std::string& key) const {
    const Session session;
    const Handle object = impl_->object(name);
    const Handle attribute = open_attribute(*this, object, name, key);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    int64_t value = 0;
    if (H5Tget_class(type) != H5T_INTEGER || H5Sget_simple_extent_npoints(space) != 1 ||
        H5Aread(attribute, H5T_NATIVE_INT64, &value) < 0)
        refuse(*this, name, key, "one integer");
    return value;
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, const std::string& value) {
    const Session session;
    const FixedStrings strings({value});
    replace_attribute(impl_->object(name), key, strings.type, scalar(), strings.text.data());
    impl_->check_written();
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, const char* value) {
    set_attribute(name, key, std::string(value));
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, const std::vector<std::string>& value) {
    const Session session;
    const FixedStrings strings(value);
    replace_attribute(impl_->object(name), key, strings.type, row(value.size()), strings.text.data());
    impl_->check_written();
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, int64_t value) {
    const Session session;
    replace_attribute(impl_->object(name), key, H5T_NATIVE_INT64, scalar(), &value);
    impl_->check_written();
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, double value) {
    const Session session;
    replace_attribute(impl_->object(name), key, H5T_NATIVE_DOUBLE, scalar(), &value);
    impl_->check_written();
}

void Hdf5File::set_attribute(const std::string& name, const std::string& key, const std::vector<double>& value) {
    const Session session;
    replace_attribute(impl_->object(name), key, H5T_NATIVE_DOUBLE, row(value.size()), value.data());
    impl_->check_written();
}

}  // namespace toile::files
