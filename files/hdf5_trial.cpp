#include "files/hdf5_trial.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "cloth/error.h"
#include "files/trial_run.h"

namespace toile::files {
namespace {

constexpr int deepest_group = 8;
constexpr int64_t small_dataset = 1 << 20;  // values

/// What is wrong will be said with its place when the file is read in earnest.
void attempt(const std::function<void()>& read) {
    try {
        read();
    } catch (const Error&) {
    }
}

template <typename T>
void read_values(const Hdf5File& file, const std::string& name) {
    const Shape shape = file.shape(name);
    int64_t values = 1;
    for (const int64_t size : shape)
        values = size > 0 ? std::min(values, small_dataset) * std::min(size, small_dataset) : 0;
    if (shape.empty() || values <= small_dataset) {
        file.read<T>(name);
        return;
    }
    file.read_rows<T>(name, 0, 1);
    file.read_rows<T>(name, shape[0] - 1, 1);
}

void read_dataset(const Hdf5File& file, const std::string& name) {
    const std::string type = file.type_name(name);
    if (type == "string")
        file.read_strings(name);
    else if (type.starts_with("float"))
        read_values<double>(file, name);
    else if (type != "other")
        read_values<int64_t>(file, name);
}

void read_attributes(const Hdf5File& file, const std::string& name) {
    for (const std::string& key : file.attributes(name)) {
        attempt([&] { file.numbers_attribute(name, key); });
        attempt([&] { file.strings_attribute(name, key); });
    }
}

void read_group(const Hdf5File& file, const std::string& group, int depth) {
    attempt([&] { read_attributes(file, group); });
    if (depth > deepest_group) return;  // deeper than any of ours, or a group within itself
    for (const std::string& member : file.members(group)) {
        const std::string name = (group == "/" ? group : group + "/") + member;
        attempt([&] {
            if (!file.is_dataset(name)) return read_group(file, name, depth + 1);
            read_attributes(file, name);
            read_dataset(file, name);
        });
    }
}

}  // namespace

bool has_checksums(const std::string& path) {
    std::array<char, 9> start{};
    std::ifstream(path, std::ios::binary).read(start.data(), start.size());
    return std::string(start.data(), 8) == "\x89HDF\r\n\x1a\n" && start[8] >= 2;
}

void try_reading(const std::string& path, const std::function<Hdf5File()>& open) {
    std::error_code failure;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failure);
    const int megabytes = failure ? 0 : static_cast<int>(std::min<std::uintmax_t>(bytes >> 20, 1000));
    trial_run(path, 10 + megabytes / 10, [&] {
        attempt([&] { read_group(open(), "/", 0); });
        return std::string();
    });
}

}  // namespace toile::files
