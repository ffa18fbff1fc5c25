#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace toile::fuzz {

/// A fuzzer's input as a file, since readers take paths. One a process, written anew for each input and removed at the
/// end; the extension tells readers what to expect.
class InputFile {
  public:
    explicit InputFile(const std::string& extension);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    const std::string& write(const uint8_t* data, size_t size) const;  ///< returns the path
    const std::string& path() const { return path_; }

  private:
    std::string folder_, path_;
};

/// Whether who reads knows the name of what it reads.
enum class Place { known, unknown };

/// Runs `read`, which may refuse its input: with an Error that says what is wrong, and where if it can know. Anything
/// else it throws ends the program, which the fuzzer reports as a crash.
void may_refuse(const std::function<void()>& read, Place place = Place::known);

}  // namespace toile::fuzz
