#include "files/journal.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "cloth/error.h"
#include "files/digest.h"
#include "files/new_file.h"

namespace toile::files {
namespace {

/// Before each payload: mark, length, digest as text.
struct Heading {
    std::array<char, 8> mark = {'t', 'o', 'i', 'l', 'e', 'j', '1', '\n'};
    std::int64_t size = 0;
    std::array<char, 32> digest = {};
};
static_assert(sizeof(Heading) == 48);

Heading heading_of(std::string_view payload) {
    Heading heading;
    heading.size = static_cast<std::int64_t>(payload.size());
    const std::string digest = text_digest(payload);
    std::copy(digest.begin(), digest.end(), heading.digest.begin());
    return heading;
}

/// 0, or the reason why not all bytes were written.
int write_all(int descriptor, const char* data, size_t size, std::int64_t offset) {
    while (size > 0) {
        const ssize_t put = ::pwrite(descriptor, data, size, offset);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return put == 0 ? ENOSPC : errno;
        data += put;
        offset += put;
        size -= static_cast<size_t>(put);
    }
    return 0;
}

/// False where the file ends first.
bool read_all(int descriptor, char* data, size_t size, std::int64_t offset) {
    while (size > 0) {
        const ssize_t got = ::pread(descriptor, data, size, offset);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        data += got;
        offset += got;
        size -= static_cast<size_t>(got);
    }
    return true;
}

/// Where the first mark at or behind `from` begins; -1 where there is none.
std::int64_t next_mark(int descriptor, std::int64_t from) {
    const std::array<char, 8> mark = Heading{}.mark;
    std::string window(size_t{1} << 20, '\0');
    for (;;) {
        const ssize_t got = ::pread(descriptor, window.data(), window.size(), from);
        if (got < 0 && errno == EINTR) continue;
        if (got < static_cast<ssize_t>(mark.size())) return -1;
        const size_t at = std::string_view(window.data(), static_cast<size_t>(got)).find({mark.data(), mark.size()});
        if (at != std::string_view::npos) return from + static_cast<std::int64_t>(at);
        from += got - static_cast<ssize_t>(mark.size()) + 1;  // one may lie across the window's end
    }
}

}  // namespace

Journal::Journal(std::string path) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) fail(errno);
    try {
        find_records();
        if (::ftruncate(descriptor_, end_) != 0) fail(errno);
        sync_folder_of(path_);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

Journal::Journal(Journal&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      end_(other.end_),
      record_(std::move(other.record_)),
      damaged_(other.damaged_) {}

Journal& Journal::operator=(Journal&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(end_, other.end_);
    std::swap(record_, other.record_);
    std::swap(damaged_, other.damaged_);
    return *this;
}

Journal::~Journal() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::fail(int error_number) const {
    throw Error("the journal cannot be written: " + write_failure(error_number), path_,
                "what is in it is kept: mend the cause and go on with --resume");
}

void Journal::find_records() {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail(errno);
    if (!S_ISREG(status.st_mode)) throw Error("the journal is not a file", path_);
    Heading heading;
    std::string payload;
    while (read_all(descriptor_, reinterpret_cast<char*>(&heading), sizeof heading, end_)) {
        const std::int64_t offset = end_ + static_cast<std::int64_t>(sizeof heading);
        const bool whole =
            heading.mark == Heading{}.mark && heading.size >= 0 && heading.size <= status.st_size - offset;
        payload.resize(whole ? static_cast<size_t>(heading.size) : 0);
        if (whole && read_all(descriptor_, payload.data(), payload.size(), offset) &&
            heading_of(payload).digest == heading.digest) {
            record_.push_back({offset, heading.size});
            end_ = offset + heading.size;
            continue;
        }
        // The length may be what is damaged: the next record is where the next mark is.
        const std::int64_t next = next_mark(descriptor_, end_ + 1);
        if (next < 0 && !whole) return;
        ++damaged_;
        end_ = next < 0 ? offset + heading.size : next;
    }
}

std::string Journal::read(int record) const {
    const Place& place = record_.at(static_cast<size_t>(record));
    Heading heading;
    std::string payload(static_cast<size_t>(place.size), '\0');
    const std::int64_t before = place.offset - static_cast<std::int64_t>(sizeof heading);
    if (!read_all(descriptor_, reinterpret_cast<char*>(&heading), sizeof heading, before) ||
        !read_all(descriptor_, payload.data(), payload.size(), place.offset) ||
        heading_of(payload).digest != heading.digest)
        throw Error("record " + std::to_string(record) + " of the journal has changed since it was written", path_,
                    "--resume makes its sample again");
    return payload;
}

void Journal::append(std::string_view payload) {
    const Heading heading = heading_of(payload);
    std::string bytes(reinterpret_cast<const char*>(&heading), sizeof heading);
    bytes += payload;
    int error = write_all(descriptor_, bytes.data(), bytes.size(), end_);
    if (error == 0 && ::fdatasync(descriptor_) != 0 && errno != EINVAL) error = errno;
    if (error != 0) {
        // Should this fail too, opening the journal again cuts the torn record off.
        static_cast<void>(::ftruncate(descriptor_, end_) == 0);
        fail(error);
    }
    record_.push_back({end_ + static_cast<std::int64_t>(sizeof heading), heading.size});
    end_ += static_cast<std::int64_t>(bytes.size());
}

}  // namespace toile::files
