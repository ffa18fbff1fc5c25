#include "app/guard.h"

#include <cstdio>
#include <filesystem>
#include <new>
#include <string>

#include "cloth/error.h"
#include "generate/ordered_work.h"

namespace toile::app {
namespace {

constexpr size_t longest_line = 1000;

/// On one line, and not a long one, whatever a file name or a library's message holds.
std::string one_line(std::string text) {
    if (text.size() > longest_line) text = text.substr(0, longest_line) + " ...";
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

}  // namespace

void print_error(const std::string& what, const std::string& where, const std::string& mend) {
    std::string text = "toile: " + one_line(what);
    if (!where.empty()) text += " (" + one_line(where) + ")";
    text += "\n";
    if (!mend.empty()) text += one_line(mend) + "\n";
    std::fputs(text.c_str(), stderr);
}

int guarded(const std::function<int()>& work) {
    try {
        return work();
    } catch (const Error& error) {
        print_error(error.what(), error.where(), error.mend());
        return input_at_fault;
    } catch (const generate::Interrupted& interrupt) {
        print_error(interrupt.what(), {}, {});
        return our_failure;
    } catch (const std::filesystem::filesystem_error& error) {
        print_error(error.code().message(), error.path1().string(), {});
        return input_at_fault;
    } catch (const std::bad_alloc&) {
        print_error("out of memory", {}, "try fewer --jobs, or a coarser scene");
        return our_failure;
    } catch (const std::exception& error) {
        print_error(std::string("internal failure: ") + error.what(), {},
                    "this is a defect of toile: please report it");
        return our_failure;
    } catch (...) {
        print_error("internal failure", {}, "this is a defect of toile: please report it");
        return our_failure;
    }
}

}  // namespace toile::app
