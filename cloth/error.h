#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace toile {

/// The one exception of toile: the caller or the input is at fault. Numerical outcomes are never exceptions.
///
/// `what()` says what is wrong in one line; `where` names the file, and after a colon the line or key, or is empty;
/// `mend` tells how to put it right, or is empty. The command line prints `toile: <what> (<where>)` and the mend below.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string& what, std::string where = {}, std::string mend = {})
        : std::runtime_error(what), where_(std::move(where)), mend_(std::move(mend)) {}

    const std::string& where() const { return where_; }
    const std::string& mend() const { return mend_; }

  private:
    std::string where_;
    std::string mend_;
};

}  // namespace toile
