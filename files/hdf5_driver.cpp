#include "files/hdf5_driver.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace toile::files {
namespace {

struct DriverInfo {
    int* write_error;
};

/// The library sees `head` only; it must come first.
struct WatchedFile {
    H5FD_t head{};
    int descriptor = -1;
    haddr_t end_of_addresses = 0;
    haddr_t end_of_file = 0;
    bool writable = false;
    int* write_error = nullptr;
    std::vector<std::pair<haddr_t, std::vector<char>>> kept;  ///< what was written after the first failure, in order
};

WatchedFile& watched(H5FD_t* file) {
    return *reinterpret_cast<WatchedFile*>(file);
}
const WatchedFile& watched(const H5FD_t* file) {
    return *reinterpret_cast<const WatchedFile*>(file);
}

void note(WatchedFile& file, int error) {
    if (*file.write_error == 0) *file.write_error = error;
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t access_list, haddr_t) {
    const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access_list));
    if (!info) return nullptr;
    int mode = flags & H5F_ACC_RDWR ? O_RDWR : O_RDONLY;
    if (flags & H5F_ACC_TRUNC) mode |= O_TRUNC;
    if (flags & H5F_ACC_CREAT) mode |= O_CREAT;
    if (flags & H5F_ACC_EXCL) mode |= O_EXCL;
    const int descriptor = ::open(name, mode | O_CLOEXEC, 0666);
    if (descriptor < 0) return nullptr;
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) {
        ::close(descriptor);
        return nullptr;
    }
    auto* file = new WatchedFile;
    file->descriptor = descriptor;
    file->end_of_file = static_cast<haddr_t>(status.st_size);
    file->writable = flags & H5F_ACC_RDWR;
    file->write_error = info->write_error;
    return &file->head;
}

herr_t close_file(H5FD_t* head) {
    WatchedFile& file = watched(head);
    // EINVAL: a special file that cannot be synced.
    if (file.writable && ::fsync(file.descriptor) != 0 && errno != EINVAL) note(file, errno);
    if (::close(file.descriptor) != 0) note(file, errno);
    delete &file;
    return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

haddr_t get_eoa(const H5FD_t* head, H5FD_mem_t) {
    return watched(head).end_of_addresses;
}
haddr_t get_eof(const H5FD_t* head, H5FD_mem_t) {
    return watched(head).end_of_file;
}
herr_t set_eoa(H5FD_t* head, H5FD_mem_t, haddr_t address) {
    watched(head).end_of_addresses = address;
    return 0;
}

void read_kept(const WatchedFile& file, haddr_t address, size_t size, char* buffer) {
    for (const auto& [start, bytes] : file.kept) {
        const haddr_t from = std::max(address, start);
        const haddr_t to = std::min(address + size, start + bytes.size());
        if (from < to) std::memcpy(buffer + (from - address), bytes.data() + (from - start), to - from);
    }
}

herr_t read_bytes(H5FD_t* head, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
    const WatchedFile& file = watched(head);
    size_t done = 0;
    while (done < size) {
        const ssize_t got = ::pread(file.descriptor, static_cast<char*>(buffer) + done, size - done,
                                    static_cast<off_t>(address + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return -1;
        if (got == 0) break;
        done += static_cast<size_t>(got);
    }
    // The library expects zeros beyond the end, as its own drivers give.
    std::memset(static_cast<char*>(buffer) + done, 0, size - done);
    read_kept(file, address, size, static_cast<char*>(buffer));
    return 0;
}

herr_t write_bytes(H5FD_t* head, H5FD_mem_t, hid_t, haddr_t address, size_t size, const void* buffer) {
    WatchedFile& file = watched(head);
    const char* bytes = static_cast<const char*>(buffer);
    size_t done = 0;
    while (*file.write_error == 0 && done < size) {
        const ssize_t put = ::pwrite(file.descriptor, bytes + done, size - done, static_cast<off_t>(address + done));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) note(file, put == 0 ? ENOSPC : errno);
        if (put > 0) done += static_cast<size_t>(put);
    }
    if (done < size) file.kept.emplace_back(address + done, std::vector<char>(bytes + done, bytes + size));
    file.end_of_file = std::max(file.end_of_file, address + size);
    return 0;
}

herr_t truncate(H5FD_t* head, hid_t, hbool_t) {
    WatchedFile& file = watched(head);
    if (file.end_of_file == file.end_of_addresses) return 0;
    if (*file.write_error == 0 && ::ftruncate(file.descriptor, static_cast<off_t>(file.end_of_addresses)) != 0)
        note(file, errno);
    file.end_of_file = file.end_of_addresses;
    return 0;
}

hid_t register_driver() {
    static H5FD_class_t driver{};
    driver.name = "toile_watched";
    driver.maxaddr = (haddr_t{1} << 62);
    driver.fc_degree = H5F_CLOSE_STRONG;
    driver.fapl_size = sizeof(DriverInfo);
    driver.open = open_file;
    driver.close = close_file;
    driver.query = query;
    driver.get_eoa = get_eoa;
    driver.set_eoa = set_eoa;
    driver.get_eof = get_eof;
    driver.read = read_bytes;
    driver.write = write_bytes;
    driver.truncate = truncate;
    const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), driver.fl_map);
    return H5FDregister(&driver);
}

}  // namespace

void use_watched_driver(hid_t access_list, int* write_error) {
    static const hid_t driver = register_driver();
    const DriverInfo info{write_error};
    H5Pset_driver(access_list, driver, &info);
}

}  // namespace toile::files
