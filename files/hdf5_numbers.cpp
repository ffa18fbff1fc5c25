#include "files/hdf5_numbers.h"

#include <utility>

namespace toile::files {
namespace {

bool holds_integers(const Hdf5File& file, const std::string& dataset) {
    const std::string type = file.type_name(dataset);
    return type.rfind("int", 0) == 0 || type.rfind("uint", 0) == 0;
}

Array<double> to_double(Array<int64_t> whole) {
    return {{whole.value.begin(), whole.value.end()}, std::move(whole.shape)};
}

}  // namespace

Array<double> read_numbers(const Hdf5File& file, const std::string& dataset, const Shape& expected) {
    if (holds_integers(file, dataset)) return to_double(file.read<int64_t>(dataset, expected));
    return file.read<double>(dataset, expected);
}

Array<double> read_number_rows(const Hdf5File& file, const std::string& dataset, int64_t first, int64_t count) {
    if (holds_integers(file, dataset)) return to_double(file.read_rows<int64_t>(dataset, first, count));
    return file.read_rows<double>(dataset, first, count);
}

}  // namespace toile::files
